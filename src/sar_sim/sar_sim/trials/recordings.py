"""Recorded flights of corners: read, and flown again by the simulated autopilot.

A recording NAME is three files in a folder: ``NAME.yaml``, what was planned and with what it was
flown (``Terms``), ``NAME_waypoints.csv``, the mission, and ``NAME_track.csv``, where it led.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass as checked_dataclass

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_estimator.common.checked import CHECKED, NotNegative, Positive, read
from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import FlightPath
from sar_planner.rules.paper_rules import Rule, build
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav, Wind, read_document
from sar_sim.trials.tracking import (
    DATUM,
    FINISH_M,
    LONGEST_S,
    NEAR_M,
    RUN_IN_M,
    Case,
    FloatArray,
    adjustable_curve,
    fly_items,
)

BEFORE_S = 30.0
LONGEST_SHARE = 3.0
PLAIN = (0.0, 0.0, 0.0, 0.0)
SUFFIX, TRACK, WAYPOINTS = ".yaml", "_track.csv", "_waypoints.csv"
WAYPOINT_COLUMNS = ("x_m", "y_m", "on_planned_path")
TRACK_COLUMNS = ("t_s", "x_m", "y_m", "course_rad", "groundspeed_mps")
TUNED = (
    "autopilot",
    "l1_period_s",
    "l1_damping",
    "wp_radius_m",
    "roll_limit_deg",
    "roll_lag_s",
    "turn_share",
    "speed_lag_s",
    "accel_limit_mps2",
    "airspeed_min_mps",
    "airspeed_max_mps",
    "believed_radius_m",
)
"""The keys of a scenario's ``uav`` that a recording may have."""
FLOWN = tuple(kind for kind in AUTOPILOTS if kind != "ideal")


class RecordingError(ValueError):
    """A recording that cannot be read; the message names the file and what was expected."""


@checked_dataclass(frozen=True, slots=True, config=CHECKED)
class Planned:
    """The path that was planned: one of the paper's rules, or C, the adjustable curve.

    ``lag_m``: L [m]. Of C alone, ``straight_m``: y, and ``theta_deg``: theta of S(p) R(pi) S(y)
    L(pi - theta) R(pi/2 - theta).
    """

    rule: Literal["T1", "T2", "T3", "T4", "C"]
    lag_m: float
    straight_m: NotNegative | None = None
    theta_deg: Annotated[float, Field(ge=0.0, lt=90.0)] | None = None

    def __post_init__(self) -> None:
        """Check that C, and only C, has its two numbers."""
        for name in ("straight_m", "theta_deg"):
            value = getattr(self, name)
            if (value is None) == (self.rule == "C"):
                wanted = "a number with rule C" if value is None else f"none with rule {self.rule}"
                raise ValueError(f"{name} = {value}: expected {wanted}")

    def path(self, p: CornerParameters) -> FlightPath:
        """Return it in the corner's frame. Raises ``ValueError`` where there is none."""
        if self.straight_m is None or self.theta_deg is None:
            return build(Rule(self.rule), self.lag_m, p).path
        return adjustable_curve(self.lag_m, self.straight_m, math.radians(self.theta_deg), p)


@checked_dataclass(frozen=True, slots=True, config=CHECKED)
class MeanWind:
    """The wind that blew: its mean, from a direction in which x is east and y north."""

    speed_mps: NotNegative = 0.0
    from_deg: float = 0.0


@checked_dataclass(frozen=True, slots=True, config=CHECKED)
class Terms:
    """What ``NAME.yaml`` says: the path, the corner that it was planned for, UAV and wind.

    ``uav``: keys of a scenario's ``uav`` (``TUNED``), those of an ArduPlane by default. Measured
    from ``run_in_m`` before the onset to ``finish_m`` behind the corner.
    """

    path: Planned
    corner: CornerParameters = field(default_factory=CornerParameters)
    uav: dict[str, Any] = field(default_factory=dict)
    wind: MeanWind = field(default_factory=MeanWind)
    run_in_m: Positive = RUN_IN_M
    finish_m: Positive = FINISH_M


@dataclass(frozen=True)
class Recording:
    """A flown mission: its waypoints, shape (m, 2), and the track as columns of shape (n,).

    ``planned``, shape (m,): which waypoints are the corner path's. ``case``: what was planned;
    ``uav``, ``wind``: with which it is flown again.
    """

    name: str
    case: Case
    uav: Uav
    wind: Wind
    waypoints: FloatArray
    planned: NDArray[np.bool_]
    time_s: FloatArray
    points: FloatArray
    course_rad: FloatArray
    ground_speed_mps: FloatArray


def names_in(folder: Path) -> list[str]:
    """Return the recordings of a folder by name.

    Raises ``RecordingError`` where there is none, or a track without its YAML file.
    """
    names = sorted(path.stem for path in folder.glob(f"*{SUFFIX}"))
    for track in sorted(folder.glob(f"*{TRACK}")):
        name = track.name.removesuffix(TRACK)
        if name not in names:
            raise RecordingError(f"{track}: expected {name}{SUFFIX} beside it")
    if not names:
        wanted = ", ".join(f"NAME{end}" for end in (SUFFIX, WAYPOINTS, TRACK))
        raise RecordingError(f"{folder}: no recordings, expected {wanted}")
    return names


