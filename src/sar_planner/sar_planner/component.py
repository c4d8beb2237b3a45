"""The planner as a component: what is known of both aircraft in; waypoint lists out."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from sar_estimator.common import topics
from sar_estimator.common.checked import changed
from sar_estimator.common.component import (
    NOTICES,
    Answer,
    Component,
    Notice,
    Outputs,
    keep,
    keep_at,
)
from sar_estimator.common.other_uavs import OtherUavs
from sar_estimator.common.reports import (
    CornerRecord,
    Health,
    HelicopterReport,
    Mark,
    Target,
    UavReport,
    UavStatus,
    WaypointList,
)
from sar_estimator.common.states import CornerEstimate, FloatArray
from sar_planner.guidance.vehicle import Vehicle
from sar_planner.mission_planner import MissionPlanner, PlannedList
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.patterns.ahead import have_moved
from sar_planner.patterns.slot import Slot
from sar_planner.strategies.active_corner import ActiveCorner, Mode

FIGURES = re.compile(r"[\d.]+")
CHANGEABLE = MissionParameters.CHANGEABLE
SPEED_STEP_MPS = 0.05
CURVE_STEP_M = 10.0
MOST_RATE_HZ = 100.0


class PlannerComponent(Component):
    """Feeds the mission planner, and tells its decisions.

    ``planner``: what is fed. ``pattern``: the corners ahead that were told last, shape (n, 2) [m].
    """

    name = "planner"
    outputs: tuple[str, ...] = (
        topics.WAYPOINTS,
        topics.SPEED,
        topics.MODE,
        topics.LAG,
        topics.CORNER_PLAN,
        topics.CORNER_PATH,
        topics.PATTERN,
        topics.MISSION,
        topics.MARKS,
        topics.DIAGNOSTICS,
    )
    urgent = frozenset({topics.PREDICTION})

    def __init__(
        self,
        corner: CornerParameters,
        mission: MissionParameters,
        *,
        rate_hz: float = 5.0,
        yields_to: Sequence[str] = (),
    ) -> None:
        """Begin idle. ``rate_hz``: of decisions. ``yields_to``: UAVs with the right of way.

        Raises ``ValueError`` for what cannot be.
        """
        super().__init__()
        if not 0.0 < rate_hz <= MOST_RATE_HZ:
            raise ValueError(f"parameter decision_rate_hz = {rate_hz}: expected 0 to 100")
        self.period_s = 1.0 / rate_hz
        self.planner = MissionPlanner(corner, mission)
        situation = self.planner.situation
        situation.progress.leg = max(0, mission.pattern_leg - 1)
        situation.others, situation.layer_m = OtherUavs(yields_to), mission.layer_separation_m
        self._asked_mps = 0.0
        self._noted = ""
        self.pattern: FloatArray = np.empty((0, 2))
        self.inputs = {
            topics.HELICOPTER_ODOMETRY: self._on_helicopter,
            topics.UAV_ODOMETRY: self._on_uav,
            topics.FIX_TIME: keep(self.planner.timing.hear_fix),
            topics.LEG: keep(self.planner.set_leg),
            topics.PREDICTION: self._on_corner,
            topics.PHASE: keep(self.planner.situation.set_phase),
            topics.UAV_STATE: self._on_status,
            topics.AUTOPILOT: self._on_autopilot,
            topics.UPLOADED: keep_at(self.planner.timing.hear_uploaded),
            topics.MONITOR: keep(self.planner.set_monitor),
            topics.WIND: keep_at(self.planner.set_wind),
            topics.TARGET: self._on_target,
            **situation.others.inputs,
        }
        self.services = {
            topics.ENGAGE: self._engage,
            topics.DISENGAGE: self._disengage,
            topics.MARK: self._mark,
            topics.ORBIT: self._orbit,
            topics.RESUME: self._resume,
        }

    # What is known -----------------------------------------------------------------------------

    def start(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Tell the parameters that it flies with."""
        planner = self.planner
        record = {
            "corner": asdict(planner.corner_parameters),
            "mission": asdict(planner.parameters),
        }
        return [(topics.MISSION, record)]

    def _on_helicopter(self, report: HelicopterReport, _now_s: float) -> Outputs:
        self.planner.situation.set_helicopter(report.motion, report.velocity_sigma_mps)
        return []

    def _on_uav(self, report: UavReport, _now_s: float) -> Outputs:
        self.planner.situation.set_uav(report.motion)
        self.planner.situation.altitude_m = report.altitude_m
        return []

    def _on_corner(self, corner: CornerEstimate, _now_s: float) -> Outputs:
        self.planner.situation.set_corner(corner)
        return []

    def _on_status(self, status: UavStatus, now_s: float) -> Outputs:
        was = self.planner.mode
        self.planner.set_status(status)
        released = was is not Mode.IDLE and self.planner.mode is Mode.IDLE
        return self._withdrawn(now_s) if released else []

    def _on_autopilot(self, values: dict[str, float], _now_s: float) -> Outputs:
        vehicle = Vehicle(values)
        self.planner.set_vehicle(vehicle)
        warning = vehicle.warning()
        return [(NOTICES, Notice("warning", warning))] if warning else []

    # Operator ----------------------------------------------------------------------------------

    def _engage(self, now_s: float) -> Answer:
        reason = self.planner.engage(now_s)
        return Answer(not reason, reason or "engaged", self.tick(now_s))

    def _disengage(self, now_s: float) -> Answer:
        self.planner.disengage()
        return Answer(success=True, message="disengaged", outputs=self._withdrawn(now_s))

    def _on_target(self, target: Target, now_s: float) -> Outputs:
        return self._marked(self.planner.find.mark(now_s, (target.x_m, target.y_m)))

    def _marked(self, mark: Mark | None) -> Outputs:
        """Tell what is marked, once something is."""
        if mark is None:
            return []
        text = f"mark {mark.number} at {mark.x_m:.0f} m east, {mark.y_m:.0f} m north of the datum"
        return [(topics.MARKS, self.planner.find.marks.all), (NOTICES, Notice("info", text))]

    def _mark(self, now_s: float) -> Answer:
        mark = self.planner.find.mark(now_s)
        if mark is None:
            return Answer(success=False, message="no position to mark", outputs=[])
        return Answer(success=True, message=f"mark {mark.number} set", outputs=self._marked(mark))

    def _orbit(self, now_s: float) -> Answer:
        reason, mark = self.planner.orbit(now_s), self.planner.find.marks.newest
        done = "" if mark is None else f"to mark {mark.number}"
        return Answer(not reason, reason or done, self.tick(now_s))

    def _resume(self, now_s: float) -> Answer:
        reason = self.planner.resume()
        return Answer(not reason, reason or "back to the formation", self.tick(now_s))

    def change_slot(self, slot: Slot) -> Answer:
        """Take another place in the formation."""
        reason = self.planner.change_slot(slot)
        if reason:
            return Answer(success=False, message=reason, outputs=[])
        told: Outputs = [(NOTICES, Notice("info", f"slot: {slot}")), *self.start(0.0)]
        return Answer(success=True, message=f"slot {slot}", outputs=told)

    def change(self, given: Mapping[str, Any]) -> Answer:
        """Take parameters that can be changed in flight: of the slot, and ``pattern_leg``.

        All of them, or none: whatever else is given changes nothing.
        """
        parameters = self.planner.parameters
        try:
            told = changed(parameters, **{k: v for k, v in given.items() if k in CHANGEABLE})
        except ValueError as error:
            return Answer(success=False, message=str(error), outputs=[])
        answer = Answer(success=True, message="", outputs=[])
        if told.slot != parameters.slot:
            answer = self.change_slot(told.slot)
        if answer.success and told.pattern_leg > 0 and "pattern_leg" in given:
            self.planner.situation.progress.leg = told.pattern_leg - 1
            text = f"leg {told.pattern_leg} of the pattern is flown"
            answer.outputs.append((NOTICES, Notice("info", text)))
        return answer

    def _withdrawn(self, now_s: float) -> Outputs:
        """Tell that there is no list any more."""
        return [(topics.WAYPOINTS, WaypointList.withdrawal(now_s)), *self._problem_outputs()]

    # Decisions ---------------------------------------------------------------------------------

    def tick(self, now_s: float) -> Outputs:
        """Decide."""
        planner = self.planner
        waypoints = planner.update(now_s)
        found: Outputs = []
        airspeed = planner.airspeed_mps
        if not planner.engaged:
            self._asked_mps = 0.0
        elif airspeed is not None and abs(airspeed - self._asked_mps) >= SPEED_STEP_MPS:
            self._asked_mps = airspeed
            found.append((topics.SPEED, airspeed))
        if waypoints is not None:
            found.append((topics.WAYPOINTS, waypoints))
            if planner.active is not None and waypoints.mode != Mode.LEG:
                found += corner_outputs(planner.active, waypoints)
            text = f"list {waypoints.number}: {waypoints.mode}, {len(waypoints.points)} waypoints"
            found.append((NOTICES, Notice("info", text)))
        return found + self._problem_outputs()

    def _problem_outputs(self) -> Outputs:
        """Return a problem that is new: said once, however its figures change."""
        problem = self.planner.problem
        plain = FIGURES.sub("", problem) if problem else ""
        if plain == self._noted:
            return []
        self._noted = plain
        return [(NOTICES, Notice("warning", problem))] if problem else []

    def report(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Tell the mode, the lag where there is one, and what is new of the pattern ahead."""
        lag, ahead = self.planner.lag_m(), self.planner.situation.pattern_ahead
        found: Outputs = [(topics.MODE, self.planner.rule)]
        if lag is not None:
            found.append((topics.LAG, lag))
        if have_moved(ahead, self.pattern):
            self.pattern = ahead
            found.append((topics.PATTERN, ahead))
        return found

    def health(self, now_s: float) -> Health:
        """Return what it does, why it does not do more, and how late it is."""
        planner = self.planner
        report = planner.report
        sure = None if report.corner is None else report.corner.sure
        if sure is not None and sure.until_s < now_s:
            sure = None
        return Health(
            self.name,
            planner.problem or planner.timing.problems(now_s),
            {
                "corner": planner.situation.corners_seen,
                "pattern_leg": planner.situation.progress.leg + 1,
                "slot": str(planner.situation.progress.slot),
                "rule": planner.rule,
                "phase": planner.situation.phase,
                "lag_m": _figure(planner.lag_m()),
                "separation_m": _figure(planner.situation.separation_m()),
                "tube_m": _figure(None if sure is None else sure.distance_m),
                "tube_s": _figure(None if sure is None else sure.until_s - now_s),
                "speed_asked_mps": _figure(planner.speed_mps),
                "airspeed_asked_mps": _figure(planner.airspeed_mps),
                "wind_mps": f"{math.hypot(*planner.wind_mps):.1f}",
                "speeds_kept_mps": _span(*planner.air.kept_mps),
                "autopilot": planner.vehicle.warning(),
                "corrections": report.corrections,
                "path_efficiency": f"{report.efficiency:.2f}",
                "turn_radius_m": f"{planner.turn_radius_m:.0f}",
                "lag_setpoint_m": f"{report.lag_setpoint_m:.0f}",
                **planner.timing.values(now_s),
                "reaction_s": f"{planner.timing.reaction_s(now_s):.1f}",
                "lists": 0 if planner.list is None else planner.list.number,
            },
        )

    def set_clock_back(self) -> None:
        """Forget what has not come yet."""
        self.planner.set_clock_back()


def _figure(value: float | None) -> str:
    return "" if value is None else f"{value:.1f}"


def _span(least: float, most: float) -> str:
    """Return a span of speeds; empty where it has no end: the airspeeds are not known."""
    if math.isinf(most):
        return ""
    return f"{least:.1f} to {most:.1f}" if least <= most else "none"


def corner_outputs(active: ActiveCorner, waypoints: PlannedList) -> Outputs:
    """Return what was decided at a corner, and the curve that it is for."""
    plan, estimate = active.plan, active.estimate
    record = CornerRecord(
        k=active.k,
        rule=str(plan.rule),
        list_id=waypoints.list_id,
        list_time_s=waypoints.time_s,
        lag_m=plan.lag_m,
        next_lag_m=plan.next_lag_m,
        length_m=plan.path.length_m,
        onset_time_s=estimate.onset_time_s,
        stop_time_s=estimate.stop_time_s,
        estimated_at_s=estimate.time_s,
        speed_mps=estimate.speed_mps,
        accel_mps2=estimate.accel_mps2,
        turn_radius_m=plan.parameters.turn_radius_m,
        stop=estimate.stop,
        first_stop=active.first_stop,
        tube_m=None if active.sure is None else active.sure.distance_m,
        tube_until_s=None if active.sure is None else active.sure.until_s,
    )
    curve = WaypointList(waypoints.list_id, waypoints.time_s, active.path.sample(CURVE_STEP_M))
    return [(topics.CORNER_PLAN, record), (topics.CORNER_PATH, curve)]
