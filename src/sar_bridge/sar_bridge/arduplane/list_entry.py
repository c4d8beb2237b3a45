"""Where a UAV enters a waypoint list: on which leg it is, and where that leg begins."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sar_bridge.mavlink.mission_items import first_ahead
from sar_estimator.common.states import FloatArray, Motion

NEAR_M = 60.0
FLOWN_M = 200.0  # with the slowest radio, while a list is on its way
SHORT_M = 10.0  # a leg that is shorter is no line to follow
LEFT_M = 12.0  # ArduPlane turns back for a waypoint that is passed when its leg begins
SAME_WAY = math.cos(math.radians(60.0))

Point = tuple[float, float]


def places(points: FloatArray) -> list[Point]:
    """Return the rows of an array of points, shape (n, 2) [m]."""
    return [(x, y) for x, y in points.tolist()]


@dataclass(frozen=True, slots=True)
class Entry:
    """The waypoint of a list to fly to, and where the leg to it begins [m]."""

    at: int
    begin: Point


def entry_of(points: FloatArray, uav: Motion) -> Entry:
    """Return where a UAV enters a list, shape (n, 2) [m]: on the leg that it is abeam of.

    Or on the next one, where that begins within ``LEFT_M``. Lists begin near the UAV, where a leg
    of theirs does. While that is ahead, the UAV flies up to it beside, as far aside as it is. To a
    list that begins elsewhere it flies straight.
    """
    here, listed = (uav.x_m, uav.y_m), places(points)
    at = 0
    while at + 1 < len(listed) and _passed(listed, at, uav):
        at += 1
    if at > 0:
        return Entry(at, listed[at - 1])
    if math.dist(here, listed[0]) >= NEAR_M or len(listed) == 1:
        return Entry(first_ahead(points, uav), here)
    ux, uy = math.cos(uav.course_rad), math.sin(uav.course_rad)
    ahead_m = (listed[0][0] - uav.x_m) * ux + (listed[0][1] - uav.y_m) * uy
    if ahead_m < SHORT_M:
        return Entry(1, listed[0])
    return Entry(0, (listed[0][0] - ahead_m * ux, listed[0][1] - ahead_m * uy))


def _passed(listed: list[Point], at: int, uav: Motion) -> bool:
    """Whether a waypoint lies behind a UAV that flies a list: of its first, by the leg after it."""
    (x, y), here = listed[at], (uav.x_m, uav.y_m)
    if at > 0:
        begin_x, begin_y = listed[at - 1]
        length = math.dist(listed[at - 1], listed[at])
        onward = (here[0] - x) * (x - begin_x) + (here[1] - y) * (y - begin_y)
        return onward > -LEFT_M * length
    way_x, way_y = listed[1][0] - x, listed[1][1] - y
    onward = (here[0] - x) * way_x + (here[1] - y) * way_y
    same_way = uav.vx_mps * way_x + uav.vy_mps * way_y
    length = max(math.hypot(way_x, way_y), 1e-9)
    near = math.dist(here, listed[0]) < FLOWN_M
    return onward >= 0.0 and near and same_way >= SAME_WAY * length * uav.speed_mps
