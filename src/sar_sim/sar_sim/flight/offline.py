"""A mission flown offline: the modules that fly, in lockstep, without DDS and without sockets."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any, Generic, TypeVar

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.mission.mission_slots import MissionBanks
from sar_bridge.monitor.separation_monitor import (
    MonitorNews,
    SeparationMonitor,
)
from sar_estimator.common import topics
from sar_estimator.common.conversions import (
    corner_to_path,
    datum_message,
    fix_outputs,
    fix_to_message,
    leg_as_told,
    motion_as_told,
    path_to_corner,
    points_to_path,
    prediction_outputs,
    stamped_s,
    text_message,
    vector_message,
    velocity_message,
)
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.states import FloatArray, list_id_at
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS, EstimatorParameters
from sar_planner.conversions import (
    decision_outputs,
    mission_message,
    monitor_from_text,
    planner_diagnostics,
    status_outputs,
)
from sar_planner.guidance.vehicle import Vehicle
from sar_planner.mission_planner import (
    MissionParameters,
    MissionPlanner,
    Mode,
    UavStatus,
    WaypointList,
)
from sar_sim.autopilot.presets import parameter_values
from sar_sim.bags.bag import BagWriter, serialised
from sar_sim.bags.codecs import corner_truth_text, scenario_text
from sar_sim.flight.upload import load_list, monitor_for, tell_monitor
from sar_sim.scenario.scenario import Scenario
from sar_sim.world.gps import Reception
from sar_sim.world.truth import TrueEstimates
from sar_sim.world.world import World

STEPS_PER_TICK = 2
STEPS_PER_GUARD = 5
STEPS_PER_STATUS = 10
JOINING_ITEMS = 4
LATCHED = {
    topics.DATUM,
    topics.UAV_STATE,
    topics.AUTOPILOT,
    topics.WAYPOINTS,
    topics.CLEARED,
    topics.MONITOR,
    topics.SPEED,
    topics.PHASE,
    topics.MODE,
    topics.MISSION,
    topics.SCENARIO,
}


def message_kind(message: Any) -> str:
    """Return a message's type as ``pkg/msg/Name``."""
    package = type(message).__module__.split(".")[0]
    return f"{package}/msg/{type(message).__name__}"


def mission_parameters(scenario: Scenario, *, rules: str) -> MissionParameters:
    """Return the planner's parameters that a scenario prescribes."""
    return MissionParameters(
        turn_side=scenario.pattern.turn_side, rules=rules, arc_spacing_m=scenario.arc_spacing_m
    )


def make_monitor(scenario: Scenario, *, watch_only: bool = False) -> SeparationMonitor:
    """Return the monitor that a scenario is flown with."""
    turn_side = scenario.pattern.turn_side
    monitor = monitor_for(scenario.corner, turn_side, watch_only=watch_only)
    monitor.tuning = FollowerTuning.read(parameter_values(scenario.uav))
    return monitor


@dataclass(frozen=True, slots=True)
class Cleared:
    """A list on its way to the autopilot: ``points``, shape (n, 2) [m]."""

    points: FloatArray
    list_id: int
    stamp_s: float
    climb_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Progress:
    """What is told while flying."""

    time_s: float
    end_s: float
    corner: int
    rule: str
    lag_m: float | None
    separation_m: float | None


Told = TypeVar("Told")


class _Carried(Generic[Told]):
    """What a message carries of a value, worked out once for each value, not at every telling."""

    def __init__(self, carry: Callable[[Told], Told]) -> None:
        self._carry = carry
        self._last: tuple[Told, Told] | None = None

    def __call__(self, value: Told) -> Told:
        if self._last is None or self._last[0] is not value:
            self._last = value, self._carry(value)
        return self._last[1]


