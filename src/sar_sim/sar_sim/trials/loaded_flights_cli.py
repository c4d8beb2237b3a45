"""``loaded_flights``: flies the whole graph on a busy machine, and prints what came of it."""

from __future__ import annotations

import argparse
import contextlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import yaml

from sar_sim.jobs.processes import NodeProcess, launch_command
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Scenario, load_scenario, scenario_document
from sar_sim.trials.loaded_runs import (
    HEADER,
    ONE_CORE,
    Load,
    LoadedRun,
    load_of,
    loaded_scenario,
    read_loaded,
    summary,
)

LOADS = ["cpu4,io2", ONE_CORE]
PATIENCE_S = 1800.0


@contextlib.contextmanager
def busy(load: Load, scratch: Path) -> Iterator[None]:
    """Keep the machine busy meanwhile, by stress-ng where that is installed."""
    commands = load.commands(scratch, shutil.which("stress-ng"))
    running = [
        NodeProcess(f"load {i}", command, scratch / f"load_{i}.log")
        for i, command in enumerate(commands)
    ]
    try:
        yield
    finally:
        for one in running:
            one.kill()


def command_of(load: Load, out: Path, options: list[str]) -> list[str]:
    """Return what flies the graph; on one core where that is the load."""
    command = launch_command(out, *options)
    if load.one_core:
        core = min(os.sched_getaffinity(0))
        return ["taskset", "--cpu-list", str(core), *command]
    return command


def fly(load: Load, scenario: Scenario, seed: int, out: Path, options: list[str]) -> LoadedRun:
    """Fly once, and return what came of it. Raises ``OSError`` or ``ValueError`` if it failed."""
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    file = out / "loaded.yaml"
    file.write_text(yaml.safe_dump(scenario_document(scenario)), "utf-8")
    command = command_of(load, out / "run", ["--scenario", str(file), *options])
    begun = time.monotonic()
    with busy(load, out):
        done = subprocess.run(  # noqa: S603
            command, capture_output=True, text=True, timeout=PATIENCE_S, check=False
        )
    if done.returncode != 0:
        raise OSError(f"{load}, seed {seed}: the flight failed:\n{done.stderr}")
    return read_loaded(load, seed, out / "run" / "bag", time.monotonic() - begun)


def fly_all(args: argparse.Namespace, base: Scenario, folder: Path) -> int:
    """Fly every load, print rows and summaries; return how many flights failed."""
    options = ["--speed", f"{args.speed:g}"] + ["--no-priorities"] * args.no_priorities
    failed, found = 0, []
    sys.stdout.write(HEADER + "\n")
    for load in args.load:
        runs = []
        for seed in range(args.seed, args.seed + args.flights):
            scenario = loaded_scenario(base, seed, args.corners)
            out = folder / f"{load}_{seed:03d}".replace(",", "_")
            try:
                runs.append(fly(load, scenario, seed, out, options))
            except (OSError, ValueError, subprocess.TimeoutExpired) as error:
                failed += 1
                sys.stderr.write(f"loaded_flights: {error}\n")
                continue
            sys.stdout.write(runs[-1].row() + "\n")
            sys.stdout.flush()
        found += [summary(runs)] if runs else []
    sys.stdout.write("\n" + "".join(f"{line}\n" for line in found))
    return failed


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the table, a row after each flight; 1 when one failed, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="loaded_flights", description=__doc__)
    parser.add_argument("--scenario", default="human", help="a scenario's name or YAML file")
    parser.add_argument("--flights", type=int, default=20, help="with each load")
    parser.add_argument(
        "--load", nargs="+", default=LOADS, metavar="LOAD", help="cpuN,ioN, one_core or none"
    )
    parser.add_argument("--corners", type=int, default=2, help="of each flight")
    parser.add_argument("--seed", type=int, default=1, help="of the first flight")
    parser.add_argument("--speed", type=float, default=1.0, help="times real time")
    parser.add_argument("--no-priorities", action="store_true", help="leave priorities alone")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep the flights here")
    args = parser.parse_args(argv)
    with tempfile.TemporaryDirectory() as scratch:
        try:
            args.load = [load_of(text) for text in args.load]
            base = load_scenario(find_scenario(args.scenario))
            failed = fly_all(args, base, args.keep or Path(scratch))
        except (OSError, ValueError) as error:
            sys.stderr.write(f"loaded_flights: {error}\n")
            return 2
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
