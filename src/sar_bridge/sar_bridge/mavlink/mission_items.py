"""Waypoint lists as mission items: the only place where lat/lon in 1e7 degrees is made."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import Motion

FloatArray = NDArray[np.float64]
TURN_OFF_M = 40.0
TIGHTEST_M = 50.0
WHEREVER_M = 255.0  # NAV_WAYPOINT's widest acceptance radius: ArduPilot keeps it in a byte


@dataclass(frozen=True, slots=True)
class MissionItem:
    """One item of a mission, fields as in MISSION_ITEM_INT."""

    command: int
    latitude_e7: int
    longitude_e7: int
    altitude_m: float
    frame: int = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
    params: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)


def acceptance_m(points: FloatArray) -> list[float]:
    """Return how near the UAV must come to each point of a list, shape (n, 2), to take the next.

    NAV_WAYPOINT's param 2, in whole metres: ``TURN_OFF_M`` for a right angle, in proportion less
    for less, as ArduPlane does with its WP_RADIUS; 0 leaves the last point to that.
    """
    steps = np.diff(points, axis=0)
    courses = np.arctan2(steps[:, 1], steps[:, 0])
    turns = np.abs(np.remainder(np.diff(courses) + math.pi, 2.0 * math.pi) - math.pi)
    inner = np.maximum(np.round(TURN_OFF_M * np.minimum(turns / (0.5 * math.pi), 1.0)), 1.0)
    # The first point of a list is come to from wherever the UAV is.
    return [1.0, *inner.tolist(), 0.0][-len(points) :]


def waypoint_items(points: FloatArray, datum: Datum, altitude_m: float) -> list[MissionItem]:
    """Return the items of a waypoint list, shape (n, 2) [m]: waypoints and a final loiter.

    The list ends in an unlimited loiter, so that a UAV that hears nothing more stays there. Item 0
    is ArduPilot's home place-holder, which the autopilot ignores. ``altitude_m`` is above home.
    """
    places = _degrees_e7(points, datum)
    items = [
        MissionItem(
            mavlink.MAV_CMD_NAV_WAYPOINT,
            latitude,
            longitude,
            altitude_m,
            params=(0.0, near, 0.0, 0.0),
        )
        for (latitude, longitude), near in zip(places, acceptance_m(points), strict=True)
    ]
    last = items[-1]
    loiter = MissionItem(
        mavlink.MAV_CMD_NAV_LOITER_UNLIM, last.latitude_e7, last.longitude_e7, altitude_m
    )
    home = MissionItem(
        mavlink.MAV_CMD_NAV_WAYPOINT,
        items[0].latitude_e7,
        items[0].longitude_e7,
        0.0,
        frame=mavlink.MAV_FRAME_GLOBAL_INT,
    )
    return [home, *items, loiter]


def _degrees_e7(points: FloatArray, datum: Datum) -> list[list[int]]:
    """Return latitudes and longitudes, in 1e-7 degrees, of places, shape (n, 2) [m]."""
    found: list[list[int]] = (
        np.rint(datum.all_to_geodetic(points)[:, :2] * 1e7).astype(int).tolist()
    )
    return found


def reached_at_once(points: FloatArray, datum: Datum, altitude_m: float) -> list[MissionItem]:
    """Return waypoints, shape (n, 2) [m], that a UAV anywhere near has reached already."""
    places = _degrees_e7(points, datum)
    return [
        MissionItem(
            mavlink.MAV_CMD_NAV_WAYPOINT,
            latitude,
            longitude,
            altitude_m,
            params=(0.0, WHEREVER_M, 0.0, 0.0),
        )
        for latitude, longitude in places
    ]


def _turn_radius_m(uav: Motion, point: FloatArray) -> float:
    """Return the radius of the arc from the UAV's course to a point; half the way to one behind."""
    dx, dy = float(point[0]) - uav.x_m, float(point[1]) - uav.y_m
    away = math.hypot(dx, dy)
    angle = wrap_angle(math.atan2(dy, dx) - uav.course_rad)
    if abs(angle) >= math.pi / 2.0:
        return 0.5 * away
    return 0.5 * away / max(abs(math.sin(angle)), 1e-9)


def first_ahead(points: FloatArray, uav: Motion | None, *, margin_m: float = 5.0) -> int:
    """Return the index of the first waypoint the UAV need not turn back for.

    A waypoint is passed when the UAV is beyond the line through it across the direction to the next
    one, and flying that way; or it lies inside the turn towards it, as close as ``TIGHTEST_M``
    allows. Only waypoints from the beginning of the list are skipped.
    """
    if uav is None:
        return 0
    for i in range(len(points) - 1):
        to_next = points[i + 1] - points[i]
        length = float(np.hypot(*to_next))
        if length < 1e-6:
            continue
        direction = to_next / length
        beyond = float((np.array((uav.x_m, uav.y_m)) - points[i]) @ direction)
        course = math.atan2(direction[1], direction[0])
        same_way = math.cos(uav.course_rad - course) > 0.5
        offset = points[i] - (uav.x_m, uav.y_m)
        near = abs(float(direction[0] * offset[1] - direction[1] * offset[0])) < 200.0
        passed = beyond > -margin_m and same_way and near
        if not passed and _turn_radius_m(uav, points[i]) >= TIGHTEST_M:
            return i
    return len(points) - 1
