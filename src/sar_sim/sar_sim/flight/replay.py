"""A recorded flight once more through the modules that flew it, and what they do otherwise.

Estimator, planner and monitor are each fed with what was recorded of their *inputs*, in the order
of the bag; their outputs are compared with what was recorded of those. Each so stands for itself:
a planner is not led astray by an estimator that has changed.

The estimator publishes a prediction, the planner decides, and twice a second the monitor looks,
whenever the bag has a prediction of the helicopter. An offline flight does exactly that. In the
graph every node has a timer of its own, up to a period apart from it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.monitor.separation_monitor import MonitorNews
from sar_estimator.common import topics
from sar_estimator.common.conversions import (
    fix_outputs,
    from_stamp,
    list_id_of,
    message_to_fix,
    odometry_sigmas,
    odometry_to_leg,
    odometry_to_motion,
    path_speed_mps,
    path_to_corner,
    path_to_points,
    points_to_path,
    prediction_outputs,
    text_message,
)
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.states import FloatArray, Phase
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_planner.conversions import (
    decision_outputs,
    monitor_from_text,
    status_from_text,
    vehicle_from_text,
)
from sar_planner.mission_planner import MissionParameters, MissionPlanner
from sar_planner.parameters.corner import CornerParameters
from sar_sim.flight.upload import monitor_for

GUARD_PERIOD_S = 0.5
Event = tuple[str, float, Any]


@dataclass(frozen=True)
class FlownWith:
    """What a flight was flown with: as its bag says, but for the estimator's parameters.

    ``engaged_s``: the times [s] at which the planner was engaged.
    """

    corner: CornerParameters
    mission: MissionParameters
    estimator: EstimatorParameters
    velocity_sigma_mps: float
    datum: Datum | None
    engaged_s: tuple[float, ...]
    watch_only: bool


def flown_with(
    events: Iterable[Event], estimator: EstimatorParameters, velocity_sigma_mps: float
) -> FlownWith:
    """Return what a flight was flown with. Raises ``ValueError`` where the bag does not say it."""
    mission, datum, watch_only, led = None, None, False, False
    engaged: list[float] = []
    for topic, _, message in events:
        if topic == topics.MISSION:
            mission = message.data
        elif topic == topics.DATUM and datum is None:
            datum = Datum(message.latitude, message.longitude, message.altitude)
        elif topic == topics.MONITOR:
            watch_only = bool(json.loads(message.data).get("watch_only"))
        elif topic == topics.WAYPOINTS:
            if message.poses and not led:
                engaged.append(from_stamp(message.header.stamp))
            led = bool(message.poses)
    if mission is None:
        raise ValueError(f"no {topics.MISSION}: expected the planner's parameters")
    try:
        values = json.loads(mission)
        corner = CornerParameters(**values["corner"])
        settings: dict[str, Any] = {
            key: tuple(value) if isinstance(value, list) else value
            for key, value in values["mission"].items()
        }
        return FlownWith(
            corner,
            MissionParameters(**settings),
            estimator,
            velocity_sigma_mps,
            datum,
            tuple(engaged),
            watch_only,
        )
    except (AttributeError, KeyError, TypeError) as error:
        raise ValueError(
            f"{topics.MISSION}: {error}: expected this version's parameters"
        ) from error


class _Module:
    """One of the modules; ``outputs``: what it would have published."""

    def __init__(self) -> None:
        """Nothing is published yet."""
        self.outputs: list[Event] = []
        self._handlers: dict[str, Callable[[float, Any], None]] = {}

    def feed(self, topic: str, time_s: float, message: Any) -> None:
        """Take a recorded message; those that are none of its inputs do nothing."""
        handler = self._handlers.get(topic)
        if handler is not None:
            handler(time_s, message)

    def _publish(self, time_s: float, found: Iterable[tuple[str, Any]]) -> None:
        self.outputs += [(topic, time_s, message) for topic, message in found]


class EstimatorReplay(_Module):
    """Fixes and velocities in; leg, corner, phase and predictions out."""

    def __init__(self, flown: FlownWith) -> None:
        """Begin with nothing known but what the flight was flown with."""
        super().__init__()
        self._estimator = HelicopterEstimator(flown.estimator, flown.datum)
        self._velocity_sigma_mps = flown.velocity_sigma_mps
        self._phase: Phase | None = None
        self._handlers = {
            topics.FIX: self._on_fix,
            topics.VELOCITY: self._on_velocity,
            topics.HELICOPTER_ODOMETRY: self._on_tick,
            # Lost it is by the clock alone: the record says when that was looked at.
            topics.PHASE: lambda time_s, _: self._tell_phase(time_s, time_s),
        }

    def _on_velocity(self, time_s: float, message: Any) -> None:
        velocity, stamp = message.twist.linear, from_stamp(message.header.stamp)
        before = self._estimator.corner
        self._estimator.add_velocity(stamp, velocity.x, velocity.y, self._velocity_sigma_mps)
        if self._estimator.corner is not before:
            self._publish(time_s, fix_outputs(self._estimator, stamp))
            self._tell_phase(time_s, stamp)

    def _on_fix(self, time_s: float, message: Any) -> None:
        if self._estimator.add_fix(message_to_fix(message)).moved:
            stamp = from_stamp(message.header.stamp)
            self._publish(time_s, fix_outputs(self._estimator, stamp))
            self._tell_phase(time_s, stamp)

    def _on_tick(self, time_s: float, message: Any) -> None:
        stamp = from_stamp(message.header.stamp)
        self._tell_phase(time_s, stamp)
        for topic, output in prediction_outputs(self._estimator, stamp):
            if topic == topics.HELICOPTER_ODOMETRY:
                self._publish(time_s, [(topic, output)])

    def _tell_phase(self, time_s: float, stamp_s: float) -> None:
        phase = self._estimator.phase(stamp_s)
        if phase is not self._phase:
            self._phase = phase
            self._publish(time_s, [(topics.PHASE, text_message(phase))])


class PlannerReplay(_Module):
    """What is known of both aircraft in; waypoint lists, corners and speeds out."""

    def __init__(self, flown: FlownWith) -> None:
        """Begin with nothing known but what the flight was flown with."""
        super().__init__()
        self._planner = MissionPlanner(flown.corner, flown.mission)
        self._to_engage = list(flown.engaged_s)
        planner = self._planner
        self._handlers = {
            topics.HELICOPTER_ODOMETRY: self._on_tick,
            topics.UAV_ODOMETRY: lambda _, m: planner.set_uav(odometry_to_motion(m)),
            topics.LEG: lambda _, m: planner.set_leg(odometry_to_leg(m)),
            topics.PREDICTION: lambda _, m: planner.set_corner(path_to_corner(m)),
            topics.PHASE: lambda _, m: planner.set_phase(Phase(m.data)),
            topics.UAV_STATE: lambda _, m: planner.set_status(status_from_text(m.data)),
            topics.AUTOPILOT: lambda _, m: planner.set_vehicle(vehicle_from_text(m.data)),
            topics.MONITOR: lambda _, m: planner.set_monitor(monitor_from_text(m.data)),
            topics.WIND: lambda _, m: planner.set_wind((m.vector.x, m.vector.y)),
            topics.WAYPOINTS: self._on_list,
        }

    def _on_list(self, time_s: float, message: Any) -> None:
        if not message.poses and self._planner.engaged:
            self._planner.disengage()
            withdrawn = points_to_path(np.empty((0, 2)), from_stamp(message.header.stamp))
            self._publish(time_s, [(topics.WAYPOINTS, withdrawn)])

    def _on_tick(self, time_s: float, message: Any) -> None:
        planner = self._planner
        planner.set_helicopter(odometry_to_motion(message))
        now_s = from_stamp(message.header.stamp)
        if self._to_engage and now_s >= self._to_engage[0] - 1e-6:
            planner.engage(now_s)
            self._to_engage.pop(0)
        waypoints = planner.update(now_s)
        self._publish(time_s, decision_outputs(planner, waypoints))


class MonitorReplay(_Module):
    """Lists and what is known of both aircraft in; the lists that pass, and its state, out."""

    def __init__(self, flown: FlownWith) -> None:
        """Begin with nothing known but what the flight was flown with."""
        super().__init__()
        self._monitor = monitor_for(
            flown.corner, flown.mission.turn_side, watch_only=flown.watch_only
        )
        self._covariance: FloatArray = np.zeros((2, 2))
        self._news = MonitorNews()
        self._led = False
        self._looked = -1
        watched = self._monitor.helicopter
        self._handlers = {
            topics.HELICOPTER_ODOMETRY: self._on_tick,
            topics.UAV_ODOMETRY: lambda _, m: self._monitor.set_uav(odometry_to_motion(m)),
            topics.WIND: lambda _, m: self._monitor.set_wind((m.vector.x, m.vector.y)),
            topics.LEG: lambda _, m: watched.set_leg(odometry_to_leg(m)),
            topics.CORNER: self._on_corner,
            topics.PREDICTION: self._on_prediction,
            topics.PHASE: self._on_phase,
            topics.UAV_STATE: self._on_state,
            topics.UPLOADED: self._on_uploaded,
            topics.AUTOPILOT: self._on_autopilot,
            topics.WAYPOINTS: self._on_list,
            topics.MONITOR: self._on_told,
        }

    def _on_told(self, time_s: float, _message: Any) -> None:
        """Tell what it was before anything was known, when the record does."""
        if not self._news.told:
            self._tell(time_s)

    def _on_corner(self, _time_s: float, message: Any) -> None:
        full = np.asarray(message.pose.covariance).reshape(6, 6)
        self._covariance = full[:2, :2].copy()

    def _on_prediction(self, _time_s: float, message: Any) -> None:
        self._monitor.helicopter.corner = path_to_corner(message, self._covariance)

    def _on_phase(self, _time_s: float, message: Any) -> None:
        self._monitor.helicopter.phase = Phase(message.data)

    def _on_state(self, _time_s: float, message: Any) -> None:
        self._led = status_from_text(message.data).mode in ("AUTO", "GUIDED")

    def _on_uploaded(self, _time_s: float, message: Any) -> None:
        self._monitor.set_uploaded(int(json.loads(message.data)["list_id"]))

    def _on_autopilot(self, _time_s: float, message: Any) -> None:
        self._monitor.tuning = FollowerTuning.read(json.loads(message.data))

    def _on_list(self, time_s: float, message: Any) -> None:
        if not message.poses:
            self._monitor.withdraw()
            self._publish(time_s, [(topics.CLEARED, message)])
        else:
            speed, list_id = path_speed_mps(message), list_id_of(message)
            if self._monitor.passes(path_to_points(message), list_id, time_s, speed_mps=speed):
                self._publish(time_s, [(topics.CLEARED, message)])
        self._tell(time_s)

    def _on_tick(self, time_s: float, message: Any) -> None:
        motion = odometry_to_motion(message)
        self._monitor.helicopter.set_motion(motion, *odometry_sigmas(message))
        look = math.floor((motion.time_s + 1e-3) / GUARD_PERIOD_S)
        if look == self._looked or not self._led:
            return
        self._looked = look
        escape = self._monitor.update(motion.time_s)
        if escape is not None:
            path = points_to_path(escape.points, escape.time_s, climb_m=escape.climb_m)
            self._publish(time_s, [(topics.CLEARED, path)])
        self._tell(time_s)

    def _tell(self, time_s: float) -> None:
        text = self._news.of(self._monitor)
        if text is not None:
            self._publish(time_s, [(topics.MONITOR, text_message(text))])


def replay(events: Iterable[Event], flown: FlownWith) -> list[Event]:
    """Return what the modules would have published, fed with a flight's events in their order."""
    modules = (EstimatorReplay(flown), PlannerReplay(flown), MonitorReplay(flown))
    for topic, time_s, message in events:
        for module in modules:
            module.feed(topic, time_s, message)
    return [event for module in modules for event in module.outputs]


