"""``fly``: a scenario flown offline, with the same results folder as a flight of the graph."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

from tqdm import tqdm

from sar_estimator.bags.bag import BagWriter
from sar_planner.parameters.corner import PLANNERS
from sar_sim.bags.tracks import load_track
from sar_sim.flight.offline import OfflineFlight, Progress
from sar_sim.report.report import write_report
from sar_sim.report.report_cli import summary_line
from sar_sim.scenario.options import (
    add_flight_options,
    estimator_parameters,
    new_run_folder,
    scenario_from,
)
from sar_sim.scenario.scenario import Scenario


def status_line(progress: Progress) -> str:
    """Return progress in a few words."""
    lag, apart = progress.lag_m, progress.separation_m
    return (
        f"corner {progress.corner} {progress.rule:<5}"
        f" L {'–' if lag is None else f'{lag:7.1f} m'}"
        f" separation {'–' if apart is None else f'{apart:6.0f} m'}"
    )


def offline_track(helicopter: str) -> Path | None:
    """Return the track to fly, None for the simulated pilot. Raises ``ValueError`` for a topic."""
    if helicopter == "topic":
        raise ValueError("--helicopter topic: expected sim, a CSV file or a bag, offline")
    return None if helicopter == "sim" else Path(helicopter)


def fly(
    scenario: Scenario,
    out: Path,
    *,
    rules: str,
    truth: bool,
    track: Path | None,
    quiet: bool,
    watch_only: bool = False,
) -> dict[str, object]:
    """Fly a scenario into the results folder ``out``; return the metrics."""
    fixes = load_track(track) if track is not None else None
    bag = BagWriter(out / "bag")
    try:
        flight = OfflineFlight(
            scenario,
            rules=rules,
            truth=truth,
            watch_only=watch_only,
            track=fixes,
            estimator_parameters=estimator_parameters(scenario, recorded=track is not None),
            bag=bag,
        )
        total = math.ceil(flight.world.end_s)
        with tqdm(total=total, unit="s", disable=quiet, leave=False) as bar:

            def told(progress: Progress) -> None:
                bar.set_description_str(status_line(progress), refresh=False)
                bar.update(1)

            flight.run(told)
    finally:
        bag.close()
    return write_report(out / "bag", out)


def main(argv: list[str] | None = None) -> int:
    """Run the command; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="fly", description=__doc__)
    add_flight_options(parser, rule_sets=PLANNERS)
    parser.add_argument("--truth", action="store_true", help="the true state, not the filter's")
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    args = parser.parse_args(argv)
    try:
        scenario = scenario_from(args)
        track = offline_track(args.helicopter)
        out = new_run_folder(args.out)
        metrics = fly(
            scenario,
            out,
            rules=args.rules,
            truth=args.truth,
            track=track,
            quiet=args.quiet,
            watch_only=args.watch_only,
        )
    except (OSError, ValueError) as error:
        sys.stderr.write(f"fly: {error}\n")
        return 2
    sys.stdout.write(f"{summary_line(metrics)}\n{out}/report.html\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
