"""Encounters with a planner that misbehaves: the monitor's trials.

The helicopter, its receiver and estimator, the monitor and the simulated ArduPlane are those that
fly. Only the planner is replaced by one that leads the UAV where it must not be.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from sar_bridge.monitor.separation_monitor import SeparationMonitor
from sar_estimator.common import topics
from sar_estimator.common.checked import Side
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import UavStatus, Uploaded, WaypointList
from sar_estimator.common.states import FloatArray, Motion, list_id_at
from sar_estimator.estimation.component import EstimatorComponent
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_sim.autopilot.presets import parameter_values
from sar_sim.flight.bus import Bus, Joined
from sar_sim.flight.offline import STEPS_PER_GUARD, STEPS_PER_TICK, monitor_for
from sar_sim.flight.upload import SimulatedBridge
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Anomaly, Gps, Pattern, Pilot, Scenario, Uav, Wind
from sar_sim.world.helicopter import Helicopter
from sar_sim.world.world import World

KINDS = ("wrong side", "wrong corner", "stale", "crossing")
NEAR_M = 100.0
LASTS_S = 100.0
LATENCY_S = 0.3
AHEAD_M = 4000.0
BOUND_HEADINGS = 36
BOUND_STEP_S = 0.25
BOUND_RADIUS_M = 60.0


@dataclass(frozen=True, slots=True)
class Encounter:
    """One encounter: distances in metres, horizontal.

    ``gated``: whether lists had to pass the gate. ``bound_m``: the greatest least distance that any
    flyable escape would have kept from the beginning of the misbehaviour on, the helicopter's
    motion known; from the first list that was flown on, where that came later, and 0 where none
    came. ``closest_s`` counts from the misbehaviour's beginning.
    """

    seed: int
    kind: str
    gated: bool
    closest_m: float
    closest_s: float
    bound_m: float
    escapes: int
    refused: int

    @property
    def escapable(self) -> bool:
        """Whether any flyable escape would have kept ``NEAR_M``."""
        return self.bound_m >= NEAR_M

    @property
    def failed(self) -> bool:
        """Whether the aircraft came near although it could have been avoided."""
        return self.escapable and self.closest_m < NEAR_M


def random_scenario(rng: np.random.Generator, seed: int) -> Scenario:
    """Return a helicopter on a pattern, flown by a human, and a UAV about its slot."""
    side: Side = 1 if rng.uniform() < 0.5 else -1
    odd = int(rng.integers(0, 4))
    action: Anomaly = rng.choice(get_args(Anomaly)).item()
    dynamics: dict[str, Any] = {**AUTOPILOTS["arduplane"]}
    return Scenario(
        name="encounter",
        pattern=Pattern(first_leg_m=float(rng.uniform(700.0, 2000.0)), corners=4, turn_side=side),
        pilot=Pilot(
            speed_sigma_mps=0.5,
            accel_spread=0.15,
            turn_spread_deg=30.0,
            hover_spread_s=20.0,
            anomaly_corner=odd,
            anomaly=action,
            seed=seed,
        ),
        gps=Gps(sigma_m=3.0, seed=seed),
        uav=Uav(
            autopilot="arduplane",
            lag_m=float(rng.uniform(-300.0, 1000.0)),
            **dynamics,
        ),
        wind=Wind(float(rng.uniform(0.0, 8.0)), float(rng.uniform(0.0, 360.0)), 0.7, seed=seed),
    )


class BadPlanner:
    """Leads the UAV beside its slot until ``begins_s``, then in one of the bad ways."""

    def __init__(
        self, kind: str, scenario: Scenario, helicopter: Helicopter, begins_s: float
    ) -> None:
        """Know what will happen, to make the worst of it."""
        self.kind, self.begins_s = kind, begins_s
        self._side = scenario.pattern.turn_side
        self._spacing_m = scenario.corner.spacing_m
        self._speed_mps = scenario.corner.speed_mps
        self._helicopter = helicopter

    def points(self, time_s: float, uav: Motion) -> FloatArray | None:
        """Return the list it makes at ``time_s``, shape (n, 2) [m]; None for none."""
        if time_s < self.begins_s or self.kind == "stale":
            return self._beside(0.0, -self._side) if time_s < self.begins_s else None
        if self.kind == "wrong side":
            return self._beside(time_s, self._side)
        if self.kind == "wrong corner":
            turned = uav.pose.offset(200.0)
            across = Pose(turned.x_m, turned.y_m, uav.course_rad + self._side * 0.5 * math.pi)
            end = across.offset(AHEAD_M)
            return np.array([[turned.x_m, turned.y_m], [end.x_m, end.y_m]])
        return self._collision(time_s, uav)

    def _beside(self, time_s: float, left: float) -> FloatArray:
        """Return the track beside the helicopter's course; ``left`` -1 is to its right."""
        leader = self._helicopter.motion(time_s)
        pose = Pose(leader.x_m, leader.y_m, self._helicopter.heading_rad(time_s))
        ahead = [pose.offset(x, left * self._spacing_m) for x in (300.0, AHEAD_M)]
        return np.array([(point.x_m, point.y_m) for point in ahead])

    def _collision(self, time_s: float, uav: Motion) -> FloatArray:
        """Return a straight line that meets the helicopter."""
        meeting = None
        for after_s in np.arange(8.0, 60.0, 1.0):
            there = self._helicopter.motion(time_s + float(after_s))
            reach = math.hypot(there.x_m - uav.x_m, there.y_m - uav.y_m)
            meeting = np.array((there.x_m, there.y_m))
            if reach <= self._speed_mps * after_s:
                break
        assert meeting is not None
        here = np.array((uav.x_m, uav.y_m))
        way = meeting - here
        beyond = meeting + 1000.0 * way / max(float(np.hypot(*way)), 1.0)
        return np.vstack((meeting, beyond))