# Comparison ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Tolerance:
    """How far apart figures [their unit] and times [s] may be."""

    figures: float = 1e-3
    time_s: float = 0.01


@dataclass(frozen=True, order=True)
class Difference:
    """Where a recorded and a replayed flight differ, and in what."""

    time_s: float
    topic: str
    what: str


@dataclass
class Comparison:
    """How many messages of each topic are the same, and all differences in order of time."""

    same: dict[str, int] = field(default_factory=dict)
    differences: list[Difference] = field(default_factory=list)


def compare(recorded: Iterable[Event], replayed: Iterable[Event], limits: Tolerance) -> Comparison:
    """Compare message by message, paired by their times, the topics that were recorded at all."""
    recorded, replayed = list(recorded), list(replayed)
    found = Comparison()
    for topic in FIGURES:
        ours = [_figured(event) for event in replayed if event[0] == topic]
        theirs = [_figured(event) for event in recorded if event[0] == topic]
        if theirs:
            _compare_topic(topic, theirs, ours, limits, found)
    found.differences.sort()
    return found


def _compare_topic(
    topic: str,
    recorded: list[tuple[float, dict[str, Any]]],
    replayed: list[tuple[float, dict[str, Any]]],
    limits: Tolerance,
    found: Comparison,
) -> None:
    i = j = found.same.setdefault(topic, 0)
    while i < len(recorded) or j < len(replayed):
        at = recorded[i][0] if i < len(recorded) else math.inf
        then = replayed[j][0] if j < len(replayed) else math.inf
        if at < then - limits.time_s:
            found.differences.append(Difference(at, topic, "recorded, not replayed"))
            i += 1
        elif then < at - limits.time_s:
            found.differences.append(Difference(then, topic, "replayed, not recorded"))
            j += 1
        else:
            what = _different(recorded[i][1], replayed[j][1], limits.figures)
            if what:
                found.differences.append(Difference(at, topic, what))
            else:
                found.same[topic] += 1
            i, j = i + 1, j + 1


