"""Ways from a pose onto a circle: straight ahead, a turn, a tangent, and around. Pure geometry."""

from __future__ import annotations

import math
from collections.abc import Iterator

from sar_estimator.common.pose import Pose
from sar_planner.paths.flight_path import Arc, FlightPath, Straight

TWO_PI = 2.0 * math.pi
LEADS_M = (0.0, 200.0, 400.0, 800.0, 1600.0)
LOOPS = (0, 1, 2)
LEFT, RIGHT = 1.0, -1.0


def onto_circle(
    start: Pose,
    centre: tuple[float, float],
    *,
    circle_m: float,
    turn_m: float,
    first: float,
    around: float,
    lead_m: float = 0.0,
    loops: int = 0,
) -> FlightPath | None:
    """Return the way onto a circle of radius ``circle_m`` [m]; None where there is none.

    ``lead_m`` straight on, then a turn of radius ``turn_m`` to the side ``first`` with so many
    whole ``loops`` more, then the straight that leaves it along a tangent and meets the circle
    along one, to be flown to the side ``around`` (1 left, -1 right). On the tangent's heading h a
    circle's point is its centre + s r (sin h, -cos h); that both points lie on one line of that
    heading gives sin(b - h) = (s2 r2 - s1 r1) / D, with the bearing b and distance D of the
    centres.
    """
    pose = start.offset(lead_m)
    side = first * turn_m
    middle = pose.offset(0.0, side)
    dx, dy = centre[0] - middle.x_m, centre[1] - middle.y_m
    apart = math.hypot(dx, dy)
    off = around * circle_m - side
    if apart < abs(off) or apart == 0.0:
        return None
    slope = math.asin(off / apart)
    heading = math.atan2(dy, dx) - slope
    turn = (first * (heading - pose.heading_rad)) % TWO_PI
    if turn > TWO_PI - 1e-9:
        turn = 0.0
    turns = first * (turn + loops * TWO_PI)
    straight = Straight(apart * math.cos(slope))
    return FlightPath.of(start, (Straight(lead_m), Arc(turn_m, turns), straight))


def entries(
    start: Pose, centre: tuple[float, float], *, circle_m: float, turn_m: float
) -> list[tuple[FlightPath, float]]:
    """Return all ways onto a circle with the side to which it is flown, the shortest first."""
    found = list(_entries(start, centre, circle_m=circle_m, turn_m=turn_m))
    return sorted(found, key=lambda one: one[0].length_m)


def _entries(
    start: Pose, centre: tuple[float, float], *, circle_m: float, turn_m: float
) -> Iterator[tuple[FlightPath, float]]:
    for around in (LEFT, RIGHT):
        for first in (LEFT, RIGHT):
            for lead_m in LEADS_M:
                for loops in LOOPS:
                    path = onto_circle(
                        start,
                        centre,
                        circle_m=circle_m,
                        turn_m=turn_m,
                        first=first,
                        around=around,
                        lead_m=lead_m,
                        loops=loops,
                    )
                    if path is not None:
                        yield path, around
