"""How nearly a UAV flies a new list, by the way in which it is led over to it.

By a jump, its legs stay legs like any others. By DO_SET_MISSION_CURRENT, ArduPlane tracks the line
from the waypoint it was flying to, to the new one; on the leg behind that it heads for the end
instead, and so it does where such a command follows upon another on the same leg. A leg whose
finish line is behind the UAV already begins where the UAV is: it turns back. Waypoints that stand
close together in a turn, aside of the UAV's way, so bend it far from where the list was to lead it.
All of that is flown in advance here, and compared with the list flown leg by leg.
"""

from __future__ import annotations

import math

import numpy as np

from sar_bridge.follower import FollowerTuning, Point, handling, level, places
from sar_bridge.kernels import fly_in, is_passed
from sar_estimator.states import FloatArray, Motion

STEP_S = 0.1
LOOKED_AHEAD_S = 8.0
REACH_M = 200.0
TRIED = 10
WORTH_M = 1.0


class Track:
    """The track of a UAV that flies a list, shape (n, 2) [m], leg by leg from where it is."""

    def __init__(self, points: FloatArray, uav: Motion, tuning: FollowerTuning) -> None:
        """Fly it."""
        self._points = np.ascontiguousarray(points, dtype=np.float64)
        self._uav = uav
        self._handling = handling(uav, tuning, STEP_S)
        self._here = (uav.x_m, uav.y_m)
        self._wanted = self._flown(self._points, self._here, frozenset())

    def apart_m(self, points: FloatArray, begin: Point, direct: frozenset[int]) -> float:
        """Return how far apart the UAV gets that flies other points, the first leg from ``begin``.

        [m], within ``LOOKED_AHEAD_S``. ``direct``: the legs on which it heads for the end.
        """
        flown = self._flown(np.ascontiguousarray(points, dtype=np.float64), begin, direct)
        return math.sqrt(float(np.square(flown - self._wanted).sum(axis=1).max()))

    def entry(self, flown_to: Point | None, *, tracked: bool) -> tuple[int, float]:
        """Return which waypoint to make current, and how far apart the UAV gets then [m].

        ``flown_to``: the waypoint being flown to until then, None where it is not known.
        ``tracked``: whether the first leg will be.
        """
        direct = frozenset((1,) if tracked else (0, 1))
        best, least = 0, math.inf
        for i, point in enumerate(places(self._points[:TRIED])):
            if i > 0 and math.dist(self._here, point) > REACH_M:
                break
            begin = self._here if flown_to is None else flown_to
            begin = self._here if is_passed(*begin, *point, *self._here) else begin
            apart = self.apart_m(self._points[i:], begin, direct)
            if apart < least - WORTH_M:
                best, least = i, apart
        return best, least

    def _flown(self, points: FloatArray, begin: Point, direct: frozenset[int]) -> FloatArray:
        """Return where the UAV comes, shape (n, 2) [m], every ``STEP_S``."""
        heads = np.zeros(len(points), dtype=np.bool_)
        heads[[i for i in direct if i < len(points)]] = True
        steps = round(LOOKED_AHEAD_S / STEP_S)
        return fly_in(points, heads, np.array(begin), level(self._uav), self._handling, steps)
