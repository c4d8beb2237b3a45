"""Where a UAV will be that follows a waypoint list: the monitor's own prediction.

The lateral guidance is ArduPlane's (AP_L1_Control; S. Park et al., AIAA-2004-4900): a lateral
acceleration K V^2 / L1 sin(Nu), K = 4 damping^2, L1 = damping period V / pi. Positions are in the
map frame [m], times in seconds, angles in radians from the x axis, counter-clockwise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from sar_estimator.plane import wrap_angle
from sar_estimator.states import FloatArray, Motion

G_MPS2 = 9.81
STEP_S = 0.5
NEAR_M = 60.0
REACHED_M = 5.0
LEAST_SPEED_MPS = 1.0
ACCEL_MPS2 = 1.0
LEAST_GAP_M = 1e-3
MOST_SINE = 0.7071
HALF_PI = 0.5 * math.pi
TURN_RAD = 2.0 * math.pi

Point = tuple[float, float]
Vector = tuple[float, float]


@dataclass(frozen=True, slots=True)
class FollowerTuning:
    """How the autopilot flies: NAVL1_PERIOD [s], NAVL1_DAMPING, roll limit [deg], loiter [m].

    ``loiter_radius_m``: clockwise above 0. ``turn_share``: turn rate over that of a coordinated
    turn at the same bank. ``roll_lag_s``: from a demand to the bank.
    """

    period_s: float = 6.0
    damping: float = 0.75
    roll_limit_deg: float = 45.0
    loiter_radius_m: float = 80.0
    turn_share: float = 0.8
    roll_lag_s: float = 0.35

    @classmethod
    def read(cls, values: Mapping[str, float]) -> FollowerTuning:
        """Return what an ArduPlane's parameters say, under their newer names; else the defaults.

        An autopilot without NAVL1_PERIOD is taken to fly the waypoints' polygon closely.
        """
        usual = cls()
        found = cls(
            values.get("NAVL1_PERIOD", usual.period_s),
            values.get("NAVL1_DAMPING", usual.damping),
            values.get("ROLL_LIMIT_DEG", usual.roll_limit_deg),
            values.get("WP_LOITER_RAD", usual.loiter_radius_m) or usual.loiter_radius_m,
        )
        sound = found.period_s > 0.0 and found.damping > 0.0 and 0.0 < found.roll_limit_deg < 90.0
        return found if sound and math.isfinite(found.loiter_radius_m) else usual


def places(points: FloatArray) -> list[Point]:
    """Return the rows of an array of points, shape (n, 2) [m]."""
    return [(x, y) for x, y in points.tolist()]


class Route:
    """A waypoint list and how far along it the UAV is."""

    def __init__(self, points: FloatArray, uav: Motion) -> None:
        """Enter a list, shape (n, 2) [m], where it first passes near the UAV; else at its start."""
        self.points = points
        self.places = places(points)
        self._begin = (uav.x_m, uav.y_m)
        self._at = self._entry(uav)
        self.advance(uav)

    @property
    def target(self) -> int:
        """The waypoint being flown to; ``len(points)`` when the list is flown."""
        return self._at

    @property
    def begin(self) -> Point:
        """Where the leg being flown begins [m]."""
        return self._begin

    @cached_property
    def legs(self) -> list[Leg]:
        """The legs from each waypoint to the next."""
        return [Leg(begin, end) for begin, end in pairwise(self.places)]

    def _entry(self, uav: Motion) -> int:
        """Return the waypoint that comes next on the part of the list that passes the UAV."""
        begin, way = self.points[:-1], np.diff(self.points, axis=0)
        here, velocity = np.array((uav.x_m, uav.y_m)), np.array((uav.vx_mps, uav.vy_mps))
        if len(way) == 0 or (self.points[0] - here) @ velocity > 0.0:
            return 0
        lengths = np.maximum(np.hypot(way[:, 0], way[:, 1]), LEAST_GAP_M)
        share = np.clip(((here - begin) * way).sum(axis=1) / lengths**2, 0.0, 1.0)
        off = np.hypot(*(begin + share[:, None] * way - here).T)
        onward = way @ velocity > 0.0
        near = np.flatnonzero((off < NEAR_M) & (share > 0.0) & onward)
        if near.size == 0:
            return 0
        leg = int(near[0])
        while leg + 1 < len(off) and off[leg + 1] < off[leg]:
            leg += 1
        self._begin = (float(begin[leg, 0]), float(begin[leg, 1]))
        return leg + 1

    def advance(self, uav: Motion) -> None:
        """Go on to the waypoint that comes after those that the UAV has passed."""
        while self._at < len(self.points):
            target = self.places[self._at]
            if not (is_passed(self._begin, target, uav.x_m, uav.y_m) or self._on_next(uav)):
                return
            self._begin = target
            self._at += 1

    def _on_next(self, uav: Motion) -> bool:
        """Whether the UAV flies along the leg behind the target already: it was joined there."""
        if self._at + 1 >= len(self.points):
            return False
        (x, y), (next_x, next_y) = self.places[self._at : self._at + 2]
        way_x, way_y, dx, dy = next_x - x, next_y - y, uav.x_m - x, uav.y_m - y
        length = max(math.hypot(way_x, way_y), LEAST_GAP_M)
        onward = (uav.vx_mps * way_x + uav.vy_mps * way_y) / length > 0.5 * uav.speed_mps
        return onward and math.hypot(dx, dy) < NEAR_M and dx * way_x + dy * way_y > 0.0


def is_passed(begin: Point, end: Point, x_m: float, y_m: float) -> bool:
    """Whether a point is beyond a leg's finish line, or at its end."""
    dx, dy = x_m - end[0], y_m - end[1]
    onward = dx * (end[0] - begin[0]) + dy * (end[1] - begin[1])
    return onward >= 0.0 or math.hypot(dx, dy) < REACHED_M


