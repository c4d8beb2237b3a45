"""A recorded flight once more through the components that flew it, and what they do otherwise.

Estimator, planner and monitor are each fed with what was recorded of their *inputs*, in the order
of the bag; their outputs are compared with what was recorded of those. Each so stands for itself:
a planner is not led astray by an estimator that has changed.

The estimator publishes a prediction, the planner decides, and twice a second the monitor looks,
whenever the bag has a prediction of the helicopter. An offline flight does exactly that. In the
graph every node has a timer of its own, up to a period apart from it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from sar_estimator.common import topics
from sar_estimator.common.checked import read
from sar_estimator.common.component import Component, Outputs
from sar_estimator.common.conversions import (
    from_stamp,
    odometry_to_leg,
    odometry_to_motion,
    path_to_corner,
    path_to_points,
)
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.wires import WIRES
from sar_estimator.estimation.component import EstimatorComponent
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_planner.component import PlannerComponent
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_sim.flight.offline import monitor_for

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
            mission = WIRES[topic].from_message(message)
        elif topic == topics.DATUM and datum is None:
            datum = Datum(message.latitude, message.longitude, message.altitude)
        elif topic == topics.MONITOR:
            watch_only = WIRES[topic].from_message(message).watch_only
        elif topic == topics.WAYPOINTS:
            if message.poses and not led:
                engaged.append(from_stamp(message.header.stamp))
            led = bool(message.poses)
    if mission is None:
        raise ValueError(f"no {topics.MISSION}: expected the planner's parameters")
    try:
        corner = read(CornerParameters, mission.get("corner"), "corner", texts=True)
        settings = read(MissionParameters, mission.get("mission"), "mission", texts=True)
    except ValueError as error:
        raise ValueError(
            f"{topics.MISSION}: {error}: expected this version's parameters"
        ) from error
    if not estimator.expected_legs_m:
        estimator = replace(estimator, expected_legs_m=settings.terms.lengths_m())
    return FlownWith(
        corner, settings, estimator, velocity_sigma_mps, datum, tuple(engaged), watch_only
    )


class _Replay:
    """A component that is fed with what was recorded of its inputs.

    ``outputs``: what it would have published of what is compared.
    """

    def __init__(self, component: Component) -> None:
        """Feed a component."""
        self._component = component
        self.outputs: list[Event] = []

    def feed(self, topic: str, time_s: float, message: Any) -> None:
        """Take a recorded message; those that are none of its inputs do nothing."""
        if topic in self._component.inputs:
            value = WIRES[topic].from_message(message)
            self._publish(time_s, self._component.handle(topic, value, time_s))
        if topic == topics.HELICOPTER_ODOMETRY:
            self._tick(time_s, from_stamp(message.header.stamp))

    def _tick(self, time_s: float, now_s: float) -> None:
        """Do what is done whenever the helicopter's motion is predicted."""
        self._publish(time_s, self._component.tick(now_s))

    def _publish(self, time_s: float, outputs: Outputs) -> None:
        self.outputs += [
            (topic, time_s, WIRES[topic].to_message(value, time_s))
            for topic, value in outputs
            if topic in FIGURES
        ]


class EstimatorReplay(_Replay):
    """Fixes and velocities in; leg, corner, phase and predictions out."""

    def __init__(self, flown: FlownWith) -> None:
        """Begin with nothing known but what the flight was flown with."""
        super().__init__(
            EstimatorComponent(
                flown.estimator, flown.datum, velocity_sigma_mps=flown.velocity_sigma_mps
            )
        )

    def feed(self, topic: str, time_s: float, message: Any) -> None:
        """Take a recorded message."""
        super().feed(topic, time_s, message)
        if topic == topics.PHASE:
            # Lost it is by the clock alone: the record says when that was looked at.
            found = self._component.tick(time_s)
            self._publish(time_s, [output for output in found if output[0] == topics.PHASE])


class PlannerReplay(_Replay):
    """What is known of both aircraft in; waypoint lists, corners and speeds out."""

    def __init__(self, flown: FlownWith) -> None:
        """Begin with nothing known but what the flight was flown with."""
        self._planner = PlannerComponent(flown.corner, flown.mission)
        super().__init__(self._planner)
        self._to_engage = list(flown.engaged_s)

    def feed(self, topic: str, time_s: float, message: Any) -> None:
        """Take a recorded message; an operator's withdrawal is one of the planner's own lists."""
        super().feed(topic, time_s, message)
        if topic == topics.WAYPOINTS and not message.poses and self._planner.planner.engaged:
            at_s = from_stamp(message.header.stamp)
            self._publish(time_s, self._planner.services[topics.DISENGAGE](at_s).outputs)

    def _tick(self, time_s: float, now_s: float) -> None:
        if self._to_engage and now_s >= self._to_engage[0] - 1e-6:
            self._to_engage.pop(0)
            self._publish(time_s, self._planner.services[topics.ENGAGE](now_s).outputs)
        else:
            super()._tick(time_s, now_s)


class MonitorReplay(_Replay):
    """Lists and what is known of both aircraft in; the lists that pass, and its state, out."""

    def __init__(self, flown: FlownWith) -> None:
        """Begin with nothing known but what the flight was flown with."""
        self._monitor = monitor_for(flown.corner, flown.mission.terms, watch_only=flown.watch_only)
        super().__init__(self._monitor)
        self._begun = False
        self._looked = -1

    def feed(self, topic: str, time_s: float, message: Any) -> None:
        """Take a recorded message; what is told before anything is known, when the record does."""
        if topic == topics.MONITOR and not self._begun:
            self._begun = True
            self._publish(time_s, self._monitor.start(time_s))
        super().feed(topic, time_s, message)

    def _tick(self, time_s: float, now_s: float) -> None:
        look = math.floor((now_s + 1e-3) / self._monitor.period_s)
        if look != self._looked and self._monitor.is_leading:
            self._looked = look
            super()._tick(time_s, now_s)


def replay(events: Iterable[Event], flown: FlownWith) -> list[Event]:
    """Return what the components would have published, fed with a flight in its order."""
    components = (EstimatorReplay(flown), PlannerReplay(flown), MonitorReplay(flown))
    for topic, time_s, message in events:
        for component in components:
            component.feed(topic, time_s, message)
    return [event for component in components for event in component.outputs]


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


def _curve(message: Any) -> dict[str, Any]:
    # Of its record the length is compared; former bags have it to the centimetre only.
    return {"points": len(message.poses)}


def _corner_plan(message: Any) -> dict[str, Any]:
    record = WIRES[topics.CORNER_PLAN].from_message(message)
    names = ("k", "rule", "lag_m", "next_lag_m", "length_m")
    return {name: getattr(record, name) for name in names}


def _alert(message: Any) -> dict[str, Any]:
    report = WIRES[topics.MONITOR].from_message(message)
    return {"alert": report.alert, **report.counts}


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
    topics.CORNER_PATH: _curve,
    topics.SPEED: _plain,
    topics.CLEARED: _points,
    topics.MONITOR: _alert,
}
INPUTS = (
    topics.FIX,
    topics.VELOCITY,
    topics.FIX_VELOCITY,
    topics.FIX_TIME,
    topics.DATUM,
    topics.UAV_ODOMETRY,
    topics.UAV_STATE,
    topics.AUTOPILOT,
    topics.WIND,
    topics.UPLOADED,
    topics.MISSION,
)
