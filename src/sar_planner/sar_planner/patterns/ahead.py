"""What is expected still to be flown of a pattern, from the leg on as it is really flown. Pure."""

from __future__ import annotations

import numpy as np

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import FloatArray
from sar_planner.patterns.legs import CORNERS, Leg, PatternTerms, ends_of
from sar_planner.patterns.progress import expectation

LEGS_AHEAD = 6
MOVED_M = 20.0


def corners_ahead(
    terms: PatternTerms,
    leg: int,
    begun: Pose,
    *,
    flown_m: float = 0.0,
    stop_m: float | None = None,
) -> FloatArray:
    """Return the expected end of a leg (from 0) and the corners after it, shape (n, 2) [m].

    Of ``LEGS_AHEAD`` legs; fewer where the pattern ends, or before a leg whose length is not known.
    ``begun``: where the leg began, with its heading, as it is really flown. ``flown_m``: how much
    of it is flown; it ends no sooner. ``stop_m``: where along it the helicopter is predicted to
    stop, None while that is not.
    """
    found: list[Leg] = []
    last = CORNERS.get(terms.kind, leg + LEGS_AHEAD)
    for one in range(leg, min(leg + LEGS_AHEAD, last + 1)):
        turn_rad, length_m = expectation(terms, one)
        if length_m <= 0.0:
            break
        if one == leg:
            length_m = max(length_m, flown_m) if stop_m is None else stop_m
        found.append(Leg(length_m, turn_rad))
    return ends_of(found, begun)


def have_moved(points: FloatArray, told: FloatArray) -> bool:
    """Whether points, shape (n, 2) [m], are worth telling where others were told."""
    if len(points) != len(told):
        return True
    return bool((np.hypot(*(points - told).T) > MOVED_M).any())