def escape_bound_m(uav: Motion, helicopter: Callable[[float], Motion], begins_s: float) -> float:
    """Return the greatest least distance [m] that a turn to any heading, and on, would keep.

    The UAV turns at once, either way, on ``BOUND_RADIUS_M``, at its present ground speed.
    """
    times = np.arange(0.0, LASTS_S, BOUND_STEP_S)
    leader = np.array(
        [(motion.x_m, motion.y_m) for motion in (helicopter(begins_s + t) for t in times)]
    )
    speed = uav.speed_mps
    rate = speed / BOUND_RADIUS_M
    best = 0.0
    for turn in np.linspace(-math.pi, math.pi, BOUND_HEADINGS + 1):
        course = uav.course_rad + np.sign(turn) * np.minimum(rate * times, abs(turn))
        steps = speed * BOUND_STEP_S * np.column_stack((np.cos(course), np.sin(course)))
        path = np.array((uav.x_m, uav.y_m)) + np.vstack((np.zeros(2), np.cumsum(steps, axis=0)))
        best = max(best, float(np.hypot(*(path[:-1] - leader).T).min()))
    return best


class _Flight:
    """World, estimator and monitor, and the lists' way to the autopilot."""

    def __init__(self, scenario: Scenario, *, gated: bool) -> None:
        self.world = world = World(scenario)
        self._estimator = EstimatorComponent(EstimatorParameters(), world.datum)
        self._monitor = monitor_for(scenario.corner, scenario.pattern.terms)
        self._gated = gated
        self._bridge = SimulatedBridge(
            world.autopilot,
            world.datum,
            altitude_m=scenario.sensor.altitude_m,
            item_s=scenario.uav.item_s,
            latency_s=LATENCY_S,
        )
        components = (Joined(self._estimator), Joined(self._monitor))
        self._bus = Bus(components, listeners={topics.CLEARED: self._bridge.take})
        self._bus.start(components)
        self._bus.publish(topics.AUTOPILOT, parameter_values(scenario.uav))
        self._bus.publish(topics.UAV_STATE, UavStatus("AUTO", armed=True, connected=True))
        self._steps = 0

    @property
    def monitor(self) -> SeparationMonitor:
        """The monitor."""
        return self._monitor.monitor

    def offer(self, points: FloatArray) -> None:
        """Hand a list on when it may pass, or when nobody asks."""
        now_s = self.world.time_s
        waypoints = WaypointList(list_id_at(now_s), now_s, points)
        if self._gated:
            self._bus.publish(topics.WAYPOINTS, waypoints)
        elif self.monitor.escape is None:
            self._bridge.take(waypoints)

    def step(self) -> None:
        """Advance by one step."""
        receptions = self.world.step()
        bus = self._bus
        bus.now_s = self.world.time_s
        for reception in receptions:
            bus.receive(reception)
        self._steps += 1
        if self._steps % STEPS_PER_TICK == 0:
            bus.tell_uav(self.world.autopilot)
            bus.tick(self._estimator)
        if self._steps % STEPS_PER_GUARD == 0:
            bus.tick(self._monitor)
        arrived = self._bridge.step(self.world.time_s)
        if arrived is None:
            return
        if self._gated:
            bus.publish(topics.UPLOADED, Uploaded(arrived.list_id, len(arrived.points)))
        elif self.monitor.escape is None:
            self.monitor.set_flown(arrived.points)


