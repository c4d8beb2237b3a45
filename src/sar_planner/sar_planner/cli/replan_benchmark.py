"""``replan_benchmark``: how long one full replan takes on this machine."""

from __future__ import annotations

import argparse
import contextlib
import sys
import time
from dataclasses import replace

import numpy as np

from sar_planner.guidance.l1_waypoints import L1Tuning
from sar_planner.guidance.waypoint_lists import WaypointLists
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.rules.deadbeat_rules import DeadbeatRules

LISTS = {"waypoints on the path": None, "waypoints on an L1 guide": L1Tuning(15.0)}


def replan(
    lag_m: float, lead_m: float, speed_mps: float, accel_mps2: float, tuning: L1Tuning | None = None
) -> int:
    """Choose the rule, check the separation, make the list; return how many waypoints.

    ``tuning``: of the autopilot that the list is for, None for one that flies a polygon.
    """
    nominal = CornerParameters()
    parameters = replace(nominal, speed_mps=speed_mps, accel_mps2=accel_mps2)
    rules = DeadbeatRules(parameters)
    plan = rules.plan(lag_m, lead_m=lead_m, separation_m=nominal.separation_m)
    lists = WaypointLists(nominal, MissionParameters())
    lists.tuning = tuning
    return len(lists.along(plan.path, speed_mps))


def replan_times_ms(
    count: int, lags_m: tuple[float, float], tuning: L1Tuning | None
) -> list[float]:
    """Return how long each of many replans takes [ms]; they are drawn from a fixed seed."""
    rng = np.random.default_rng(1)
    draws = np.column_stack(
        (
            rng.uniform(*lags_m, count),
            rng.uniform(0.0, 120.0, count),
            rng.uniform(18.0, 22.0, count),
            rng.uniform(2.0, 3.0, count),
        )
    )
    replan(0.0, 0.0, 20.0, 2.5, tuning)
    times_ms = []
    for lag, lead, speed, accel in draws:
        begun = time.perf_counter()
        # To find that there is no path takes as long, and counts.
        with contextlib.suppress(ValueError):
            replan(lag, lead, speed, accel, tuning)
        times_ms.append(1e3 * (time.perf_counter() - begun))
    return times_ms


def main(argv: list[str] | None = None) -> int:
    """Time it; the lags, lead-ins, speeds and decelerations are drawn from a fixed seed."""
    parser = argparse.ArgumentParser(prog="replan_benchmark", description=__doc__)
    parser.add_argument("--count", type=int, default=2000, help="replans")
    parser.add_argument("--lags", type=float, nargs=2, default=(-150.0, 1000.0), help="of L, m")
    args = parser.parse_args(argv)
    low, high = (float(lag) for lag in args.lags)
    for name, tuning in LISTS.items():
        times_ms = replan_times_ms(args.count, (low, high), tuning)
        sys.stdout.write(
            f"{args.count} replans, L from {low:g} to {high:g} m, {name}: "
            f"median {np.median(times_ms):.2f} ms, p99 {np.percentile(times_ms, 99):.2f} ms, "
            f"max {max(times_ms):.2f} ms\n"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
