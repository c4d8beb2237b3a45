"""What every planner's pilot has: the situation, both parameter sets, lists, and what it tells."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import LegEstimate
from sar_planner.guidance.turn_radius import TurnRadius
from sar_planner.guidance.waypoint_lists import Listed, WaypointLists
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.prediction.situation import Situation
from sar_planner.strategies.active_corner import ActiveCorner, Mode


class Pilot(ABC):
    """Leads the UAV while it is engaged.

    ``active``: the corner being flown. ``problem``: why it cannot do what it should, empty when all
    is well. ``speed_mps``: the ground speed asked for, None where it is left to the autopilot.
    ``slot``: the slot track. ``corrections``: how often a path was corrected. ``kept_lag_m``: the
    lag kept on purpose. ``turns``: the radius that the UAV's paths are planned with.
    """

    def __init__(
        self, situation: Situation, corner: CornerParameters, mission: MissionParameters
    ) -> None:
        """Begin on a leg."""
        self._s = situation
        self._corner = corner
        self._mission = mission
        self.lists = WaypointLists(corner, mission)
        self.active: ActiveCorner | None = None
        self.problem = ""
        self.speed_mps: float | None = None
        self.slot: Pose | None = None
        self.corrections = 0
        self.kept_lag_m = 0.0
        self.turns = TurnRadius(corner.turn_radius_m, corner.spacing_m)

    @property
    @abstractmethod
    def mode(self) -> Mode:
        """What the UAV is being led along."""

    @property
    def made_good(self) -> float:
        """The share of its speed that the UAV is expected to make good at corners."""
        return 1.0

    @property
    def course_rad(self) -> float:
        """The course on which the UAV will be when a speed asked for now is flown."""
        return 0.0

    def _learn_radius(self, *, on_path: bool) -> bool:
        """Plan with the radius that the UAV turns with; return whether it is news.

        ``on_path``: whether a path is flown: what other circles it flies is its own choice. An
        autopilot that tells of its guidance is led so that it flies the arcs it is given.
        """
        if not on_path or self._s.uav is None or self.lists.tuning is not None:
            self.turns.forget_turn()
            return False
        learnt = self.turns.watch(self._s.uav)
        if learnt:
            self._corner = replace(self._corner, turn_radius_m=self.turns.radius_m)
        return learnt

    @abstractmethod
    def begin(self) -> None:
        """Begin to lead."""

    @abstractmethod
    def end(self) -> None:
        """Stop leading."""

    @abstractmethod
    def believes(self, leg: LegEstimate) -> bool:
        """Whether a leg is believed."""

    @abstractmethod
    def set_clock_back(self) -> None:
        """Forget what belongs to a time that has not come yet."""

    @abstractmethod
    def update(self, now_s: float) -> Listed | None:
        """Return the mode and the waypoints of a new list when one is due."""
