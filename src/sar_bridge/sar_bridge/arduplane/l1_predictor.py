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

from sar_bridge.arduplane import l1_kernels
from sar_bridge.arduplane.l1_kernels import LEAST_GAP_M, LEAST_SPEED_MPS, fly_and_loiter, is_passed
from sar_bridge.arduplane.list_entry import Point, entry_of, places
from sar_estimator.common.constants import G_MPS2
from sar_estimator.common.states import FloatArray, Motion

STEP_S = 0.5
NEAR_M = 60.0
ACCEL_MPS2 = 1.0
MOST_IN_WIND = 3.0

Vector = tuple[float, float]


@dataclass(frozen=True, slots=True)
class FollowerTuning:
    """How the autopilot flies: NAVL1_PERIOD [s], NAVL1_DAMPING, roll limit [deg], loiter [m].

    ``loiter_radius_m``: clockwise above 0. ``turn_share``: turn rate over that of a coordinated
    turn at the same bank. ``roll_lag_s``: from a demand to the bank. ``slowest_mps``,
    ``fastest_mps``: the airspeeds that it flies.
    """

    period_s: float = 6.0
    damping: float = 0.75
    roll_limit_deg: float = 45.0
    loiter_radius_m: float = 80.0
    turn_share: float = 0.8
    roll_lag_s: float = 0.35
    slowest_mps: float = 0.0
    fastest_mps: float = math.inf

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
            slowest_mps=values.get("AIRSPEED_MIN", usual.slowest_mps),
            fastest_mps=values.get("AIRSPEED_MAX", usual.fastest_mps),
        )
        sound = found.period_s > 0.0 and found.damping > 0.0 and 0.0 < found.roll_limit_deg < 90.0
        sound = sound and 0.0 <= found.slowest_mps < found.fastest_mps
        return found if sound and math.isfinite(found.loiter_radius_m) else usual

    def made_good_mps(self, course_rad: float, wanted_mps: float, wind_mps: Vector) -> float:
        """Return what the airspeeds make good of a ground speed on a course, in a wind."""
        ux, uy = math.cos(course_rad), math.sin(course_rad)
        needed = math.hypot(wanted_mps * ux - wind_mps[0], wanted_mps * uy - wind_mps[1])
        airspeed = min(max(needed, self.slowest_mps), self.fastest_mps)
        return float(l1_kernels.over_ground(airspeed, ux, uy, *wind_mps))

    @property
    def pull_mps2(self) -> float:
        """The most lateral acceleration [m/s^2]."""
        return self.turn_share * G_MPS2 * math.tan(math.radians(self.roll_limit_deg))

    def most_mps2(self, wind_mps: Vector = (0.0, 0.0)) -> float:
        """Return the most acceleration over ground, in any direction [m/s^2].

        Across a wind w at an airspeed v the ground speed changes by v / sqrt(v^2 - w^2) times as
        much as in calm air: by that at the slowest, but ``MOST_IN_WIND`` times at the most.
        """
        slower2 = 1.0 - (math.hypot(*wind_mps) / max(self.slowest_mps, LEAST_SPEED_MPS)) ** 2
        share = 1.0 / math.sqrt(slower2) if slower2 > MOST_IN_WIND**-2 else MOST_IN_WIND
        return share * math.hypot(self.pull_mps2, ACCEL_MPS2)


