"""``monitor_trials``: encounters with a planner that misbehaves, and hours of normal formation."""

from __future__ import annotations

import argparse
import math
import sys
from functools import partial

from sar_sim.encounters import (
    Encounter,
    Hours,
    fly_encounter,
    fly_formation,
    formation_summary,
    summary,
)
from sar_sim.kept import Kept
from sar_sim.options import find_scenario
from sar_sim.pool import add_work_options, in_parallel
from sar_sim.scenario import load_scenario, scenario_document

MISSION_H = 0.5


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the tables; 1 when an encounter that could be escaped came near."""
    parser = argparse.ArgumentParser(prog="monitor_trials", description=__doc__)
    add_work_options(parser, seeds=("encounters", 0))
    parser.add_argument("--formation-hours", type=float, default=0.0, help="of normal flying")
    parser.add_argument("--scenario", default="arduplane", help="flown in normal formation")
    args = parser.parse_args(argv)
    if args.encounters <= 0 and not args.formation_hours > 0.0:
        sys.stderr.write("monitor_trials: expected --encounters N or --formation-hours H\n")
        return 2
    failed = 0
    try:
        base = load_scenario(find_scenario(args.scenario))
        about = {"work": "monitor_trials", "scenario": scenario_document(base)}
        kept = Kept(args.keep, about)
    except ValueError as error:
        sys.stderr.write(f"monitor_trials: {error}\n")
        return 2
    if args.encounters > 0:
        seeds = range(args.first_seed, args.first_seed + args.encounters)
        flown = in_parallel(
            fly_encounter, seeds, args.jobs, kind=Encounter, kept=kept, part="encounters"
        )
        sys.stdout.write(f"{args.encounters} encounters\n{summary(flown)}\n")
        failed = sum(encounter.failed for encounter in flown)
        for encounter in sorted(flown, key=lambda encounter: encounter.closest_m)[:5]:
            sys.stdout.write(f"nearest: {encounter}\n")
        sys.stdout.flush()
    if args.formation_hours > 0.0:
        missions = math.ceil(args.formation_hours / MISSION_H)
        seeds = range(args.first_seed, args.first_seed + missions)
        fly = partial(fly_formation, base=base)
        hours = in_parallel(fly, seeds, args.jobs, kind=Hours, kept=kept, part="formation")
        sys.stdout.write(formation_summary(hours) + "\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
