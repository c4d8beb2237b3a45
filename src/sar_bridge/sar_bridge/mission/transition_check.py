"""How nearly a UAV flies a new list by the way in which it is led over to it.

A list is meant to be flown leg by leg, each from the waypoint before. Where a jump leads over to
it, the UAV comes along a leg of another list instead. Both are flown in advance here, and compared.
"""

from __future__ import annotations

import math

import numpy as np

from sar_bridge.arduplane.l1_kernels import fly_in
from sar_bridge.arduplane.l1_predictor import FollowerTuning, handling, level
from sar_bridge.arduplane.list_entry import Point
from sar_estimator.common.states import FloatArray, Motion

STEP_S = 0.1
LOOKED_BEHIND_S = 8.0
WORTH_M = 1.0


class Track:
    """The track of a UAV that flies a list, shape (n, 2) [m], leg by leg, the first from a place.

    ``begin``: of the leg to the first point. It is flown until ``LOOKED_BEHIND_S`` after the UAV
    can be ``until_m`` [m] away: what is compared are the turns behind the place of the jump.
    """

    def __init__(
        self,
        points: FloatArray,
        begin: Point,
        uav: Motion,
        tuning: FollowerTuning,
        *,
        until_m: float,
    ) -> None:
        """Fly it."""
        self._uav = uav
        self._steps = round((until_m / max(uav.speed_mps, 1.0) + LOOKED_BEHIND_S) / STEP_S)
        self._handling = handling(tuning, STEP_S)
        self.flown = self._fly(points, begin)

    def apart_m(self, points: FloatArray, begin: Point) -> float:
        """Return how far apart the UAV gets that flies other points, the first leg from ``begin``.

        [m], in the time that is looked at.
        """
        apart = self._fly(points, begin) - self.flown
        return math.sqrt(float(np.square(apart).sum(axis=1).max()))

    def _fly(self, points: FloatArray, begin: Point) -> FloatArray:
        """Return where the UAV comes, shape (n, 2) [m], every ``STEP_S``."""
        ahead = np.ascontiguousarray(points, dtype=np.float64)
        return fly_in(ahead, np.array(begin), level(self._uav), self._handling, self._steps)