class Leg:
    """The guidance along a line from ``begin`` to ``end`` [m], its direction worked out once."""

    __slots__ = ("_course", "_ux", "_uy", "begin", "end")

    def __init__(self, begin: Point, end: Point) -> None:
        """Work the direction out; without a length the line leads to its end from anywhere."""
        self.begin, self.end = begin, end
        way_x, way_y = end[0] - begin[0], end[1] - begin[1]
        length = math.hypot(way_x, way_y)
        self._course: float | None = None
        if length >= LEAST_GAP_M:
            self._course = math.atan2(way_y, way_x)
            self._ux, self._uy = way_x / length, way_y / length

    def passed(self, x_m: float, y_m: float) -> bool:
        """Whether a point is beyond the finish line, or at the end."""
        return is_passed(self.begin, self.end, x_m, y_m)

    def nu_rad(self, x_m: float, y_m: float, course_rad: float, l1_m: float) -> float:
        """Return the angle Nu from the course to the point L1 ahead on the line."""
        course = self._course
        if course is None:
            course = math.atan2(self.end[1] - y_m, self.end[0] - x_m)
            nu = math.remainder(course - course_rad, TURN_RAD)
        else:
            sine = (self._ux * (y_m - self.begin[1]) - self._uy * (x_m - self.begin[0])) / l1_m
            sine = MOST_SINE if sine > MOST_SINE else max(sine, -MOST_SINE)
            nu = math.remainder(course - course_rad, TURN_RAD) - math.asin(sine)
        return HALF_PI if nu > HALF_PI else max(nu, -HALF_PI)


