"""``rejoin_trials``: from random starts onto the moving slot, flown in simulation."""

from __future__ import annotations

import argparse
import sys
from functools import partial

import numpy as np

from sar_planner.parameters.corner import CornerParameters
from sar_sim.jobs.pool import Workers, add_keep_option, add_work_options, in_parallel
from sar_sim.jobs.result_cache import ResultCache
from sar_sim.trials.rejoin_trials import PHASES, Trial, fly


def table(trials: list[Trial], separation_m: float) -> str:
    """Return what came of the trials as text."""
    lines = []
    for phase in (*PHASES, "all"):
        part = [trial for trial in trials if phase in (trial.phase, "all")]
        if not part:
            continue
        ratios = np.array([trial.ratio for trial in part])
        reached = [trial.miss_m <= 10.0 and trial.heading_error_deg <= 2.0 for trial in part]
        apart = [trial.closest_m >= separation_m for trial in part]
        lines.append(
            f"{phase:13s} {len(part):6d} starts: on the slot within 10 m and 2 deg "
            f"{np.mean(reached):.2%}, apart {np.mean(apart):.2%} "
            f"(least {min(trial.closest_m for trial in part):.1f} m), time over the bound: "
            f"median {np.median(ratios):.3f}, p90 {np.percentile(ratios, 90):.3f}, "
            f"max {ratios.max():.3f}, within 15 % {np.mean(ratios <= 1.15):.2%}"
        )
    return "\n".join(lines)


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the table; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="rejoin_trials", description=__doc__)
    add_work_options(parser, seeds=("starts", 200))
    add_keep_option(parser)
    parser.add_argument(
        "--bound",
        choices=("full", "free"),
        default="full",
        help="on the time: with the helicopter in the way (a process prepares it for a minute), "
        "or as if it was not",
    )
    args = parser.parse_args(argv)
    seeds = range(args.first_seed, args.first_seed + args.starts)
    try:
        kept = ResultCache(args.keep, {"work": "rejoin_trials", "bound": args.bound})
        work = partial(fly, bounded=args.bound == "full")
        with Workers(args.jobs, args.scheduler) as workers:
            trials = in_parallel(work, seeds, workers, kind=Trial, kept=kept)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"rejoin_trials: {error}\n")
        return 2
    sys.stdout.write(table(trials, CornerParameters().separation_m) + "\n")
    for trial in sorted(trials, key=lambda trial: trial.closest_m)[:3]:
        sys.stdout.write(f"nearest: seed {trial.seed}, {trial.phase}, {trial.closest_m:.1f} m\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
