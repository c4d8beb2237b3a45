"""The planner that users would otherwise pick: the UAV chases the point that is its slot.

As ArduPlane's follow script does (AP_Scripting, plane_follow.lua): every second towards where the
offset point will be a little later, at the leader's speed and so much more as it is behind. It
knows nothing of corners, and keeps no separation: it is here to be compared with.
"""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import LegEstimate
from sar_planner.guidance.speed_control import trimmed_mps
from sar_planner.guidance.waypoint_lists import LOITER_AHEAD_M, Listed
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.prediction.situation import Situation
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.strategy import Strategy, StrategyReport

PERIOD_S = 1.0
AHEAD_S = 10.0
STANDING_MPS = 3.0


class FollowStrategy(Strategy):
    """A new list of two waypoints every second: ahead of the slot point, and farther that way."""

    def __init__(
        self, situation: Situation, corner: CornerParameters, mission: MissionParameters
    ) -> None:
        """Begin without a course: a helicopter that stands has none."""
        super().__init__(situation, corner, mission)
        self._due_s = -math.inf
        self._course_rad: float | None = None
        self._slot: Pose | None = None
        self._speed_mps: float | None = None
        self._problem = ""

    @property
    def report(self) -> StrategyReport:
        """What it tells of itself: to it all is one leg, flown on the UAV's course."""
        return StrategyReport(
            slot=self._slot,
            speed_mps=self._speed_mps,
            course_rad=0.0 if self._s.uav is None else self._s.uav.course_rad,
            problem=self._problem,
        )

    def begin(self) -> None:
        """Begin to lead, at once."""
        self._due_s = -math.inf

    def end(self) -> None:
        """Stop leading."""
        self._speed_mps = None

    def believes(self, leg: LegEstimate) -> bool:  # noqa: ARG002
        """Whether a leg is believed: all are, for none is used."""
        return True

    def set_clock_back(self) -> None:
        """Forget when the next list is due."""
        self._due_s = -math.inf

    def update(self, now_s: float) -> Listed | None:
        """Return the waypoints of a new list when one is due."""
        helicopter, uav = self._s.helicopter, self._s.uav
        if helicopter is None or uav is None or now_s < self._due_s:
            return None
        if helicopter.speed_mps > STANDING_MPS:
            self._course_rad = helicopter.course_rad
        if self._course_rad is None:
            self._problem = "helicopter's course not known: it stands"
            return None
        self._problem = ""
        self._due_s = now_s + PERIOD_S
        since = now_s - helicopter.time_s
        x = helicopter.x_m + since * helicopter.vx_mps
        y = helicopter.y_m + since * helicopter.vy_mps
        self._slot = self._s.slot_of(Pose(x, y, self._course_rad))
        behind = -self._slot.along(uav.x_m, uav.y_m) - uav.speed_mps * (now_s - uav.time_s)
        self._speed_mps = trimmed_mps(
            behind,
            self._corner.speed_mps,
            gain=self._mission.trim_gain,
            trim=self._mission.speed_trim,
        )
        ahead_m = self._corner.speed_mps * AHEAD_S
        points = [self._slot.offset(ahead_m + further) for further in (0.0, LOITER_AHEAD_M)]
        return str(Mode.LEG), np.array([(pose.x_m, pose.y_m) for pose in points])
