"""What was found: marks, and who is led about them. Pure."""

from __future__ import annotations

import math

from sar_estimator.common.reports import Mark
from sar_planner.orbit import Orbit
from sar_planner.parameters.mission import MissionParameters
from sar_planner.prediction.situation import Situation

MOST_MARKS = 50


class Marks:
    """What was marked, in the order of its numbers."""

    def __init__(self, same_m: float) -> None:
        """Know none; one within ``same_m`` [m] of another is that one, moved."""
        self._same_m = same_m
        self.all: tuple[Mark, ...] = ()

    @property
    def newest(self) -> Mark | None:
        """The mark that was set or moved last: that one is orbited."""
        return max(self.all, key=lambda one: (one.time_s, one.number), default=None)

    def add(self, time_s: float, x_m: float, y_m: float) -> Mark:
        """Set a mark, or move one that is there already."""
        off = [math.hypot(one.x_m - x_m, one.y_m - y_m) for one in self.all]
        number = len(self.all) + 1
        if off and (min(off) <= self._same_m or len(off) >= MOST_MARKS):
            number = 1 + off.index(min(off))
        mark = Mark(number, time_s, x_m, y_m)
        self.all = (*self.all[: number - 1], mark, *self.all[number:])
        return mark


class Finding:
    """Marks, and who is led about them: ``marks``, ``orbit``."""

    def __init__(self, situation: Situation, mission: MissionParameters, orbit: Orbit) -> None:
        """Know nothing."""
        self._s, self._stale_s = situation, mission.stale_s
        self.marks = Marks(mission.same_mark_m)
        self.orbit = orbit

    def mark(self, now_s: float, place: tuple[float, float] | None = None) -> Mark | None:
        """Mark a place [m]; without one, where the helicopter is, else the UAV; None for nowhere.

        A mark that is being orbited and is moved is followed.
        """
        for motion in (self._s.helicopter, self._s.uav):
            fresh = motion is not None and now_s - motion.time_s <= self._stale_s
            if place is None and motion is not None and fresh:
                place = motion.x_m, motion.y_m
        if place is None:
            return None
        mark = self.marks.add(now_s, *place)
        orbited = self.orbit.state
        if orbited is not None and orbited.mark.number == mark.number:
            self.orbit.move(mark)
        return mark

    def order(self, obstacle: str) -> str:
        """Begin to orbit the newest mark, unless there is an obstacle; return why not."""
        mark = self.marks.newest
        if obstacle or mark is None:
            return obstacle or "nothing is marked"
        self.orbit.begin(mark)
        return ""

    def resume(self) -> str:
        """End the orbit; return why not, empty when ended."""
        if self.orbit.state is None:
            return "no mark is orbited"
        reason = self.orbit.stays_for
        if reason:
            return reason
        self.orbit.end()
        return ""
