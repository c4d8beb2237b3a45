"""Seeded work on all cores, with a progress bar on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

from tqdm import tqdm

T = TypeVar("T")


def in_parallel(work: Callable[[int], T], seeds: range, jobs: int | None) -> list[T]:
    """Return what ``work`` makes of every seed, in their order, with ``jobs`` processes."""
    with ProcessPoolExecutor(jobs) as pool:
        done = pool.map(work, seeds)
        return list(tqdm(done, total=len(seeds), disable=not sys.stderr.isatty(), leave=False))
