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
from collections.abc import Iterator
from dataclasses import dataclass

from sar_bridge.follower import Flown, FollowerTuning, Leg, Point, is_passed, places
from sar_estimator.states import FloatArray, Motion

STEP_S = 0.1
LOOKED_AHEAD_S = 8.0
REACH_M = 200.0
TRIED = 10
WORTH_M = 1.0


@dataclass
class _Way:
    """Legs through points; ``direct``: those on which the UAV heads for the end."""

    points: list[Point]
    begin: Point
    direct: frozenset[int] = frozenset()
    at: int = 0
    _leg: Leg | None = None

    def leg(self, here: Point) -> Leg | None:
        """Return the line being flown; None behind the last."""
        if self.at < len(self.points) and is_passed(self.begin, self.points[self.at], *here):
            self.begin = self.points[self.at]
            self.at += 1
            self._leg = None
            if self.at in self.direct or (
                self.at < len(self.points) and is_passed(self.begin, self.points[self.at], *here)
            ):
                self.begin = here
        if self.at >= len(self.points):
            return None
        if self.at in self.direct:
            return Leg(here, self.points[self.at])
        if self._leg is None:
            self._leg = Leg(self.begin, self.points[self.at])
        return self._leg


class Track:
    """The track of a UAV that flies a list, shape (n, 2) [m], leg by leg from where it is."""

    def __init__(self, points: FloatArray, uav: Motion, tuning: FollowerTuning) -> None:
        """Fly it."""
        self._points = places(points)
        self._uav, self._tuning = uav, tuning
        self._here = (uav.x_m, uav.y_m)
        self._wanted = list(self._flown(_Way(self._points, self._here)))

    def apart_m(self, points: FloatArray, begin: Point, direct: frozenset[int]) -> float:
        """Return how far apart the UAV gets that flies other points, the first leg from ``begin``.

        [m], within ``LOOKED_AHEAD_S``. ``direct``: the legs on which it heads for the end.
        """
        return self._apart_m(_Way(places(points), begin, direct))

    def entry(self, flown_to: Point | None, *, tracked: bool) -> tuple[int, float]:
        """Return which waypoint to make current, and how far apart the UAV gets then [m].

        ``flown_to``: the waypoint being flown to until then, None where it is not known.
        ``tracked``: whether the first leg will be.
        """
        direct = frozenset((1,) if tracked else (0, 1))
        best, least = 0, math.inf
        for i, point in enumerate(self._points[:TRIED]):
            if i > 0 and math.dist(self._here, point) > REACH_M:
                break
            begin = self._here if flown_to is None else flown_to
            begin = self._here if is_passed(begin, point, *self._here) else begin
            apart = self._apart_m(_Way(self._points[i:], begin, direct), least - WORTH_M)
            if apart < least - WORTH_M:
                best, least = i, apart
        return best, least

    def _apart_m(self, way: _Way, within_m: float = math.inf) -> float:
        """Return the greatest distance from what is wanted [m]; infinite beyond ``within_m``."""
        greatest = 0.0
        for here, there in zip(self._flown(way), self._wanted, strict=True):
            greatest = max(greatest, math.dist(here, there))
            if greatest >= within_m:
                return math.inf
        return greatest

    def _flown(self, way: _Way) -> Iterator[Point]:
        """Yield where the UAV comes [m], every ``STEP_S``."""
        uav = Flown(self._uav, self._tuning, STEP_S)
        for _ in range(round(LOOKED_AHEAD_S / STEP_S)):
            leg = way.leg((uav.x_m, uav.y_m))
            if leg is None:
                uav.straight_on()
            else:
                uav.along(leg)
            yield uav.x_m, uav.y_m