def _different(recorded: dict[str, Any], replayed: dict[str, Any], tolerance: float) -> str:
    """Return the first figure in which two messages differ, empty for none."""
    for name, was in recorded.items():
        now = replayed.get(name)
        if isinstance(was, float) and isinstance(now, float):
            both_unknown = math.isnan(was) and math.isnan(now)
            if not (abs(was - now) <= tolerance or both_unknown):
                return f"{name}: recorded {was:.6g}, replayed {now:.6g}"
        elif was != now:
            return f"{name}: recorded {was!r}, replayed {now!r}"
    more = replayed.keys() - recorded.keys()
    return f"{min(more)}: not recorded" if more else ""


def _figured(event: Event) -> tuple[float, dict[str, Any]]:
    """Return a message's own time, else the bag's, and its figures by name."""
    topic, time_s, message = event
    if hasattr(message, "header"):
        time_s = from_stamp(message.header.stamp)
    return time_s, FIGURES[topic](message)


def _motion(message: Any) -> dict[str, Any]:
    motion = odometry_to_motion(message)
    return {"x": motion.x_m, "y": motion.y_m, "vx": motion.vx_mps, "vy": motion.vy_mps}


def _leg(message: Any) -> dict[str, Any]:
    leg = odometry_to_leg(message)
    foot = leg.foot
    return {"x": foot.x_m, "y": foot.y_m, "heading": foot.heading_rad, "speed": leg.speed_mps}


