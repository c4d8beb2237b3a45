"""The lag to have on a leg in wind, so that the corner at its end begins as it should. Pure.

Where the airspeeds do not allow V over ground on a course, a UAV falls behind, or comes ahead, all
along the leg. It begins the leg as far ahead, or behind, as it will lose, or gain.
"""

from __future__ import annotations

from sar_planner.guidance.wind_triangle import AirEnvelope

GUST_SIGMAS = 0.8
"""Kept in hand for what a leg's own mean wind may be more than that over minutes."""


def drift_m(air: AirEnvelope, course_rad: float, speed_mps: float, left_m: float) -> float:
    """Return the lag [m] that is gone after ``left_m`` more of a leg beside a helicopter.

    ``speed_mps``: the helicopter's. Below 0 where the UAV will fall behind, above where it will
    come ahead, 0 where it can keep its place in gusts, too.
    """
    if air.steady is None:
        return 0.0
    slowest, fastest = air.over_minutes.on_course_mps(course_rad)
    gusts = GUST_SIGMAS * air.gusts_mps
    falls_behind = max(0.0, speed_mps + gusts - fastest)
    comes_ahead = max(0.0, slowest + gusts - speed_mps)
    if falls_behind > 0.0 and comes_ahead > 0.0:
        return 0.0
    return (comes_ahead - falls_behind) * left_m / speed_mps
