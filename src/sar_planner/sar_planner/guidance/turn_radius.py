"""What radius the UAV really turns with, learnt from its own motion while it turns.

An autopilot whose turn rate is overestimated flies wide of every arc that it is given: the tightest
radius that it holds in a turn is then larger than the one planned with. Paths are planned with
what it holds, and something to spare, from then on. What limits an aeroplane is its bank: R goes
with V^2, and flown slower it turns tighter. One that is seen not to is not believed to any more.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, replace
from typing import NamedTuple

from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import Motion

STEP_S = 0.19
GAP_S = 2.0
HELD_RAD = math.radians(30.0)
SURE_RAD = math.radians(100.0)
FIRST_RAD = math.radians(60.0)  # of the first turn that is seen, once it tightens no more
STRAIGHT_SHARE = 0.3
DEAD_BAND = 1.08
SPARE = 1.1
STEADY, SLOWER = 0.99, 0.95
MOST_SPACINGS = 0.8


@dataclass(frozen=True, slots=True)
class Turns:
    """What is believed of how a UAV turns.

    ``radius_m``: planned with, at V. ``is_wide``: it was seen to need more than is configured.
    ``by_bank``: its bank is what limits it. ``is_sure``: it was seen in a turn, or tells of its
    guidance: before that nobody knows.
    """

    radius_m: float
    is_wide: bool = False
    by_bank: bool = True
    is_sure: bool = True

    def at_m(self, speed_share: float) -> float:
        """Return the radius [m] to plan with at a speed, over V."""
        return self.radius_m * (speed_share**2 if self.is_wide and self.by_bank else 1.0)


class _Sample(NamedTuple):
    """A time [s] in a turn: turned [rad], flown [m] and to be flown by its speed since it began."""

    time_s: float
    turned_rad: float
    flown_m: float
    by_speed_m: float

    def plus(self, part: _Sample) -> _Sample:
        """Return what it is after another part of the turn."""
        return _Sample(*(mine + one for mine, one in zip(self, part, strict=True)))


class TurnRadius:
    """The radius that paths are planned with: the configured one, or what is learnt to be needed.

    ``believed``: never less than the configured radius, nor more than 0.8 of the spacing (or the
    configured one where that is more): not far beyond, nothing is guaranteed.
    """

    def __init__(self, configured_m: float, spacing_m: float, speed_mps: float) -> None:
        """Believe what is configured, for V [m/s], until a turn is seen."""
        self.believed = Turns(configured_m, is_sure=False)
        self._most_m = max(configured_m, MOST_SPACINGS * spacing_m)
        self._speed_mps = speed_mps
        self._last: Motion | None = None
        self._side = 0.0
        self._turn: deque[_Sample] = deque()
        self._held: tuple[float, float] | None = None

    def forget_turn(self) -> None:
        """Begin a new turn: what was flown before was not asked for by a path."""
        self._last = None
        self._end_turn()

    def watch(self, motion: Motion, told_m: float) -> bool:
        """Take the UAV's newest motion; return whether a larger radius has been learnt from it.

        ``told_m``: the radius of the turns that it is told to fly.
        """
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
        slow = abs(turned) * self.believed.radius_m < STRAIGHT_SHARE * flown
        if slow or turned * self._side < 0.0:
            self._end_turn()
            return False
        self._side = turned
        by_speed_m = 0.5 * (last.speed_mps + motion.speed_mps) * since
        return self._turned(_Sample(since, abs(turned), flown, by_speed_m), told_m)

    def _end_turn(self) -> None:
        self._side, self._held = 0.0, None
        self._turn.clear()

    def _turned(self, part: _Sample, told_m: float) -> bool:
        """Take a part of a turn. Sure of what is held is one after more than a quarter circle."""
        before = self._turn[-1] if self._turn else _Sample(0.0, 0.0, 0.0, 0.0)
        now = before.plus(part)
        self._turn.append(now)
        while len(self._turn) > 1 and now.turned_rad - self._turn[1].turned_rad >= HELD_RAD:
            self._turn.popleft()
        first = self._turn[0]
        arc = now.turned_rad - first.turned_rad
        tightens = True
        if arc >= HELD_RAD:
            held_m, over_s = (now.flown_m - first.flown_m) / arc, now.time_s - first.time_s
            tightens = self._held is None or held_m < STEADY * self._held[0]
            if self._held is None or held_m < self._held[0]:
                # By its speed: one that oscillates makes good less, and banks for all of it.
                self._held = held_m, (now.by_speed_m - first.by_speed_m) / over_s / self._speed_mps
        sure_rad = SURE_RAD if self.believed.is_sure or tightens else FIRST_RAD
        if now.turned_rad < sure_rad or self._held is None:
            return False
        if not self._held_for_sure(*self._held, told_m):
            return False
        self._end_turn()
        return True

    def _held_for_sure(self, held_m: float, speed_share: float, told_m: float) -> bool:
        """Learn from the tightest part of a turn, flown at a speed over V; return whether it is."""
        was = self.believed
        self.believed = replace(was, is_sure=True)
        if held_m <= DEAD_BAND * told_m:
            return False
        if was.is_wide and was.by_bank and speed_share < SLOWER:
            if held_m <= DEAD_BAND * was.at_m(speed_share):
                return False
            # Slower, it does not turn tighter.
            learnt = max(was.radius_m, SPARE * held_m)
            self.believed = Turns(min(learnt, self._most_m), is_wide=True, by_bank=False)
            return True
        at_v_m = held_m / speed_share**2 if was.by_bank and speed_share < SLOWER else held_m
        learnt = min(SPARE * at_v_m, self._most_m)
        if learnt <= was.radius_m:
            return False
        self.believed = replace(was, radius_m=learnt, is_wide=True, is_sure=True)
        return True
