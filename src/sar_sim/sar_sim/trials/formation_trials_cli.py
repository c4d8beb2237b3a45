"""``formation_trials``: slots changed, UAVs lost and late at random, in whole missions."""

from __future__ import annotations

import argparse
import sys

from sar_sim.jobs.pool import Workers, add_keep_option, add_work_options, in_parallel
from sar_sim.jobs.result_cache import ResultCache
from sar_sim.trials.formation_trials import Trial, fly, summary

NEAREST = 5


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the table; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="formation_trials", description=__doc__)
    add_work_options(parser, seeds=("changes", 100))
    add_keep_option(parser)
    args = parser.parse_args(argv)
    seeds = range(args.first_seed, args.first_seed + args.changes)
    try:
        kept = ResultCache(args.keep, {"work": "formation_trials"})
        with Workers(args.jobs, args.scheduler) as workers:
            trials = in_parallel(fly, seeds, workers, kind=Trial, kept=kept)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"formation_trials: {error}\n")
        return 2
    sys.stdout.write(summary(trials) + "\n")
    for trial in sorted(trials, key=lambda trial: trial.helicopter_m)[:NEAREST]:
        sys.stdout.write(f"nearest: seed {trial.seed}, {trial.kind}, {trial.helicopter_m:.1f} m\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
