"""Seeded work on all cores: with progress, and resumed where what was done is kept."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TypeVar

from tqdm import tqdm

from sar_sim.kept import Kept

T = TypeVar("T")
TOLD_EVERY_S = 60.0


def add_work_options(parser: argparse.ArgumentParser, *, seeds: tuple[str, int]) -> None:
    """Add which seeds are flown (the option's name and default), on what, and what is kept."""
    name, default = seeds
    parser.add_argument(f"--{name}", type=int, default=default, help="how many are flown")
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument(
        "--keep", type=Path, metavar="FILE", help="keep what is done here, and go on from there"
    )


def in_parallel(
    work: Callable[[int], T],
    seeds: range,
    jobs: int | None,
    *,
    kind: type[T],
    kept: Kept,
    part: str = "",
) -> list[T]:
    """Return what ``work`` makes of every seed, in their order, with ``jobs`` processes.

    ``kind``: the dataclass it makes. Seeds of ``part`` that are ``kept`` are not flown again.
    """
    found = {seed: kept.get(part, seed, kind) for seed in seeds}
    missing = [seed for seed, result in found.items() if result is None]
    with ProcessPoolExecutor(jobs) as pool:
        done = zip(missing, pool.map(work, missing), strict=True)
        for seed, result in _told(done, len(missing), part or "flown"):
            kept.add(part, seed, result)
            found[seed] = result
    return [result for result in found.values() if result is not None]


def _told(items: Iterable[T], total: int, name: str) -> Iterator[T]:
    """Hand items on, with a bar on a terminal, elsewhere a line each minute."""
    if sys.stderr.isatty():
        yield from tqdm(items, total=total, desc=name, leave=False)
        return
    begun = told = time.monotonic()
    for count, item in enumerate(items, start=1):
        yield item
        now = time.monotonic()
        if now - told >= TOLD_EVERY_S:
            told = now
            sys.stderr.write(f"{name}: {count} of {total} in {now - begun:.0f} s\n")
            sys.stderr.flush()