def _corner(message: Any) -> dict[str, Any]:
    position = message.pose.pose.position
    return {"x": position.x, "y": position.y, "variance": float(message.pose.covariance[0])}


def _prediction(message: Any) -> dict[str, Any]:
    corner = path_to_corner(message)
    return {"stop time": corner.stop_time_s, "a": corner.accel_mps2, "V": corner.speed_mps}


def _points(message: Any) -> dict[str, Any]:
    points = path_to_points(message).tolist()
    figures: dict[str, Any] = {"waypoints": len(points)}
    for n, (x, y) in enumerate(points):
        figures |= {f"x of waypoint {n}": x, f"y of waypoint {n}": y}
    return figures


def _corner_plan(message: Any) -> dict[str, Any]:
    values = json.loads(message.data)
    return {name: values[name] for name in ("k", "rule", "lag_m", "next_lag_m", "length_m")}


def _alert(message: Any) -> dict[str, Any]:
    values = json.loads(message.data)
    return {"alert": values["alert"], **values["counts"]}


def _plain(message: Any) -> dict[str, Any]:
    return {"value": message.data}


FIGURES: dict[str, Callable[[Any], dict[str, Any]]] = {
    topics.LEG: _leg,
    topics.CORNER: _corner,
    topics.PREDICTION: _prediction,
    topics.PHASE: _plain,
    topics.HELICOPTER_ODOMETRY: _motion,
    topics.WAYPOINTS: _points,
    topics.CORNER_PLAN: _corner_plan,
    topics.SPEED: _plain,
    topics.CLEARED: _points,
    topics.MONITOR: _alert,
}
INPUTS = (
    topics.FIX,
    topics.VELOCITY,
    topics.DATUM,
    topics.UAV_ODOMETRY,
    topics.UAV_STATE,
    topics.AUTOPILOT,
    topics.WIND,
    topics.UPLOADED,
    topics.MISSION,
)
