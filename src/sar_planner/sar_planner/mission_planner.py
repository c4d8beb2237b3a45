"""The mission: whether the UAV is led, by which rules, and the waypoint lists that come of it.

Pure: it is told what is known, and asked at any time whether there is a new waypoint list.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sar_estimator.common.checked import changed
from sar_estimator.common.reports import MonitorReport, UavStatus, WaypointList
from sar_estimator.common.states import FloatArray, LegEstimate, list_id_at
from sar_planner.engagement import ENGAGE_MODES, not_flying, obstacle
from sar_planner.find import Finding
from sar_planner.guidance.steady_wind import SteadyWind
from sar_planner.guidance.vehicle import Vehicle
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.orbit import Orbit
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.patterns.slot import Slot
from sar_planner.prediction.situation import Situation
from sar_planner.rules.rule_sets import check_planner
from sar_planner.strategies.active_corner import ActiveCorner, Mode
from sar_planner.strategies.deadbeat.strategy import DeadbeatStrategy
from sar_planner.strategies.follow import FollowStrategy
from sar_planner.strategies.paper import PaperStrategy
from sar_planner.strategies.strategy import Strategy, StrategyReport
from sar_planner.timing import Timing

MAX_WAYPOINTS = 400


@dataclass(frozen=True)
class PlannedList(WaypointList):
    """A list with its number in the flight, from 1, and what it is for."""

    number: int = 0
    mode: str = ""


class ListNumbers:
    """Numbers the lists of a flight."""

    def __init__(self) -> None:
        """None was made yet."""
        self._count = self._id = 0

    def list(
        self, time_s: float, points: FloatArray, speed_mps: float | None, mode: str
    ) -> PlannedList:
        """Return the next list; see ``PlannedList``."""
        self._count += 1
        self._id = list_id_at(time_s, self._id)
        return PlannedList(self._id, time_s, points, speed_mps, number=self._count, mode=mode)


STRATEGIES: dict[str, type[Strategy]] = {
    "deadbeat": DeadbeatStrategy,
    "paper": PaperStrategy,
    "follow": FollowStrategy,
}


class MissionPlanner:
    """Engages, disengages, and hands what is known to the chosen strategy.

    ``situation``: takes what is known of the aircraft. ``find``: what was marked, and the circle
    about it. ``timing``: how late it is. ``problem``: why the planner cannot do what it should,
    empty when all is well. ``list``: the newest waypoint list. Raises ``ParameterError`` at
    construction for parameters outside the rule set's conditions.
    """

    def __init__(self, corner: CornerParameters, mission: MissionParameters) -> None:
        """Check both parameter sets."""
        self.corner_parameters = corner
        self.parameters = mission
        own = corner.beside(mission.slot_tracks)
        check_planner(mission.rules, own)
        self.situation = Situation(corner, mission.terms, mission.slot)
        self._strategy = STRATEGIES[mission.rules](self.situation, own, mission)
        lists, turns = self._strategy.lists, self._strategy.turns
        orbit = Orbit(self.situation, corner, mission, lists, turns)
        self.find = Finding(self.situation, mission, orbit)
        self.timing = Timing(mission, (self._strategy, orbit))
        self.engaged = False
        self.problem = ""
        self.list: PlannedList | None = None
        self.status = UavStatus()
        self.monitor = MonitorReport()
        self.vehicle = Vehicle({})
        self.wind_mps = (0.0, 0.0)
        self._steady: SteadyWind | None = None
        self._in_auto = False
        self._numbers = ListNumbers()
        self._course_rad = 0.0
        self._retry_s = -math.inf
        self._new = True

    # What is known -----------------------------------------------------------------------------

    def set_status(self, status: UavStatus) -> None:
        """Take the autopilot's status; a mode that somebody else chose ends the engagement."""
        told, self.status = self.status, status
        if status.airspeed_ratio != told.airspeed_ratio:
            self._set_air()
        if not self.engaged or not status.connected:
            return
        if status.mode not in ENGAGE_MODES or (self._in_auto and status.mode != "AUTO"):
            self.disengage()
            self.problem = f"released: the UAV was taken to mode {status.mode}"
        elif status.taken:
            self.disengage()
            self.problem = f"released: {status.taken}"
        self._in_auto = status.mode == "AUTO"

    def set_monitor(self, status: MonitorReport) -> None:
        """Take what the monitor says: while it leads the UAV away, nothing is planned."""
        if self.engaged and status.escaping and not self.monitor.escaping:
            self._strategy.end()
            self.find.orbit.again()
            self.list = None
        if self.engaged and self.monitor.escaping and not status.escaping:
            self._strategy.begin()
        self.monitor = status

    def set_vehicle(self, vehicle: Vehicle) -> None:
        """Take what the autopilot says of the UAV."""
        self.vehicle = vehicle
        self._strategy.lists.tuning = vehicle.tuning(self.parameters)
        self._set_air()

    def set_wind(self, wind_mps: tuple[float, float], now_s: float) -> None:
        """Take where the wind blows to, x and y [m/s]."""
        if math.isfinite(math.hypot(*wind_mps)):
            self.wind_mps = wind_mps
            self._steady = SteadyWind.after(self._steady, wind_mps, now_s)
            self._set_air()

    def _set_air(self) -> None:
        """Work out the UAV's airspeeds and the wind from what is known of them."""
        ratio = self.status.airspeed_ratio
        self._strategy.lists.air = self.vehicle.air(self.wind_mps, ratio, self._steady)

    @property
    def air(self) -> AirEnvelope:
        """The UAV's airspeeds, and the wind."""
        return self._strategy.lists.air

    def set_leg(self, leg: LegEstimate) -> None:
        """Take the leg being flown."""
        if self._strategy.believes(leg):
            self.situation.set_leg(leg)

    # Operator ----------------------------------------------------------------------------------

    def obstacle(self, now_s: float) -> str:
        """Return why the planner cannot lead the UAV at ``now_s``, empty when it can."""
        return obstacle(self.situation, self.parameters, now_s)

    def engage(self, now_s: float) -> str:
        """Begin to lead the UAV; return why not, empty when begun."""
        unfit = self.vehicle.refusal(
            self.corner_parameters, self.parameters, self._strategy.lists.air
        )
        reason = not_flying(self.status) or self.obstacle(now_s) or unfit
        if not reason and not self.engaged:
            self.engaged = True
            self._new = False
            self._strategy.begin()
            self._in_auto = self.status.mode == "AUTO"
        return reason

    def disengage(self) -> None:
        """Stop leading the UAV."""
        self._new = False
        self._strategy.end()
        self.find.orbit.end()
        self.engaged = False
        self.list = None

    def orbit(self, now_s: float) -> str:
        """Begin to orbit the newest mark; return why not, empty when begun."""
        idle = "" if self.engaged else "not engaged: the UAV is not led"
        return self.find.order(idle or self.obstacle(now_s))

    def resume(self) -> str:
        """Go back to the formation; return why not, empty when begun."""
        reason = self.find.resume()
        if not reason:
            self._strategy.begin()
        return reason

    def change_slot(self, slot: Slot) -> str:
        """Take another place in the formation; return why not, empty when taken.

        The UAV is led there as soon as nothing else is flown.
        """
        own = self.corner_parameters.beside(slot.tracks)
        try:
            told = changed(self.parameters, slot_side=slot.side, slot_tracks=slot.tracks)
            check_planner(told.rules, own)
        except ValueError as error:
            return str(error)
        self.parameters = told
        self.situation.progress.slot = slot
        self._strategy.set_corner(own)
        return ""

    # Measured ----------------------------------------------------------------------------------

    @property
    def report(self) -> StrategyReport:
        """What the strategy tells of itself."""
        return self.find.orbit.report if self.find.orbit.flying else self._strategy.report

    @property
    def mode(self) -> Mode:
        """What the UAV is being led along."""
        return self.report.mode if self.engaged else Mode.IDLE

    @property
    def active(self) -> ActiveCorner | None:
        """The corner being flown."""
        return self.report.corner

    @property
    def rule(self) -> str:
        """The active rule's name, or the mode's."""
        if self.mode is Mode.CORNER and self.active is not None:
            return str(self.active.plan.rule)
        return str(self.mode)

    @property
    def speed_mps(self) -> float | None:
        """The ground speed asked of the UAV [m/s]; None where it is left to the autopilot."""
        return self.report.speed_mps if self.engaged else None

    @property
    def airspeed_mps(self) -> float | None:
        """The indicated airspeed, in its envelope, that this takes where the UAV will be [m/s]."""
        speed = self.speed_mps
        if speed is None:
            return None
        true_mps = self._strategy.lists.air.airspeed_mps(self._course_rad, speed)
        return self.vehicle.indicated_mps(true_mps, self.status.airspeed_ratio)

    @property
    def turn_radius_m(self) -> float:
        """The radius that paths are planned with: more than the configured one where learnt [m]."""
        return self._strategy.turns.believed.radius_m

    def lag_m(self) -> float | None:
        """Return the UAV's lag [m]: L(k) in a corner, on a leg the present along-track lag."""
        if self.active is not None:
            return self.active.plan.lag_m
        return self.situation.lag_m(self.report.slot)

    # Decisions ---------------------------------------------------------------------------------

    def update(self, now_s: float) -> PlannedList | None:
        """Return a new waypoint list when one is due."""
        self.timing.use(now_s)
        if self._new and self.status.tracking_list and self.status.mode == "AUTO":
            self.engage(now_s)  # the UAV was being led when this planner was started
        if not self.engaged:
            return None
        self.problem = self.obstacle(now_s)
        if self.monitor.escaping:
            self.problem = f"monitor: {self.monitor.reason}"
        if self.problem:
            return None
        refused = self._refused(now_s)
        self.timing.adapt(now_s)
        orbit = self.find.orbit
        listed, waits = orbit.update(now_s), ""
        if not orbit.flying:
            listed = self._strategy.update(now_s)
            waits = "" if orbit.state is None else orbit.state.problem
        report = orbit.report if orbit.flying else self._strategy.report
        air, speed = self._strategy.lists.air, report.speed_mps
        self._course_rad = report.course_rad
        slow = "" if speed is None else air.out_of_reach(self._course_rad, speed)
        notes = waits, report.problem, slow, refused, self.timing.problems(now_s)
        self.problem = "; ".join(note for note in notes if note)
        if listed is None:
            return None
        name, points = listed
        if not np.isfinite(points).all():
            self.problem = "waypoints that are no numbers: list kept back"
            return None
        planned = None if self.mode in (Mode.LEG, Mode.HOLD) else speed
        self.list = self._numbers.list(now_s, points[:MAX_WAYPOINTS], planned, name)
        self.timing.give(self.list.list_id, now_s)
        return self.list

    def _refused(self, now_s: float) -> str:
        """Return why the newest list did not pass, if it did not; a leg's is soon made again."""
        if self.list is None or self.monitor.refused_id != self.list.list_id:
            return ""
        if self.mode is not Mode.ORBIT:
            self._strategy.refused(now_s)
        if now_s > self._retry_s and self.mode in (Mode.LEG, Mode.HOLD, Mode.ORBIT):
            self._retry_s = now_s + self.parameters.retry_s
            (self.find.orbit.again if self.mode is Mode.ORBIT else self._strategy.begin)()
        return self.monitor.reason

    def set_clock_back(self) -> None:
        """Forget what belongs to a time that has not come yet: the clock was set back."""
        self._strategy.set_clock_back()
        self.timing.set_clock_back()
        self.situation.set_clock_back()