def load_recording(folder: Path, name: str) -> Recording:
    """Read a recording. Raises ``RecordingError`` with file, key, value and what was expected."""
    path = folder / f"{name}{SUFFIX}"
    try:
        terms = read(Terms, read_document(path))
        case, uav = _case(terms), _uav(terms.uav)
    except ValueError as error:
        said = str(error)
        raise RecordingError(said if said.startswith(str(path)) else f"{path}: {said}") from error
    mission = _columns(folder / f"{name}{WAYPOINTS}", WAYPOINT_COLUMNS)
    track_file = folder / f"{name}{TRACK}"
    track = _columns(track_file, TRACK_COLUMNS)
    back = np.flatnonzero(np.diff(track[:, 0]) < 0.0)
    if back.size:
        at = track[back[0] + 1, 0]
        raise RecordingError(f"{track_file}: t_s = {at:g}: expected not less than the row before")
    return Recording(
        name=name,
        case=case,
        uav=uav,
        wind=Wind(terms.wind.speed_mps, terms.wind.from_deg),
        waypoints=mission[:, :2],
        planned=mission[:, 2] > 0.5,
        time_s=track[:, 0],
        points=track[:, 1:3],
        course_rad=track[:, 3],
        ground_speed_mps=track[:, 4],
    )


def _case(terms: Terms) -> Case:
    path = terms.path.path(terms.corner)
    if terms.finish_m <= -path.end.y_m:
        raise ValueError(
            f"finish_m = {terms.finish_m:g}: expected more than {-path.end.y_m:.0f}, where the "
            "path ends"
        )
    return Case(path, terms.corner.spacing_m, terms.run_in_m, terms.finish_m)


def _uav(values: Mapping[str, Any]) -> Uav:
    """Return a UAV of which is said what differs from its autopilot's preset."""
    for key in values:
        if key not in TUNED:
            raise ValueError(f"uav.{key}: unknown key, expected one of {', '.join(TUNED)}")
    kind = values.get("autopilot", "arduplane")
    if kind not in FLOWN:
        raise ValueError(f"uav.autopilot = {kind!r}: expected {' or '.join(FLOWN)}")
    return read(Uav, {**AUTOPILOTS[kind], "autopilot": kind, **values}, "uav")


def _columns(path: Path, names: tuple[str, ...]) -> FloatArray:
    """Return columns of a CSV file, shape (n, len(names)), n > 1. Raises ``RecordingError``."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        values = np.array([[float(row[name]) for name in names] for row in rows])
    except OSError as error:
        raise RecordingError(f"{path}: {error.strerror}") from error
    except (KeyError, TypeError, ValueError, csv.Error) as error:
        raise RecordingError(f"{path}: {error}: expected columns {', '.join(names)}") from error
    if len(values) < 2:
        raise RecordingError(f"{path}: {len(values)} rows: expected 2 or more")
    bad = np.argwhere(~np.isfinite(values))
    if bad.size:
        row, column = bad[0]
        found = values[row, column]
        raise RecordingError(f"{path}: {names[column]} = {found:g}: expected a finite number")
    return values


def refly(recording: Recording) -> FloatArray:
    """Fly a recording's own mission, from where the UAV was ``BEFORE_S`` before the stretch.

    Returns the track, shape (n, 2). Raises ``RecordingError`` where the recorded flight does not
    come to the stretch, or its mission has no waypoint ahead there.
    """
    case, wind = recording.case, recording.wind
    start = case.measured.start
    x, y = recording.points.T
    crossed = (x[:-1] < start.x_m) & (x[1:] >= start.x_m) & (np.abs(y[1:] - start.y_m) < NEAR_M)
    if not crossed.any():
        raise RecordingError(
            f"{recording.name}: the track does not cross x = {start.x_m:.0f} m within "
            f"{NEAR_M:.0f} m of y = {start.y_m:.0f} m"
        )
    at = int(np.flatnonzero(crossed)[-1])
    at = int(np.searchsorted(recording.time_s, recording.time_s[at] - BEFORE_S))
    ahead = np.flatnonzero(recording.planned & (recording.waypoints[:, 0] > x[at]))
    if not ahead.size:
        raise RecordingError(
            f"{recording.name}: no waypoint with on_planned_path = 1 beyond x = {x[at]:.0f} m, "
            "where it begins to be flown again"
        )
    vx, vy = wind.vector_mps
    speed, course = recording.ground_speed_mps[at], recording.course_rad[at]
    airspeed = math.hypot(speed * math.cos(course) - vx, speed * math.sin(course) - vy)
    if speed <= 0.0 or airspeed <= 0.0:
        raise RecordingError(
            f"{recording.name}: groundspeed_mps = {speed:g} at t_s = {recording.time_s[at]:g}: "
            "expected more than 0, and not the wind's"
        )
    items = [
        replace(item, params=PLAIN) for item in waypoint_items(recording.waypoints, DATUM, 150.0)
    ]
    longest = BEFORE_S + LONGEST_SHARE * case.measured.length_m / airspeed
    return fly_items(
        items,
        Pose(float(x[at]), float(y[at]), float(course)),
        airspeed_mps=airspeed,
        uav=recording.uav,
        wind=wind,
        first=int(ahead[0]) + 1,
        finish_m=case.finish_m,
        longest_s=max(LONGEST_S, longest),
    )
