"""``monitor_trials``: encounters with a planner that misbehaves."""

from __future__ import annotations

import argparse
import sys

from sar_sim.jobs.pool import Workers, add_keep_option, add_work_options, in_parallel
from sar_sim.jobs.result_cache import ResultCache
from sar_sim.trials.encounters import Encounter, fly_encounter, summary


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the table; 1 when one that could be escaped came near, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="monitor_trials", description=__doc__)
    add_work_options(parser, seeds=("encounters", 100))
    add_keep_option(parser)
    args = parser.parse_args(argv)
    seeds = range(args.first_seed, args.first_seed + args.encounters)
    try:
        kept = ResultCache(args.keep, {"work": "monitor_trials"})
        with Workers(args.jobs, args.scheduler) as workers:
            flown = in_parallel(fly_encounter, seeds, workers, kind=Encounter, kept=kept)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"monitor_trials: {error}\n")
        return 2
    sys.stdout.write(f"{args.encounters} encounters\n{summary(flown)}\n")
    for encounter in sorted(flown, key=lambda encounter: encounter.closest_m)[:5]:
        sys.stdout.write(f"nearest: {encounter}\n")
    return 1 if any(encounter.failed for encounter in flown) else 0


if __name__ == "__main__":
    sys.exit(main())
