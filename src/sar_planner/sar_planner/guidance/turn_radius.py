"""What radius the UAV really turns with, learnt from its own motion while it turns.

An autopilot whose turn rate is overestimated flies wide of every arc that it is given: the tightest
radius that it holds in a turn is then larger than the one planned with. Paths are planned with
what it holds, and something to spare, from then on.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import Motion

STEP_S = 0.19
GAP_S = 2.0
HELD_RAD = math.radians(30.0)
SURE_RAD = math.radians(100.0)
STRAIGHT_SHARE = 0.3
DEAD_BAND = 1.08
SPARE = 1.1
MOST_SPACINGS = 0.8


@dataclass(frozen=True, slots=True)
class _Sample:
    """A time in a turn: turned [rad] and flown [m] since it began."""

    turned_rad: float
    flown_m: float


class TurnRadius:
    """The radius that paths are planned with: the configured one, or what is learnt to be needed.

    ``radius_m``: never less than the configured radius, nor more than 0.8 of the spacing (or the
    configured one where that is more): not far beyond, nothing is guaranteed.
    """

    def __init__(self, configured_m: float, spacing_m: float) -> None:
        """Believe what is configured."""
        self.radius_m = configured_m
        self._most_m = max(configured_m, MOST_SPACINGS * spacing_m)
        self._last: Motion | None = None
        self._side = 0.0
        self._turn: deque[_Sample] = deque()
        self._held_m = math.inf

    def forget_turn(self) -> None:
        """Begin a new turn: what was flown before was not asked for by a path."""
        self._last = None
        self._end_turn()

    def watch(self, motion: Motion) -> bool:
        """Take the UAV's newest motion; return whether a larger radius has been learnt from it."""
        last = self._last
        if last is None or not 0.0 <= motion.time_s - last.time_s <= GAP_S:
            self.forget_turn()
            self._last = motion
            return False
        since = motion.time_s - last.time_s
        if since < STEP_S:
            return False
        self._last = motion
        turned = wrap_angle(motion.course_rad - last.course_rad)
        flown = math.hypot(motion.x_m - last.x_m, motion.y_m - last.y_m)
        slow = abs(turned) * self.radius_m < STRAIGHT_SHARE * flown
        if slow or turned * self._side < 0.0:
            self._end_turn()
            return False
        self._side = turned
        return self._turned(abs(turned), flown)

    def _end_turn(self) -> None:
        self._side, self._held_m = 0.0, math.inf
        self._turn.clear()

    def _turned(self, turned_rad: float, flown_m: float) -> bool:
        """Take a part of a turn. Sure of what is held is one after more than a quarter circle."""
        before = self._turn[-1] if self._turn else _Sample(0.0, 0.0)
        now = _Sample(before.turned_rad + turned_rad, before.flown_m + flown_m)
        self._turn.append(now)
        while len(self._turn) > 1 and now.turned_rad - self._turn[1].turned_rad >= HELD_RAD:
            self._turn.popleft()
        first = self._turn[0]
        arc = now.turned_rad - first.turned_rad
        if arc >= HELD_RAD:
            self._held_m = min(self._held_m, (now.flown_m - first.flown_m) / arc)
        if now.turned_rad < SURE_RAD or self._held_m <= DEAD_BAND * self.radius_m:
            return False
        learnt = min(SPARE * self._held_m, self._most_m)
        if learnt <= self.radius_m:
            return False
        self.radius_m = learnt
        return True
