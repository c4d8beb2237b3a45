"""Random starts of ``rejoin``: planned, flown by the simulated autopilot, compared with a bound."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose, wrap_angle
from sar_planner.guidance.path_waypoints import path_waypoints
from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.forecast import Forecast, cornering, cruising, departing
from sar_planner.rejoin.rejoin import RejoinTask, rejoin
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.trials.rejoin_bound.bound import lower_bound_s, unhindered_s

STEP_S = 0.05
SPAN_M = 2000.0
CLEAR_M = 60.0
MARGIN_M = 5.0
TRIM = 0.1
DATUM = Datum(37.8, -122.8)
NEVER = {"closest_m": 0.0, "miss_m": math.inf, "heading_error_deg": 180.0}
PHASES = ("cruise", "decelerating", "stopped", "accelerating")


@dataclass(frozen=True)
class Trial:
    """One start: how it went. Distances in metres, times in seconds, the angle in degrees."""

    seed: int
    phase: str
    kept: bool
    planned_s: float
    bound_s: float
    closest_m: float
    miss_m: float
    heading_error_deg: float

    @property
    def ratio(self) -> float:
        """Planned time over the lower bound."""
        return self.planned_s / self.bound_s


def random_forecast(rng: np.random.Generator, p: CornerParameters) -> tuple[str, Forecast]:
    """Return a helicopter in a random phase, in the slot's frame (its last leg on y = d)."""
    phase = PHASES[int(rng.integers(len(PHASES)))]
    leg = Pose(0.0, p.spacing_m, 0.0)
    v, a = p.speed_mps, p.accel_mps2
    if phase == "cruise":
        return phase, cruising(0.0, leg, v)
    if phase == "accelerating":
        return phase, departing(0.0, leg, float(rng.uniform(0.0, v)), speed_mps=v, accel_mps2=a)
    if phase == "stopped":
        return phase, departing(float(rng.uniform(0.0, 20.0)), leg, 0.0, speed_mps=v, accel_mps2=a)
    # Before a right turn the old leg comes from the inside's other side: heading +90 degrees.
    stop = Pose(0.0, p.spacing_m, math.pi / 2.0)
    onset = -float(rng.uniform(0.0, v / a))
    return phase, cornering(onset, stop, speed_mps=v, accel_mps2=a)


def apart_always(task: RejoinTask) -> bool:
    """Whether the start leaves the separation any room: two hard turns and straight on."""
    times = np.arange(0.0, 25.0, 0.25)
    helicopter = task.forecast.positions(times)
    r, h = task.turn_radius_m, task.start.heading_rad
    for side in (1.0, -1.0, 0.0):
        flown = task.fastest_mps * times
        if side == 0.0:
            x = task.start.x_m + flown * math.cos(h)
            y = task.start.y_m + flown * math.sin(h)
        else:
            x = task.start.x_m + side * r * (np.sin(h + side * flown / r) - math.sin(h))
            y = task.start.y_m - side * r * (np.cos(h + side * flown / r) - math.cos(h))
        if np.hypot(x - helicopter[:, 0], y - helicopter[:, 1]).min() >= task.separation_m:
            return True
    return False


def random_task(seed: int, p: CornerParameters) -> tuple[str, RejoinTask]:
    """Return a start within 2 km of the helicopter from which it can be kept apart from."""
    rng = np.random.default_rng(seed)
    phase, forecast = random_forecast(rng, p)
    here = forecast.positions([0.0])[0]
    v = p.speed_mps
    while True:
        x, y = here + rng.uniform(-SPAN_M, SPAN_M, 2)
        start = Pose(float(x), float(y), float(rng.uniform(-math.pi, math.pi)))
        task = RejoinTask(
            start,
            0.0,
            (forecast,),
            p.turn_radius_m,
            v * (1.0 - TRIM),
            v * (1.0 + TRIM),
            p.separation_m + MARGIN_M,
        )
        far = math.hypot(*(np.array((x, y)) - here)) > p.separation_m + CLEAR_M
        if far and apart_always(task):
            return phase, task


def fly(seed: int, p: CornerParameters | None = None, *, bounded: bool = True) -> Trial:
    """Plan one start and fly it with the simulated autopilot, at the speed planned.

    ``bounded``: whether the time is held against the bound with the helicopter in the way, which
    a process prepares for when it is asked for first; else against that without it.
    """
    p = p or CornerParameters()
    phase, task = random_task(seed, p)
    plan = rejoin(task)
    if plan is None:
        bound = max(unhindered_s(task), 1.0)
        return Trial(seed, phase, kept=False, planned_s=math.inf, bound_s=bound, **NEVER)
    bound = max(lower_bound_s(task, plan.duration_s) if bounded else unhindered_s(task), 1.0)
    autopilot = SimAutopilot(
        task.start,
        speed_mps=plan.speed_mps,
        datum=DATUM,
    )
    beyond = plan.path.end.offset(2000.0)
    points = np.vstack((path_waypoints(plan.path, 10.0), (beyond.x_m, beyond.y_m)))
    autopilot.load(waypoint_items(points, DATUM, 150.0))
    autopilot.set_current(1)
    autopilot.set_mode(FlightMode.AUTO)
    steps = round(plan.duration_s / STEP_S)
    flown = np.empty((steps + 1, 2))
    flown[0] = task.start.x_m, task.start.y_m
    for i in range(steps):
        autopilot.step(STEP_S)
        flown[i + 1] = autopilot.state.x_m, autopilot.state.y_m
    times = np.linspace(0.0, steps * STEP_S, steps + 1)
    helicopter = task.forecast.positions(times)
    closest = float(np.hypot(*(flown - helicopter).T).min())
    slot = task.forecast.slot_x_m(steps * STEP_S)
    return Trial(
        seed,
        phase,
        plan.kept,
        plan.duration_s,
        bound,
        closest,
        math.hypot(flown[-1, 0] - slot, flown[-1, 1]),
        abs(math.degrees(wrap_angle(autopilot.motion.course_rad))),
    )
