"""How accurately an autopilot flies corner paths: recorded ones against simulated ones.

A *case* is a corner path of the paper's geometry, in the leg's frame (helicopter's old leg along x,
the corner at the origin, a right turn). It is measured between ``RUN_IN_M`` before the onset on the
old leg and y = ``FINISH_Y_M`` on the new one, as the recordings' own tables are.
"""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass, replace
from pathlib import Path

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
FINISH_Y_M = -1300.0
BEFORE_S = 30.0
STEP_S = 0.05
LONGEST_S = 400.0
NEAR_M = 100.0
BEFORE_M, BEYOND_M = 400.0, 600.0
GUIDE_SPACING_M = MissionParameters().guide_spacing_m
PLAIN = (0.0, 0.0, 0.0, 0.0)
DATUM = Datum(37.8, -122.8)


class RecordingError(ValueError):
    """A recording that cannot be read; the message names the file and what was expected."""


def _case_paths() -> dict[str, FlightPath]:
    p = CornerParameters()
    r, y, theta, lag = p.turn_radius_m, 108.0, math.radians(72.0), 250.0
    lead = 2.0 * r * math.sin(theta) - r - p.spacing_m + y + p.stopping_m + lag
    curve = FlightPath.of(
        Pose(-(p.stopping_m + lag), -p.spacing_m, 0.0),
        (
            Straight(lead),
            Arc(r, -math.pi),
            Straight(y),
            Arc(r, math.pi - theta),
            Arc(r, theta - math.pi / 2.0),
        ),
    )
    return {"T3": build(Rule.T3, 0.0, p).path, "T1": build(Rule.T1, 700.0, p).path, "C": curve}


CASES = _case_paths()


def measured_path(case: str) -> FlightPath:
    """Return a case's path over the stretch that is measured."""
    path = CASES[case]
    run_in = path.start.offset(-RUN_IN_M)
    onto = FlightPath.of(run_in, (Straight(RUN_IN_M), *path.segments))
    return onto.then(FlightPath.of(path.end, (Straight(path.end.y_m - FINISH_Y_M),)))


@dataclass(frozen=True)
class Recording:
    """A flown mission: its waypoints, shape (m, 2), and the track as columns of shape (n,)."""

    waypoints: FloatArray
    planned: NDArray[np.bool_]
    time_s: FloatArray
    points: FloatArray
    course_rad: FloatArray
    ground_speed_mps: FloatArray


def _columns(path: Path, names: tuple[str, ...]) -> FloatArray:
    """Return columns of a CSV file, shape (n, len(names)). Raises ``RecordingError``."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        return np.array([[float(row[name]) for name in names] for row in rows])
    except OSError as error:
        raise RecordingError(f"{path}: {error.strerror}") from error
    except (KeyError, TypeError, ValueError) as error:
        raise RecordingError(f"{path}: {error}: expected columns {', '.join(names)}") from error


def load_recording(folder: Path, name: str) -> Recording:
    """Read ``NAME_waypoints.csv`` and ``NAME_track.csv``. Raises ``RecordingError``."""
    mission = _columns(folder / f"{name}_waypoints.csv", ("x_m", "y_m", "on_planned_path"))
    columns = ("t_s", "x_m", "y_m", "course_rad", "groundspeed_mps")
    track = _columns(folder / f"{name}_track.csv", columns)
    return Recording(
        mission[:, :2], mission[:, 2] > 0.5, track[:, 0], track[:, 1:3], track[:, 3], track[:, 4]
    )


def stretch(points: FloatArray, case: str) -> FloatArray | None:
    """Return the part of a track, shape (n, 2), that is measured; None where it is not whole."""
    start = measured_path(case).start
    x, y = points.T
    begun: int | None = None
    for i in range(1, len(points)):
        if x[i - 1] < start.x_m <= x[i] and abs(y[i] - start.y_m) < NEAR_M:
            begun = i
        finished = y[i] <= FINISH_Y_M < y[i - 1] and abs(x[i] + CornerParameters().spacing_m)
        if begun is not None and finished and finished < NEAR_M:
            first = _crossing(points[begun - 1], points[begun], 0, start.x_m)
            last = _crossing(points[i - 1], points[i], 1, FINISH_Y_M)
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


def measure(points: FloatArray, case: str) -> Flown | None:
    """Measure a track against a case's path; None where it does not fly all of it."""
    part = stretch(points, case)
    if part is None:
        return None
    path = measured_path(case)
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
) -> FloatArray:
    """Fly a mission from ``start`` with item ``first`` current; return the track, shape (n, 2)."""
    pilot = SimAutopilot(
        start, speed_mps=airspeed_mps, uav=uav, wind=wind, datum=DATUM, altitude_m=150.0
    )
    pilot.load(items)
    pilot.set_current(first)
    pilot.set_mode(FlightMode.AUTO)
    track = [(pilot.state.x_m, pilot.state.y_m)]
    while pilot.state.time_s < LONGEST_S and track[-1][1] > FINISH_Y_M - NEAR_M:
        pilot.step(STEP_S)
        track.append((pilot.state.x_m, pilot.state.y_m))
    return np.array(track)


def refly(recording: Recording, case: str, *, uav: Uav, wind: Wind) -> FloatArray:
    """Fly a recording's own mission, from where the UAV was ``BEFORE_S`` before the stretch."""
    start_x = measured_path(case).start.x_m
    x, y = recording.points.T
    crossed = (x[:-1] < start_x) & (x[1:] >= start_x) & (np.abs(y[1:] + 250.0) < NEAR_M)
    if not crossed.any():
        raise RecordingError(f"case {case}: the recorded track does not cross x = {start_x:.0f} m")
    at = int(np.flatnonzero(crossed)[-1])
    at = int(np.searchsorted(recording.time_s, recording.time_s[at] - BEFORE_S))
    ahead = recording.planned & (recording.waypoints[:, 0] > x[at])
    vx, vy = wind.vector_mps
    speed, course = recording.ground_speed_mps[at], recording.course_rad[at]
    airspeed = math.hypot(speed * math.cos(course) - vx, speed * math.sin(course) - vy)
    start = Pose(float(x[at]), float(y[at]), float(course))
    items = [
        replace(item, params=PLAIN) for item in waypoint_items(recording.waypoints, DATUM, 150.0)
    ]
    return fly_items(
        items,
        start,
        airspeed_mps=airspeed,
        uav=uav,
        wind=wind,
        first=int(np.flatnonzero(ahead)[0]) + 1,
    )


def fly_guided(case: str, *, uav: Uav, wind: Wind, airspeed_mps: float = 20.0) -> FloatArray:
    """Fly a case on the planner's own waypoints, at a constant airspeed; return the track."""
    path = measured_path(case)
    start = path.start.offset(-BEFORE_M)
    whole = FlightPath.of(start, (Straight(BEFORE_M), *path.segments, Straight(BEYOND_M)))
    tuning = L1Tuning(uav.l1_period_s, uav.l1_damping)
    air = AirEnvelope(airspeed_mps, airspeed_mps, wind.vector_mps)
    guide = make_guide(whole, tuning, airspeed_mps, air=air)
    items = waypoint_items(guide.waypoints(GUIDE_SPACING_M), DATUM, 150.0)
    return fly_items(items, start, airspeed_mps=airspeed_mps, uav=uav, wind=wind)
