"""What the components tell each other beside the estimator's values: plain values, no messages."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import FloatArray, Motion


class Velocity(NamedTuple):
    """A receiver's velocity, east and north [m/s], at a time [s].

    ``sigma_mps``: its standard deviation along one axis, None where the receiver does not say.
    """

    time_s: float
    vx_mps: float
    vy_mps: float
    sigma_mps: float | None = None


class HelicopterReport(NamedTuple):
    """The helicopter's motion, and how sure its position [m] and velocity [m/s] are.

    ``altitude_m``: above mean sea level, NaN where it is not known.
    """

    motion: Motion
    position_sigma_m: float
    velocity_sigma_mps: float
    altitude_m: float = math.nan


class Mark(NamedTuple):
    """A place that somebody marked at a time [s]: ``number`` from 1, where it is in the map [m]."""

    number: int
    time_s: float
    x_m: float
    y_m: float


class Target(NamedTuple):
    """A place that is to be marked, or a mark that is to be moved there [m]."""

    time_s: float
    x_m: float
    y_m: float


class UavReport(NamedTuple):
    """The UAV's motion, its heading, and its altitude above mean sea level, NaN where unknown [m].

    And how it is flown there: pitch and roll (to the right positive), and its climb.
    """

    motion: Motion
    yaw_rad: float
    altitude_m: float = math.nan
    pitch_rad: float = 0.0
    roll_rad: float = 0.0
    climb_mps: float = 0.0


@dataclass(frozen=True, slots=True)
class UavStatus:
    """What the autopilot says of itself: flight mode, arming, and whether it is heard.

    ``tracking_list``: whether the bridge has a list of ours flown. ``airspeed_ratio``: true
    airspeed over the indicated one, which is what the autopilot is asked for. ``taken``: how
    somebody else has taken the UAV that was led, empty where nobody has.
    """

    mode: str = ""
    armed: bool = False
    connected: bool = False
    tracking_list: bool = False
    airspeed_ratio: Annotated[float, Field(ge=0.5, le=2.0)] = 1.0
    taken: str = ""


@dataclass(frozen=True)
class WaypointList:
    """A whole list for the autopilot: ``points``, shape (n, 2) [m] in the map; none withdraw it.

    ``list_id``: by which planner, monitor and bridge tell it from others. ``speed_mps``: the ground
    speed a path is planned with; None for a slot track. ``climb_m``: above the usual altitude.
    """

    list_id: int
    time_s: float
    points: FloatArray
    speed_mps: float | None = None
    climb_m: float = 0.0

    @classmethod
    def withdrawal(cls, time_s: float) -> WaypointList:
        """Return the list of no points, which withdraws the one that is flown."""
        return cls(round(time_s * 1e9), time_s, np.empty((0, 2)))


@dataclass(frozen=True)
class MonitorReport:
    """What the separation monitor says.

    ``alert``: none, caution, warning or escape. ``reason``: why the newest list was refused, or the
    UAV sent away. ``refused_id``: of the newest list that it did not let pass, 0 for none.
    ``thresholds``: distances [m] by name. ``counts``: how often each alert began, and lists passed
    and were refused. ``too_near``: that the aircraft are too near each other now, and ``adsb``:
    that the helicopter's ADS-B position is elsewhere; empty where it is not so.
    """

    alert: str = "none"
    reason: str = ""
    refused_id: int = 0
    watch_only: bool = False
    thresholds: Mapping[str, float] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)
    too_near: str = ""
    adsb: str = ""

    @property
    def escaping(self) -> bool:
        """Whether the monitor leads the UAV away."""
        return self.alert == "escape"


@dataclass(frozen=True, slots=True)
class CornerRecord:
    """A decision at corner ``k`` (from 1), with the list ``list_id`` of time ``list_time_s``.

    ``lag_m``, ``next_lag_m``: L(k), and L(k+1) as predicted. ``length_m``: of the path. The corner
    as it was estimated at ``estimated_at_s``: onset and stop [s], V and a, the stop with the
    heading that the helicopter comes with, and where it was expected at first. ``turn_radius_m``:
    that the path is planned with. ``tube_m``: what the path keeps until ``tube_until_s``, whatever
    of a tube of corners it is [m]; None where that is not known.
    """

    k: int
    rule: str
    list_id: int
    list_time_s: float
    lag_m: float
    next_lag_m: float
    length_m: float
    onset_time_s: float
    stop_time_s: float
    estimated_at_s: float
    speed_mps: float
    accel_mps2: float
    turn_radius_m: float
    stop: Pose
    first_stop: Pose
    tube_m: float | None = None
    tube_until_s: float | None = None


class Uploaded(NamedTuple):
    """A list that the autopilot has accepted: its identity, size, and how long it took [ms]."""

    list_id: int
    waypoints: int = 0
    upload_ms: float = 0.0


@dataclass(frozen=True)
class Health:
    """How a node is: what is wrong, empty when nothing is, and figures by name.

    ``severe``: whether a flight must not go on so: an escape, a dead link, a lost GPS.
    """

    name: str
    problem: str = ""
    values: Mapping[str, object] = field(default_factory=dict)
    severe: bool = False
