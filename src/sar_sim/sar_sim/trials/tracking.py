"""How accurately an autopilot flies corner paths.

A *case* is a corner path in the leg's frame (helicopter's old leg along x, the corner at the
origin, a right turn). It is measured from a run-in before the onset on the old leg to a finish line
across the new one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sar_bridge.mavlink.mission_items import MissionItem, waypoint_items
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_planner.guidance.l1_waypoints import L1Tuning, make_guide
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import Arc, FlightPath, Straight
from sar_planner.rules.paper_rules import Rule, build
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.scenario.scenario import Uav, Wind

FloatArray = NDArray[np.float64]
RUN_IN_M = 300.0
FINISH_M = 1300.0
STEP_S = 0.05
LONGEST_S = 400.0
NEAR_M = 100.0
BEFORE_M, BEYOND_M = 400.0, 600.0
GUIDE_SPACING_M = MissionParameters().guide_spacing_m
DATUM = Datum(37.8, -122.8)


@dataclass(frozen=True)
class Case:
    """A planned corner path, and over which stretch it is measured.

    ``spacing_m``: d, between the tracks; ``run_in_m``: how far before the onset on the old leg, and
    ``finish_m``: how far behind the corner on the new one.
    """

    path: FlightPath
    spacing_m: float
    run_in_m: float = RUN_IN_M
    finish_m: float = FINISH_M

    @cached_property
    def measured(self) -> FlightPath:
        """The path over the stretch that is measured."""
        run_in = self.path.start.offset(-self.run_in_m)
        onto = FlightPath.of(run_in, (Straight(self.run_in_m), *self.path.segments))
        end = self.path.end
        return onto.then(FlightPath.of(end, (Straight(end.y_m + self.finish_m),)))


def adjustable_curve(
    lag_m: float, straight_m: float, theta_rad: float, p: CornerParameters
) -> FlightPath:
    """Return S(p) R(pi) S(y) L(pi - theta) R(pi/2 - theta) for y [m] and theta [rad].

    p = 2 R sin theta - R - d + y + s + L. Raises ``ValueError`` where p is negative.
    """
    r = p.turn_radius_m
    lead = 2.0 * r * math.sin(theta_rad) - r - p.spacing_m + straight_m + p.stopping_m + lag_m
    return FlightPath.of(
        Pose(-(p.stopping_m + lag_m), -p.spacing_m, 0.0),
        (
            Straight(lead),
            Arc(r, -math.pi),
            Straight(straight_m),
            Arc(r, math.pi - theta_rad),
            Arc(r, theta_rad - math.pi / 2.0),
        ),
    )


def _cases() -> dict[str, Case]:
    p = CornerParameters()
    paths = {
        "T3": build(Rule.T3, 0.0, p).path,
        "T1": build(Rule.T1, 700.0, p).path,
        "C": adjustable_curve(250.0, 108.0, math.radians(72.0), p),
    }
    return {name: Case(path, p.spacing_m) for name, path in paths.items()}


CASES = _cases()
"""Corners of the paper's geometry: T3 at L = 0, T1 at 700 m, an adjustable curve at 250 m."""


def stretch(points: FloatArray, case: Case) -> FloatArray | None:
    """Return the part of a track, shape (n, 2), that is measured; None where it is not whole."""
    start, finish_y = case.measured.start, -case.finish_m
    x, y = points.T
    begun: int | None = None
    for i in range(1, len(points)):
        if x[i - 1] < start.x_m <= x[i] and abs(y[i] - start.y_m) < NEAR_M:
            begun = i
        finished = y[i] <= finish_y < y[i - 1] and abs(x[i] + case.spacing_m) < NEAR_M
        if begun is not None and finished:
            first = _crossing(points[begun - 1], points[begun], 0, start.x_m)
            last = _crossing(points[i - 1], points[i], 1, finish_y)
            return np.vstack((first, points[begun:i], last))
    return None


def _crossing(before: FloatArray, after: FloatArray, axis: int, value: float) -> FloatArray:
    share = (value - before[axis]) / (after[axis] - before[axis])
    return np.asarray(before + share * (after - before))


def length_m(points: FloatArray) -> float:
    """Return a track's length [m]."""
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def distances_m(points: FloatArray, line: FloatArray) -> FloatArray:
    """Return the distance of every point, shape (n, 2), from a polyline, shape (m, 2)."""
    begin, way = line[:-1], np.diff(line, axis=0)
    length_2 = np.maximum((way**2).sum(axis=1), 1e-9)
    least = np.empty(len(points))
    for i, point in enumerate(points):
        share = np.clip(((point - begin) * way).sum(axis=1) / length_2, 0.0, 1.0)
        foot = begin + share[:, None] * way
        least[i] = np.hypot(*(point - foot).T).min()
    return least


def rms(values: FloatArray) -> float:
    """Return the root of the mean square."""
    return math.sqrt(float((values**2).mean()))


def path_points(path: FlightPath, step_m: float = 2.0) -> FloatArray:
    """Return points along a path, shape (n, 2)."""
    stations = np.linspace(0.0, path.length_m, max(2, math.ceil(path.length_m / step_m)))
    return path.points(stations)


@dataclass(frozen=True, slots=True)
class Flown:
    """How a case was flown: length beyond the planned one, and rms off the planned path [m]."""

    extra_m: float
    off_m: float
    points: FloatArray


def measure(points: FloatArray, case: Case) -> Flown | None:
    """Measure a track against a case's path; None where it does not fly all of it."""
    part = stretch(points, case)
    if part is None:
        return None
    path = case.measured
    off = rms(distances_m(part, path_points(path)))
    return Flown(length_m(part) - path.length_m, off, part)


def fly_items(
    items: list[MissionItem],
    start: Pose,
    *,
    airspeed_mps: float,
    uav: Uav,
    wind: Wind,
    first: int = 1,
    finish_m: float = FINISH_M,
    longest_s: float = LONGEST_S,
) -> FloatArray:
    """Fly a mission from ``start`` with item ``first`` current; return the track, shape (n, 2).

    Until it is beyond y = -``finish_m``, for no longer than ``longest_s``.
    """
    pilot = SimAutopilot(
        start, speed_mps=airspeed_mps, uav=uav, wind=wind, datum=DATUM, altitude_m=150.0
    )
    pilot.load(items)
    pilot.set_current(first)
    pilot.set_mode(FlightMode.AUTO)
    track = [(pilot.state.x_m, pilot.state.y_m)]
    while pilot.state.time_s < longest_s and track[-1][1] > -finish_m - NEAR_M:
        pilot.step(STEP_S)
        track.append((pilot.state.x_m, pilot.state.y_m))
    return np.array(track)


def fly_guided(case: Case, *, uav: Uav, wind: Wind, airspeed_mps: float = 20.0) -> FloatArray:
    """Fly a case on the planner's own waypoints, at a constant airspeed; return the track."""
    path = case.measured
    start = path.start.offset(-BEFORE_M)
    whole = FlightPath.of(start, (Straight(BEFORE_M), *path.segments, Straight(BEYOND_M)))
    tuning = L1Tuning(uav.l1_period_s, uav.l1_damping)
    air = AirEnvelope(airspeed_mps, airspeed_mps, wind.vector_mps)
    guide = make_guide(whole, tuning, airspeed_mps, air=air)
    items = waypoint_items(guide.waypoints(GUIDE_SPACING_M), DATUM, 150.0)
    return fly_items(items, start, airspeed_mps=airspeed_mps, uav=uav, wind=wind)
