"""``find_trials``: somebody is seen at random, marked, orbited and left, in whole missions."""

from __future__ import annotations

import argparse
import sys

import numpy as np

from sar_planner.parameters.corner import CornerParameters
from sar_sim.jobs.pool import Workers, add_keep_option, add_work_options, in_parallel
from sar_sim.jobs.result_cache import ResultCache
from sar_sim.trials.find_trials import PILOTS, Trial, fly


def table(trials: list[Trial], separation_m: float) -> str:
    """Return what came of the trials as text."""
    lines = []
    for pilot in (*PILOTS, "all"):
        part = [trial for trial in trials if pilot in (trial.pilot, "all")]
        if not part:
            continue
        waits = np.array([trial.wait_s for trial in part])
        reached = np.array([trial.reach_s for trial in part])
        held = np.array([trial.held for trial in part])
        lines.append(
            f"{pilot:17s} {len(part):5d} finds: orbited {np.mean(~np.isnan(reached)):.1%}, begun "
            f"after {_quantiles(waits)} s, on the circle after {_quantiles(reached)} s (median, "
            f"95 %), held {np.nanmean(held):.0%} of the time; least separation in orbit "
            f"{min(trial.orbit_closest_m for trial in part):.0f} m, after the order "
            f"{min(trial.closest_m for trial in part):.0f} m, under {separation_m:.0f} m in "
            f"{sum(trial.closest_m < separation_m for trial in part)}; "
            f"{sum(trial.escapes for trial in part)} escapes; in formation again "
            f"{np.mean([trial.regained for trial in part]):.1%}"
        )
    return "\n".join(lines)


def _quantiles(values: np.ndarray) -> str:
    known = values[~np.isnan(values)]
    if not known.size:
        return "-"
    return f"{np.median(known):.0f}/{np.percentile(known, 95.0):.0f}"


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the table; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="find_trials", description=__doc__)
    add_work_options(parser, seeds=("finds", 100))
    add_keep_option(parser)
    args = parser.parse_args(argv)
    seeds = range(args.first_seed, args.first_seed + args.finds)
    try:
        kept = ResultCache(args.keep, {"work": "find_trials"})
        with Workers(args.jobs, args.scheduler) as workers:
            trials = in_parallel(fly, seeds, workers, kind=Trial, kept=kept)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"find_trials: {error}\n")
        return 2
    sys.stdout.write(table(trials, 0.8 * CornerParameters().spacing_m) + "\n")
    for trial in sorted(trials, key=lambda trial: trial.closest_m)[:5]:
        sys.stdout.write(f"nearest: seed {trial.seed}, {trial.pilot}, {trial.closest_m:.1f} m\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
