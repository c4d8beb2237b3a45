"""Seeded work on all cores or on a cluster: with progress, and resumed where results are kept."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from contextlib import ExitStack
from pathlib import Path
from typing import TypeVar

from tqdm import tqdm

from sar_sim.jobs.processes import spawning_pool
from sar_sim.jobs.result_cache import ResultCache

T = TypeVar("T")
TOLD_EVERY_S = 60.0
RETRIES = 5
CONNECT_S = "5s"


def add_work_options(parser: argparse.ArgumentParser, *, seeds: tuple[str, int]) -> None:
    """Add which seeds are flown (the option's name and default; 0: the plan's), and on what."""
    name, default = seeds
    parser.add_argument(f"--{name}", type=int, default=default, help="how many are flown")
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument(
        "--scheduler", default="", metavar="URL", help="of a Dask cluster, instead of --jobs"
    )


def add_keep_option(parser: argparse.ArgumentParser) -> None:
    """Add the file in which results are kept."""
    parser.add_argument(
        "--keep", type=Path, metavar="FILE", help="keep what is done here, and go on from there"
    )


class Workers:
    """Processes of this machine, or those of a Dask cluster at ``scheduler``.

    A cluster's worker that dies is replaced by another one. Raises ``ValueError`` for a cluster
    that is not there.
    """

    def __init__(self, jobs: int | None, scheduler: str = "") -> None:
        """Start nothing yet."""
        self._jobs, self._scheduler = jobs, scheduler
        self._stack = ExitStack()

    def __enter__(self) -> Executor:
        """Start the processes, or connect."""
        if not self._scheduler:
            return self._stack.enter_context(spawning_pool(self._jobs))
        try:
            from distributed import Client  # noqa: PLC0415 (only clusters need it)
        except ImportError as error:
            raise ValueError("--scheduler: expected 'pip install distributed' first") from error
        try:
            client = Client(self._scheduler, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:
            raise ValueError(f"--scheduler {self._scheduler}: no Dask scheduler there") from error
        self._stack.enter_context(client)
        executor: Executor = client.get_executor(pure=False, retries=RETRIES)
        return executor

    def __exit__(self, *_args: object) -> None:
        """Stop them, or disconnect."""
        self._stack.close()


def in_parallel(
    work: Callable[[int], T],
    seeds: range,
    workers: Executor,
    *,
    kind: type[T],
    kept: ResultCache,
    part: str = "",
) -> list[T]:
    """Return what ``work`` makes of every seed, in their order.

    ``kind``: the dataclass it makes. Seeds of ``part`` that are ``kept`` are not flown again.
    """
    found = {seed: kept.get(part, seed, kind) for seed in seeds}
    missing = [seed for seed, result in found.items() if result is None]
    done = zip(missing, workers.map(work, missing), strict=True)
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
