"""``monitor_trials``: encounters with a planner that misbehaves, and hours of normal formation."""

from __future__ import annotations

import argparse
import math
import os
import sys
from functools import partial

from sar_sim.encounters import fly_encounter, fly_formation, formation_summary, summary
from sar_sim.options import find_scenario
from sar_sim.pool import in_parallel
from sar_sim.scenario import load_scenario

MISSION_H = 0.5


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the tables; 1 when an encounter that could be escaped came near."""
    parser = argparse.ArgumentParser(prog="monitor_trials", description=__doc__)
    parser.add_argument("--encounters", type=int, default=0, help="how many")
    parser.add_argument("--formation-hours", type=float, default=0.0, help="of normal flying")
    parser.add_argument("--scenario", default="arduplane", help="flown in normal formation")
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    args = parser.parse_args(argv)
    if args.encounters <= 0 and not args.formation_hours > 0.0:
        sys.stderr.write("monitor_trials: expected --encounters N or --formation-hours H\n")
        return 2
    failed = 0
    if args.encounters > 0:
        seeds = range(args.first_seed, args.first_seed + args.encounters)
        flown = in_parallel(fly_encounter, seeds, args.jobs)
        sys.stdout.write(f"{args.encounters} encounters\n{summary(flown)}\n")
        failed = sum(encounter.failed for encounter in flown)
        for encounter in sorted(flown, key=lambda encounter: encounter.closest_m)[:5]:
            sys.stdout.write(f"nearest: {encounter}\n")
        sys.stdout.flush()
    if args.formation_hours > 0.0:
        try:
            base = load_scenario(find_scenario(args.scenario))
        except ValueError as error:
            sys.stderr.write(f"monitor_trials: {error}\n")
            return 2
        missions = math.ceil(args.formation_hours / MISSION_H)
        seeds = range(args.first_seed, args.first_seed + missions)
        hours = in_parallel(partial(fly_formation, base=base), seeds, args.jobs)
        sys.stdout.write(formation_summary(hours) + "\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