class Route:
    """A waypoint list and how far along it the UAV is.

    ``speed_mps``: the ground speed it is planned with, None where that is not known.
    """

    def __init__(self, points: FloatArray, uav: Motion, *, speed_mps: float | None = None) -> None:
        """Enter a list, shape (n, 2) [m], where it first passes near the UAV; else at its start."""
        self.speed_mps = speed_mps
        self.points = np.ascontiguousarray(points, dtype=np.float64)
        self.places = places(points)
        self._begin, self._at = (uav.x_m, uav.y_m), 0
        if len(points) > 0:
            self._enter(uav)
        self.advance(uav)

    @property
    def target(self) -> int:
        """The waypoint being flown to; ``len(points)`` when the list is flown."""
        return self._at

    @property
    def begin(self) -> Point:
        """Where the leg being flown begins [m]."""
        return self._begin

    def _enter(self, uav: Motion) -> None:
        """Go to the part of the list that passes the UAV, where it has begun to be flown."""
        begin, way = self.points[:-1], np.diff(self.points, axis=0)
        here, velocity = np.array((uav.x_m, uav.y_m)), np.array((uav.vx_mps, uav.vy_mps))
        lengths = np.maximum(np.hypot(way[:, 0], way[:, 1]), LEAST_GAP_M)
        share = np.clip(((here - begin) * way).sum(axis=1) / lengths**2, 0.0, 1.0)
        off = np.hypot(*(begin + share[:, None] * way - here).T)
        onward = way @ velocity > 0.0
        near = np.flatnonzero((off < NEAR_M) & (share > 0.0) & onward)
        if near.size == 0 or (self.points[0] - here) @ velocity > 0.0:
            entry = entry_of(self.points, uav)
            self._at, self._begin = entry.at, entry.begin
            return
        leg = int(near[0])
        while leg + 1 < len(off) and off[leg + 1] < off[leg]:
            leg += 1
        self._at, self._begin = leg + 1, (float(begin[leg, 0]), float(begin[leg, 1]))

    def advance(self, uav: Motion) -> None:
        """Go on to the waypoint that comes after those that the UAV has passed."""
        while self._at < len(self.points):
            target = self.places[self._at]
            passed = is_passed(*self._begin, *target, uav.x_m, uav.y_m)
            if not (passed or self._on_next(uav)):
                return
            self._begin = target
            self._at += 1

    def _on_next(self, uav: Motion) -> bool:
        """Whether the UAV flies along the leg behind the target already: it was joined there."""
        if self._at + 1 >= len(self.points):
            return False
        (x, y), (next_x, next_y) = self.places[self._at : self._at + 2]
        way_x, way_y, dx, dy = next_x - x, next_y - y, uav.x_m - x, uav.y_m - y
        if math.hypot(dx, dy) >= NEAR_M or dx * way_x + dy * way_y <= 0.0:
            return False
        length = max(math.hypot(way_x, way_y), LEAST_GAP_M)
        return (uav.vx_mps * way_x + uav.vy_mps * way_y) / length > 0.5 * uav.speed_mps


def motion_at_end(path: FloatArray, time_s: float) -> Motion:
    """Return the motion at the last but one of a path's positions, shape (n >= 2, 2) [m]."""
    (x, y), (next_x, next_y) = path[-2:].tolist()
    return Motion(time_s, x, y, (next_x - x) / STEP_S, (next_y - y) / STEP_S)


def handling(
    tuning: FollowerTuning,
    step_s: float,
    cruise_mps: float | None = None,
    wind_mps: Vector = (0.0, 0.0),
) -> FloatArray:
    """Return how a UAV answers its guidance, as ``kernels`` takes it.

    Its airspeed goes to what ``cruise_mps`` over ground takes in the wind that blows to
    ``wind_mps``, as far as it flies that; without one, it keeps the airspeed that it has.
    """
    l1_s = tuning.damping * tuning.period_s / math.pi
    given = [0.0] * l1_kernels.HANDLING
    given[l1_kernels.STEP_S] = step_s
    given[l1_kernels.LOITER_M] = abs(tuning.loiter_radius_m)
    given[l1_kernels.LOITER_SIDE] = -1.0 if tuning.loiter_radius_m > 0.0 else 1.0
    given[l1_kernels.LAG_SHARE] = -math.expm1(-step_s / max(tuning.roll_lag_s, 1e-3))
    given[l1_kernels.L1_S] = l1_s
    given[l1_kernels.GAIN] = 4.0 * tuning.damping**2 * tuning.turn_share / l1_s
    given[l1_kernels.PULL_MPS2] = tuning.pull_mps2
    given[l1_kernels.CRUISE_MPS] = math.nan if cruise_mps is None else cruise_mps
    given[l1_kernels.CHANGE_MPS] = ACCEL_MPS2 * step_s
    given[l1_kernels.WIND_X], given[l1_kernels.WIND_Y] = wind_mps
    given[l1_kernels.SLOWEST_MPS] = tuning.slowest_mps
    given[l1_kernels.FASTEST_MPS] = tuning.fastest_mps
    return np.array(given)


def level(uav: Motion, wind_mps: Vector = (0.0, 0.0)) -> FloatArray:
    """Return a UAV's state, wings level, as ``kernels`` takes it."""
    speed = max(uav.speed_mps, LEAST_SPEED_MPS)
    airspeed = math.hypot(uav.vx_mps - wind_mps[0], uav.vy_mps - wind_mps[1])
    airspeed = max(airspeed, LEAST_SPEED_MPS)
    return np.array((uav.x_m, uav.y_m, speed, uav.course_rad, 0.0, airspeed))


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

    Its ground speed goes to ``cruise_mps``, as far as its airspeeds allow, or it keeps its airspeed
    (``handling``); behind the list it loiters about the last waypoint.
    """
    return fly_and_loiter(
        route.points,
        route.target,
        np.array(route.begin),
        level(uav, wind_mps),
        handling(tuning, STEP_S, cruise_mps, wind_mps),
        round(horizon_s / STEP_S),
    )