def fly_encounter(seed: int) -> Encounter:
    """Fly one encounter; its seed decides everything."""
    rng = np.random.default_rng([seed, 7])
    kind, gated = KINDS[seed % len(KINDS)], bool((seed // len(KINDS)) % 2)
    scenario = random_scenario(rng, seed)
    flight = _Flight(scenario, gated=gated)
    world = flight.world
    helicopter = world.helicopter
    assert helicopter is not None
    begins_s = float(rng.uniform(25.0, 110.0))
    period_s = float(rng.uniform(2.0, 5.0))
    planner = BadPlanner(kind, scenario, helicopter, begins_s)
    closest, closest_s, bound, due_s = math.inf, 0.0, 0.0, 6.0
    while world.time_s < min(begins_s + LASTS_S, world.end_s):
        flight.step()
        now, uav = world.time_s, world.autopilot.motion
        if now >= due_s:
            due_s = now + period_s if now >= begins_s else begins_s
            points = planner.points(now, uav)
            if points is not None:
                flight.offer(points)
        if now < begins_s or not flight.monitor.guarding:
            continue
        if bound == 0.0:
            bound = escape_bound_m(uav, helicopter.motion, now)
        leader = helicopter.motion(now)
        apart = math.hypot(uav.x_m - leader.x_m, uav.y_m - leader.y_m)
        if apart < closest:
            closest, closest_s = apart, now - begins_s
    counts = flight.monitor.counts
    return Encounter(
        seed, kind, gated, closest, closest_s, bound, counts["escape"], counts["refused"]
    )


def summary(encounters: list[Encounter]) -> str:
    """Return what came of the encounters as text."""
    head = "planner       gate  encounters  escape existed  came within 100 m of those   "
    lines = [f"{head}least of those [m]  median [m]  sent away  lists refused"]
    for kind in (*KINDS, "all"):
        for gated in (True, False):
            part = [e for e in encounters if kind in (e.kind, "all") and e.gated is gated]
            some = [e for e in part if e.escapable]
            if not some:
                continue
            near = np.array([e.closest_m for e in some])
            lines.append(
                f"{kind:14s}{'on' if gated else 'off':6s}{len(part):10d}{len(some):16d}"
                f"{sum(e.failed for e in some):20d}{near.min():25.1f}{np.median(near):12.1f}"
                f"{sum(e.escapes > 0 for e in part):11d}{sum(e.refused for e in part):13d}"
            )
    return "\n".join(lines)
