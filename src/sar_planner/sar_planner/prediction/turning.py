"""Whether a helicopter has turned at its corner, by its own motion. Pure."""

from __future__ import annotations

import math

from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import CornerEstimate, Motion
from sar_planner.prediction.corner_cost import LEAST_TURN_RAD, MOVING_MPS

SURE_SIGMAS = 3.0


def has_turned(helicopter: Motion | None, corner: CornerEstimate | None) -> bool:
    """Return whether it flies elsewhere than before a corner: that was rolled."""
    if helicopter is None or corner is None or helicopter.speed_mps <= MOVING_MPS:
        return False
    return abs(wrap_angle(helicopter.course_rad - corner.stop.heading_rad)) > LEAST_TURN_RAD


def surely_leaves(
    helicopter: Motion | None,
    corner: CornerEstimate | None,
    turn_rad: float,
    velocity_sigma_mps: float,
) -> bool:
    """Return whether it surely flies along the leg after a corner already.

    As who flies through the corner does, and a receiver that measures velocity shows. ``turn_rad``:
    to that leg, left positive. ``velocity_sigma_mps``: along one axis.
    """
    if not has_turned(helicopter, corner):
        return False
    assert helicopter is not None
    assert corner is not None
    off = helicopter.course_rad - corner.stop.heading_rad - turn_rad
    return helicopter.speed_mps * math.cos(off) > max(MOVING_MPS, SURE_SIGMAS * velocity_sigma_mps)
