"""``separation_trials``: the planner's bound of a path's least distance, beside a fine look."""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.apart_kernels import TOLERANCE_M
from sar_planner.paths.flight_path import FloatArray
from sar_sim.trials.separation_trials import PATHS, draw

QUANTILES = (0.0, 1.0, 50.0, 99.0, 100.0)
ABOVE_M = 1e-6


def table(gaps_m: FloatArray, bound_us: float, kept_us: float) -> str:
    """Return how far the bounds are below what is found, and what a path costs, as text."""
    told = ", ".join(f"{np.percentile(gaps_m, q):.4f}" for q in QUANTILES)
    return (
        f"{gaps_m.size} paths: above the least distance in {np.sum(gaps_m < -ABOVE_M)}, "
        f"below it by {told} m (least, 1 %, median, 99 %, most; tolerance {TOLERANCE_M:g} m)\n"
        f"a path: {bound_us:.1f} us for its bound, {kept_us:.1f} us for whether it keeps what is "
        f"asked"
    )


def main(argv: list[str] | None = None) -> int:
    """Compare them and print the table; 1 when a bound was above the distance, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="separation_trials", description=__doc__)
    parser.add_argument("--paths", type=int, default=10_000, help=f"{PATHS} from each seed")
    parser.add_argument("--first-seed", type=int, default=0)
    args = parser.parse_args(argv)
    count = args.paths // PATHS
    if count < 1 or args.first_seed < 0:
        sys.stderr.write(f"separation_trials: expected --paths {PATHS} or more, a seed from 0\n")
        return 2
    kept_m = CornerParameters().separation_m
    gaps, spent_s = [], np.zeros(2)
    for seed in range(args.first_seed, args.first_seed + count):
        case = draw(seed)
        begun = time.perf_counter()
        bounds = case.bounds_m()
        bounded = time.perf_counter()
        case.bounds_m(kept_m)
        spent_s += bounded - begun, time.perf_counter() - bounded
        gaps.append(case.sampled_m() - bounds)
    bound_us, kept_us = (1e6 * spent_s / (count * PATHS)).tolist()
    all_gaps = np.concatenate(gaps)
    sys.stdout.write(table(all_gaps, bound_us, kept_us) + "\n")
    return 1 if (all_gaps < -ABOVE_M).any() else 0


if __name__ == "__main__":
    sys.exit(main())