class Flown:
    """A UAV in flight under the guidance, in steps of ``step_s``; ``x_m``, ``y_m``: where it is."""

    def __init__(
        self,
        uav: Motion,
        tuning: FollowerTuning,
        step_s: float,
        cruise_mps: float | None = None,
        wind_mps: Vector = (0.0, 0.0),
    ) -> None:
        """Begin at the UAV's motion, wings level.

        Its ground speed goes to ``cruise_mps``; without one, it keeps the airspeed that it has in
        the wind that blows to ``wind_mps``.
        """
        self.x_m, self.y_m = uav.x_m, uav.y_m
        self.speed_mps = max(uav.speed_mps, LEAST_SPEED_MPS)
        self._course, self._rate, self._step_s = uav.course_rad, 0.0, step_s
        self._loiter_m = abs(tuning.loiter_radius_m)
        self._loiter_side = -1.0 if tuning.loiter_radius_m > 0.0 else 1.0
        self._lag_share = -math.expm1(-step_s / max(tuning.roll_lag_s, 1e-3))
        self._l1_s = tuning.damping * tuning.period_s / math.pi
        self._gain = 4.0 * tuning.damping**2 * tuning.turn_share / self._l1_s
        self._pull_mps2 = tuning.turn_share * G_MPS2 * math.tan(math.radians(tuning.roll_limit_deg))
        self._cruise_mps = cruise_mps
        self._change = ACCEL_MPS2 * step_s
        self._wind_x, self._wind_y = wind_mps
        air = math.hypot(uav.vx_mps - self._wind_x, uav.vy_mps - self._wind_y)
        self._air2 = max(air, LEAST_SPEED_MPS) ** 2

    def along(self, leg: Leg) -> None:
        """Fly a step along a leg."""
        nu = leg.nu_rad(self.x_m, self.y_m, self._course, self._l1_s * self.speed_mps)
        self._turn(self._gain * math.sin(nu))

    def around(self, centre: Point) -> None:
        """Fly a step onto and along the loiter circle about a point."""
        radius, side = self._loiter_m, self._loiter_side
        out_x, out_y = self.x_m - centre[0], self.y_m - centre[1]
        away = math.hypot(out_x, out_y)
        wanted = math.atan2(out_y, out_x) + side * (HALF_PI + math.atan((away - radius) / radius))
        turned = wrap_angle(wanted - self._course)
        self._turn(side * self.speed_mps / radius + self.speed_mps / radius * turned)

    def straight_on(self) -> None:
        """Fly a step without a demand."""
        self._turn(0.0)

    def _turn(self, wanted: float) -> None:
        speed, rate, change = self.speed_mps, self._rate, self._change
        limit = self._pull_mps2 / speed
        wanted = limit if wanted > limit else max(wanted, -limit)
        rate += self._lag_share * (wanted - rate)
        course = self._course + rate * self._step_s
        ux, uy = math.cos(course), math.sin(course)
        if self._cruise_mps is None:
            along = self._wind_x * ux + self._wind_y * uy
            across = self._wind_y * ux - self._wind_x * uy
            speed = along + math.sqrt(max(self._air2 - across * across, 0.0))
            speed = max(speed, LEAST_SPEED_MPS)
        else:
            more = self._cruise_mps - speed
            speed += change if more > change else max(more, -change)
        run = self._step_s * speed
        self.x_m += run * ux
        self.y_m += run * uy
        self.speed_mps, self._rate, self._course = speed, rate, course


def follow(
    uav: Motion,
    route: Route,
    *,
    tuning: FollowerTuning,
    cruise_mps: float | None,
    wind_mps: Vector = (0.0, 0.0),
    horizon_s: float = 60.0,
) -> FloatArray:
    """Return where the UAV will be, shape (n, 2) [m], every ``STEP_S`` from its own time on.

    Its ground speed goes to ``cruise_mps``, as lists are led, or it keeps its airspeed
    (``Flown``); behind the list it loiters about the last waypoint.
    """
    flown = Flown(uav, tuning, STEP_S, cruise_mps, wind_mps)
    at, last = route.target, len(route.places)
    leg = Leg(route.begin, route.places[at]) if at < last else None
    centre = route.places[-1] if last else (uav.x_m, uav.y_m)
    out = [(uav.x_m, uav.y_m)]
    for _ in range(round(horizon_s / STEP_S)):
        while leg is not None and leg.passed(flown.x_m, flown.y_m):
            at += 1
            leg = route.legs[at - 1] if at < last else None
        if leg is not None:
            flown.along(leg)
        else:
            flown.around(centre)
        out.append((flown.x_m, flown.y_m))
    return np.array(out)
