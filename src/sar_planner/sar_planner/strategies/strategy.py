"""What every strategy has: the situation, both parameter sets, lists, and what it tells."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import NamedTuple

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import LegEstimate
from sar_planner.guidance.turn_radius import TurnRadius, Turns
from sar_planner.guidance.waypoint_lists import Listed, WaypointLists
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import FlightPath
from sar_planner.prediction.situation import Situation
from sar_planner.strategies.active_corner import ActiveCorner, Mode


class StrategyReport(NamedTuple):
    """What a strategy tells of itself.

    ``mode``: what the UAV is being led along. ``corner``: the one being flown. ``slot``: the slot
    track. ``speed_mps``: the ground speed asked for, None where it is left to the autopilot;
    ``course_rad``: on which the UAV will be when that is flown. ``problem``: why it cannot do what
    it should, empty when all is well. ``efficiency``: the share of its speed that the UAV is
    expected to make good at corners. ``lag_setpoint_m``: the lag kept on legs on purpose.
    ``corrections``: how often a path was corrected.
    """

    mode: Mode = Mode.LEG
    corner: ActiveCorner | None = None
    slot: Pose | None = None
    speed_mps: float | None = None
    course_rad: float = 0.0
    problem: str = ""
    efficiency: float = 1.0
    lag_setpoint_m: float = 0.0
    corrections: int = 0


class Strategy(ABC):
    """Leads the UAV while it is engaged. ``lists``: makes its lists. ``turns``: its turn radius."""

    def __init__(
        self, situation: Situation, corner: CornerParameters, mission: MissionParameters
    ) -> None:
        """Begin on a leg."""
        self._s = situation
        self._corner = corner
        self._mission = mission
        self.lists = WaypointLists(corner, mission)
        self.turns = TurnRadius(corner.turn_radius_m, corner.spacing_m, corner.speed_mps)

    def set_corner(self, corner: CornerParameters) -> None:
        """Plan for a slot at the distance ``spacing_m``; the radius that was learnt stays."""
        radius_m = max(corner.turn_radius_m, self.turns.believed.radius_m)
        self._corner = replace(corner, turn_radius_m=radius_m)
        self.lists.set_corner(corner)

    def set_reaction(self, reaction_s: float) -> None:
        """Plan with another time [s] from a decision to the autopilot flying the list."""
        self._mission = replace(self._mission, reaction_s=reaction_s)

    def _learn_radius(self, path: FlightPath | None) -> bool:
        """Plan with the radius that the UAV turns with; return whether it is news.

        ``path``: that is flown, None for none: what other circles it flies is its own choice. An
        autopilot that tells of its guidance is led so that it flies the arcs it is given.
        """
        told_m = 0.0 if path is None else path.widest_m
        if told_m == 0.0 or self._s.uav is None or self.lists.tuning is not None:
            self.turns.forget_turn()
            return False
        learnt = self.turns.watch(self._s.uav, told_m)
        if learnt:
            self._corner = replace(self._corner, turn_radius_m=self.turns.believed.radius_m)
        return learnt

    @property
    def _believed_turns(self) -> Turns:
        """What is believed of how the UAV turns: all that it tells, where it tells anything."""
        found = self.turns.believed
        return found if self.lists.tuning is None else replace(found, is_sure=True)

    @property
    @abstractmethod
    def report(self) -> StrategyReport:
        """What it tells of itself."""

    @abstractmethod
    def begin(self) -> None:
        """Begin to lead."""

    def refused(self, now_s: float) -> None:  # noqa: B027 - nothing to be done by most
        """Take note that the newest list is not flown; told as long as that is so."""

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
