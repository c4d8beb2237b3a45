"""Where a UAV will be that follows a waypoint list: the monitor's own prediction.

The lateral guidance is ArduPlane's (AP_L1_Control; S. Park et al., AIAA-2004-4900): a lateral
acceleration K V^2 / L1 sin(Nu), K = 4 damping^2, L1 = damping period V / pi. Positions are in the
map frame [m], times in seconds, angles in radians from the x axis, counter-clockwise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

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

    def fastest_turn_radps(self, speed_mps: float) -> float:
        """Return the turn rate that the roll limit allows."""
        pull = self.turn_share * G_MPS2 * math.tan(math.radians(self.roll_limit_deg))
        return pull / speed_mps


class Route:
    """A waypoint list and how far along it the UAV is."""

    def __init__(self, points: FloatArray, uav: Motion) -> None:
        """Enter a list, shape (n, 2) [m], where it first passes near the UAV; else at its start."""
        self.points = points
        self._begin = (uav.x_m, uav.y_m)
        self._at = self._entry(uav)
        self.advance(uav)

    @property
    def target(self) -> int:
        """The waypoint being flown to; ``len(points)`` when the list is flown."""
        return self._at

    @property
    def begin(self) -> tuple[float, float]:
        """Where the leg being flown begins [m]."""
        return self._begin

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
            x, y = (float(value) for value in self.points[self._at])
            if not (is_passed(self._begin, (x, y), uav.x_m, uav.y_m) or self._on_next(uav)):
                return
            self._begin = (x, y)
            self._at += 1

    def _on_next(self, uav: Motion) -> bool:
        """Whether the UAV flies along the leg behind the target already: it was joined there."""
        if self._at + 1 >= len(self.points):
            return False
        way = self.points[self._at + 1] - self.points[self._at]
        length = max(float(np.hypot(*way)), LEAST_GAP_M)
        dx, dy = uav.x_m - self.points[self._at, 0], uav.y_m - self.points[self._at, 1]
        onward = (uav.vx_mps * way[0] + uav.vy_mps * way[1]) / length > 0.5 * uav.speed_mps
        near = math.hypot(dx, dy) < NEAR_M
        return bool(onward and near and dx * way[0] + dy * way[1] > 0.0)


def is_passed(begin: tuple[float, float], end: tuple[float, float], x_m: float, y_m: float) -> bool:
    """Whether a point is beyond a leg's finish line, or at its end."""
    dx, dy = x_m - end[0], y_m - end[1]
    onward = dx * (end[0] - begin[0]) + dy * (end[1] - begin[1])
    return onward >= 0.0 or math.hypot(dx, dy) < REACHED_M


def follow(
    uav: Motion,
    route: Route,
    *,
    tuning: FollowerTuning,
    cruise_mps: float,
    horizon_s: float = 60.0,
) -> FloatArray:
    """Return where the UAV will be, shape (n, 2) [m], every ``STEP_S`` from its own time on.

    Its ground speed goes to ``cruise_mps``, as lists are led; behind the list it loiters about the
    last waypoint.
    """
    x, y = uav.x_m, uav.y_m
    speed, course, rate = max(uav.speed_mps, LEAST_SPEED_MPS), uav.course_rad, 0.0
    lag_share = -math.expm1(-STEP_S / max(tuning.roll_lag_s, 1e-3))
    change = ACCEL_MPS2 * STEP_S
    points = [(float(px), float(py)) for px, py in route.points]
    at, begin = route.target, route.begin
    count = round(horizon_s / STEP_S)
    out = np.empty((count + 1, 2))
    out[0] = x, y
    for i in range(1, count + 1):
        while at < len(points) and is_passed(begin, points[at], x, y):
            begin, at = points[at], at + 1
        if at < len(points):
            demand = demanded_turn_rate(begin, points[at], (x, y), course, speed, tuning)
        else:
            centre = points[-1] if points else (x, y)
            demand = _around(centre, (x, y), course, speed, tuning)
        limit = tuning.fastest_turn_radps(speed)
        rate += lag_share * (min(max(demand, -limit), limit) - rate)
        course += rate * STEP_S
        speed += min(max(cruise_mps - speed, -change), change)
        x += STEP_S * speed * math.cos(course)
        y += STEP_S * speed * math.sin(course)
        out[i] = x, y
    return out


def demanded_turn_rate(
    begin: tuple[float, float],
    end: tuple[float, float],
    here: tuple[float, float],
    course: float,
    speed: float,
    tuning: FollowerTuning,
) -> float:
    """Return the turn rate that the guidance demands on a leg [rad/s]."""
    way_x, way_y = end[0] - begin[0], end[1] - begin[1]
    length = math.hypot(way_x, way_y)
    if length < LEAST_GAP_M:
        way_x, way_y = end[0] - here[0], end[1] - here[1]
        length = max(math.hypot(way_x, way_y), LEAST_GAP_M)
    l1_m = tuning.damping * tuning.period_s * speed / math.pi
    left = (way_x * (here[1] - begin[1]) - way_y * (here[0] - begin[0])) / length
    turned = wrap_angle(math.atan2(way_y, way_x) - course)
    nu = turned - math.asin(min(max(left / l1_m, -0.7071), 0.7071))
    nu = min(max(nu, -0.5 * math.pi), 0.5 * math.pi)
    return 4.0 * tuning.damping**2 * tuning.turn_share * speed / l1_m * math.sin(nu)


def _around(
    centre: tuple[float, float],
    here: tuple[float, float],
    course: float,
    speed: float,
    tuning: FollowerTuning,
) -> float:
    """Return the turn rate onto and along a loiter circle [rad/s]."""
    radius = abs(tuning.loiter_radius_m)
    side = -1.0 if tuning.loiter_radius_m > 0.0 else 1.0
    out_x, out_y = here[0] - centre[0], here[1] - centre[1]
    away = math.hypot(out_x, out_y)
    wanted = math.atan2(out_y, out_x) + side * (0.5 * math.pi + math.atan((away - radius) / radius))
    turned = wrap_angle(wanted - course)
    return side * speed / radius + speed / radius * turned