class OfflineFlight:
    """One mission.

    ``truth`` replaces the estimator by the helicopter's true state. ``watch_only``: the monitor
    says what it sees and does nothing.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        rules: str = "deadbeat",
        truth: bool = False,
        watch_only: bool = False,
        track: list[Fix] | None = None,
        estimator_parameters: EstimatorParameters | None = None,
        bag: BagWriter | None = None,
    ) -> None:
        """Set everything up. Raises ``ValueError`` for a mission that cannot be flown."""
        self.world = World(scenario, track)
        self._bag = bag
        self._truth: TrueEstimates | None = None
        self.estimator = HelicopterEstimator(
            estimator_parameters or EstimatorParameters(), self.world.datum
        )
        mission = mission_parameters(scenario, rules=rules)
        if truth:
            if self.world.helicopter is None:
                raise ValueError("truth: expected a simulated helicopter, not a recorded track")
            self._truth = TrueEstimates(self.world.helicopter, self.world.datum)
            mission = replace(mission, reaction_s=0.0)
        self.planner = MissionPlanner(scenario.corner, mission)
        self.monitor = make_monitor(scenario, watch_only=watch_only)
        self._news = MonitorNews()
        self._leg_as_told = _Carried(leg_as_told)
        self._corner_as_told = _Carried(lambda corner: path_to_corner(corner_to_path(corner)))
        self._status = UavStatus()
        self._banks = MissionBanks(altitude_m=scenario.sensor.altitude_m)
        self.planner.set_vehicle(Vehicle(parameter_values(scenario.uav)))
        self._newest: Cleared | None = None
        self._under_way: Cleared | None = None
        self._arrives_s = 0.0
        self._corners = list(self.world.corners)
        self._steps = 0
        self._phase = ""
        self.now_s = self._clock_s()

    def _clock_s(self) -> float:
        """Return the mission's clock [s], as stamps carry it."""
        return stamped_s(self.world.epoch_s + self.world.time_s)

    def run(
        self,
        progress: Callable[[Progress], None] | None = None,
        *,
        observe: Callable[[World], None] | None = None,
    ) -> None:
        """Fly to the end; ``progress`` is told once a simulated second, ``observe`` every tick."""
        self._write(topics.DATUM, datum_message(self.world.datum, self.now_s))
        self._write(topics.MISSION, mission_message(self.planner))
        self._write(topics.SCENARIO, text_message(scenario_text(self.world.scenario)))
        told = parameter_values(self.world.scenario.uav)
        if told:
            self._write(topics.AUTOPILOT, text_message(json.dumps(told)))
        while not self.world.finished:
            self._step()
            if observe is not None and self._steps % STEPS_PER_TICK == 0:
                observe(self.world)
            if progress is not None and self._steps % STEPS_PER_STATUS == 0:
                progress(self.progress())

    def progress(self) -> Progress:
        """Return how far the mission is."""
        return Progress(
            self.world.time_s,
            self.world.end_s,
            self.planner.corners_seen,
            self.planner.rule,
            self.planner.lag_m(),
            self.planner.separation_m(),
        )

    def _write(self, topic: str, message: Any) -> None:
        if self._bag is not None:
            kind = message_kind(message)
            data = serialised(kind, message)
            self._bag.write(topic, kind, data, self.now_s, latched=topic in LATCHED)

    def _step(self) -> None:
        receptions = self.world.step()
        self.now_s = self._clock_s()
        self._steps += 1
        self._transfer()
        while self._corners and self._corners[0].onset_time_s <= self.world.time_s:
            truth = text_message(corner_truth_text(self._corners.pop(0)))
            self._write(topics.TRUE_CORNER, truth)
        for reception in receptions:
            self._receive(reception)
        if self._truth is not None:
            self._truth.time_s = self.world.time_s
        if self._truth is not None or receptions or self._steps % STEPS_PER_TICK == 0:
            self._know(self._truth or self.estimator)
            self._plan()
        if self._bag is not None and self._steps % STEPS_PER_STATUS == 0:
            self._write_status()
        if self._steps % STEPS_PER_GUARD == 0:
            self._guard()

    def _receive(self, reception: Reception) -> None:
        fix, velocity = reception.fix, reception.velocity
        if velocity is not None:
            if self._bag is not None:
                message = velocity_message(fix.time_s, velocity.vx_mps, velocity.vy_mps)
                self._write(topics.VELOCITY, message)
            self.estimator.add_velocity(
                fix.time_s, velocity.vx_mps, velocity.vy_mps, VELOCITY_SIGMA_MPS
            )
        if self._bag is not None:
            self._write(topics.FIX, fix_to_message(fix))
        self.estimator.add_fix(fix)
        if self._truth is None and self._bag is not None:
            for topic, output in fix_outputs(self.estimator, self.now_s):
                self._write(topic, output)

    def _know(self, source: HelicopterEstimator | TrueEstimates) -> None:
        """Tell the planner what is known of leg, corner, phase and positions, as messages do."""
        estimate = source.predict(self.now_s)
        if estimate is not None:
            self.planner.set_helicopter(motion_as_told(estimate.motion))
        autopilot = self.world.autopilot
        uav = motion_as_told(autopilot.motion.stamped(self.now_s), autopilot.state.heading_rad)
        self.planner.set_uav(uav)
        self.monitor.set_uav(uav)
        self.planner.set_wind(autopilot.wind_estimate_mps)
        self.monitor.set_wind(autopilot.wind_estimate_mps)
        phase = source.phase(self.now_s)
        if phase != self._phase:
            self._phase = phase
            self._write(topics.PHASE, text_message(phase))
        if self._bag is not None:
            self._write_motions(source)
        self.planner.set_phase(phase)
        tell_monitor(self.monitor, estimate, phase, source.corner, source.leg)
        if source.leg is not None:
            self.planner.set_leg(self._leg_as_told(source.leg))
        if source.corner is not None:
            self.planner.set_corner(self._corner_as_told(source.corner))

    def _write_status(self) -> None:
        for topic, status in status_outputs(self.planner):
            self._write(topic, status)
        self._write(topics.DIAGNOSTICS, planner_diagnostics(self.planner, self.now_s))

    def _write_motions(self, source: HelicopterEstimator | TrueEstimates) -> None:
        """Write what planner and monitor know; the helicopter, for which they wait, last."""
        wind = vector_message(self.now_s, *self.world.autopilot.wind_estimate_mps)
        self._write(topics.WIND, wind)
        for topic, odometry in self.world.truth(self.now_s):
            self._write(topic, odometry)
            if topic == topics.TRUE_UAV:
                self._write(topics.UAV_ODOMETRY, odometry)
        for topic, output in prediction_outputs(source, self.now_s):
            self._write(topic, output)

    def _set_status(self) -> None:
        """Tell the planner in which mode the autopilot is."""
        mode = self.world.autopilot.mode
        if mode.name != self._status.mode:
            ratio = self.world.autopilot.uav.airspeed_ratio
            self._status = UavStatus(mode.name, armed=True, connected=True, airspeed_ratio=ratio)
            self._write(topics.UAV_STATE, text_message(json.dumps(asdict(self._status))))
        self.planner.set_status(self._status)

    def _plan(self) -> None:
        autopilot = self.world.autopilot
        self._set_status()
        if self.planner.mode is Mode.IDLE:
            self.planner.engage(self.now_s)
        waypoints = self.planner.update(self.now_s)
        if self._bag is not None:
            for topic, decision in decision_outputs(self.planner, waypoints):
                self._write(topic, decision)
        if waypoints is not None:
            self._offer(waypoints)
        airspeed = self.planner.airspeed_mps
        if airspeed is not None:
            autopilot.airspeed_mps = airspeed

    def _offer(self, waypoints: WaypointList) -> None:
        """Hand a list on when the monitor lets it pass."""
        points, list_id, speed = waypoints.points, waypoints.list_id, waypoints.speed_mps
        if self.monitor.passes(points, list_id, self.now_s, speed_mps=speed):
            self._clear(Cleared(points, list_id, waypoints.time_s))
        self._tell_monitor()

    def _clear(self, cleared: Cleared) -> None:
        self._newest = cleared
        if self._bag is not None:
            path = points_to_path(
                cleared.points, cleared.stamp_s, climb_m=cleared.climb_m, list_id=cleared.list_id
            )
            self._write(topics.CLEARED, path)

    def _guard(self) -> None:
        escape = self.monitor.update(self.now_s)
        if escape is not None:
            list_id = list_id_at(escape.time_s)
            self._clear(Cleared(escape.points, list_id, escape.time_s, escape.climb_m))
        self._tell_monitor()

    def _tell_monitor(self) -> None:
        """Tell the planner what the monitor says, when that has changed."""
        text = self._news.of(self.monitor)
        if text is not None:
            self.planner.set_monitor(monitor_from_text(text))
            self._write(topics.MONITOR, text_message(text))

    def _transfer(self) -> None:
        """Hand lists to the autopilot as the bridge does: one after the other, the newest next."""
        if self._under_way is not None and self.world.time_s >= self._arrives_s:
            waypoints, self._under_way = self._under_way, None
            self._load(waypoints)
        if self._under_way is None and self._newest is not None:
            self._under_way, self._newest = self._newest, None
            items = len(self._under_way.points) + JOINING_ITEMS
            self._arrives_s = self.world.time_s + items * self.world.scenario.uav.item_s

    def _load(self, waypoints: Cleared) -> None:
        """Hand a list to the autopilot."""
        self.monitor.set_uploaded(waypoints.list_id)
        self._write(topics.UPLOADED, text_message(json.dumps({"list_id": waypoints.list_id})))
        load_list(
            self.world.autopilot,
            self._banks,
            waypoints.points,
            self.world.datum,
            climb_m=waypoints.climb_m,
        )
