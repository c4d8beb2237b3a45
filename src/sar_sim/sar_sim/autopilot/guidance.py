"""How a simulated autopilot steers: along a leg, onto a circle, and when it takes the next leg.

``PathFollower`` flies whatever path the waypoints describe: the paper's kinematic model.
``L1Guidance`` is ArduPlane's lateral guidance, with its own rule for leaving a leg.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from sar_bridge.arduplane.l1_kernels import wrapped
from sar_bridge.mavlink.mission_items import WHEREVER_M
from sar_estimator.common.compiled import compiled
from sar_estimator.common.constants import G_MPS2
from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import Motion

Point = tuple[float, float]
PAIR = "UniTuple(f8, 2)"
HALF_TURN = math.pi / 2.0
CAPTURE_SINE = math.sqrt(0.5)
INTEGRATED_RAD = math.radians(5.0)
MOST_INTEGRAL = 0.1
PASSED_S = 3.0
MOST_TURN_RAD = 0.75 * math.pi
MOST_TANGENT = math.tan(0.5 * MOST_TURN_RAD)


@dataclass(frozen=True, slots=True)
class Leg:
    """From a point to a target, and what comes after it.

    ``tracked``: whether the line itself is flown, or only the target headed for. ``accept_m``:
    distance from the target at which it is taken as reached, 0 for the autopilot's own rule.
    """

    begin: Point
    target: Point
    beyond: tuple[Point, ...] = ()
    tracked: bool = True
    accept_m: float = 0.0

    def passed_by(self, motion: Motion) -> bool:
        """Whether the finish line is crossed: through the target, across the leg."""
        (ax, ay), (bx, by) = self.begin, self.target
        dx, dy = bx - ax, by - ay
        return (motion.x_m - bx) * dx + (motion.y_m - by) * dy >= 0.0

    @property
    def turn_rad(self) -> float | None:
        """The turn at the target, 0 or more; None where nothing comes after it."""
        if not self.beyond:
            return None
        after = _course(self.target, self.beyond[0])
        return abs(wrap_angle(after - _course(self.begin, self.target)))


def _course(start: Point, end: Point) -> float:
    """Return the course between points; east where they are the same, as ArduPilot takes it."""
    return math.atan2(end[1] - start[1], end[0] - start[0])


class Guidance(Protocol):
    """What an autopilot steers by. Turn rates in rad/s, positive to the left.

    ``period_s``: between two demands. ``starts_at_target``: whether a leg begun by
    DO_SET_MISSION_CURRENT runs from the old target. ``looks_ahead``: how many points after the
    target it wants to know.
    """

    period_s: float
    starts_at_target: bool
    looks_ahead: int

    def leaves(self, leg: Leg, motion: Motion) -> bool:
        """Whether it is time for the next leg."""

    def along(self, leg: Leg, motion: Motion, airspeed_mps: float) -> float:
        """Return the turn rate demanded on a leg."""

    def around(self, centre: Point, radius_m: float, motion: Motion, airspeed_mps: float) -> float:
        """Return the turn rate demanded for a circle, clockwise for a radius above 0."""


def lookahead_point(points: tuple[Point, ...], here: Point, reach_m: float) -> Point:
    """Return the point ``reach_m`` [m] along a polyline from the foot of ``here`` on its first leg.

    Beyond the end the last leg goes on.
    """
    first = 0
    (ax, ay), (bx, by) = points[0], points[1]
    length = max(1e-9, math.hypot(bx - ax, by - ay))
    at = ((here[0] - ax) * (bx - ax) + (here[1] - ay) * (by - ay)) / length + reach_m
    while at > length and first + 2 < len(points):
        at -= length
        first += 1
        (ax, ay), (bx, by) = points[first], points[first + 1]
        length = max(1e-9, math.hypot(bx - ax, by - ay))
    return ax + (bx - ax) * at / length, ay + (by - ay) * at / length


class PathFollower:
    """Aims at a point a little ahead on the polyline of the waypoints; passes every one of them."""

    period_s = 0.0
    starts_at_target = False
    looks_ahead = 16

    def __init__(self, *, min_radius_m: float, lookahead_m: float, roll_lag_s: float) -> None:
        """Turn no tighter than ``min_radius_m``; aim further ahead the more the roll lags."""
        self._radius_m, self._reach_m, self._lag_s = min_radius_m, lookahead_m, roll_lag_s
        self._side = 0.0

    def leaves(self, leg: Leg, motion: Motion) -> bool:
        """Whether the target is behind, or one that is reached from anywhere."""
        return leg.passed_by(motion) or leg.accept_m >= WHEREVER_M

    def along(self, leg: Leg, motion: Motion, airspeed_mps: float) -> float:
        """Return the turn rate of the arc through the point ahead."""
        reach = max(self._reach_m, 3.0 * self._lag_s * airspeed_mps)
        points = (leg.begin, leg.target, *leg.beyond)
        return self._towards(lookahead_point(points, (motion.x_m, motion.y_m), reach), motion)

    def around(self, centre: Point, radius_m: float, motion: Motion, airspeed_mps: float) -> float:
        """Aim at the circle a little ahead."""
        del airspeed_mps
        (cx, cy), radius = centre, abs(radius_m)
        dx, dy = motion.x_m - cx, motion.y_m - cy
        if math.hypot(dx, dy) > 2.0 * radius:
            return self._towards(centre, motion)
        ahead = math.atan2(dy, dx) - math.copysign(0.4, radius_m)
        point = (cx + radius * math.cos(ahead), cy + radius * math.sin(ahead))
        return self._towards(point, motion)

    def _towards(self, point: Point, motion: Motion) -> float:
        """Turn rate of the arc over ground through a point; behind, as tight as can be.

        A turn for what is behind is ended to the side it was begun to: points straight behind,
        now a little to the left and now to the right, would be turned to for ever.
        """
        dx, dy = point[0] - motion.x_m, point[1] - motion.y_m
        off = wrap_angle(math.atan2(dy, dx) - motion.course_rad)
        if abs(off) > HALF_TURN:
            self._side = self._side or math.copysign(1.0, off)
            return self._side * motion.speed_mps / self._radius_m
        self._side = 0.0
        return 2.0 * motion.speed_mps * math.sin(off) / max(1.0, math.hypot(dx, dy))


@dataclass(frozen=True, slots=True)
class L1Parameters:
    """ArduPlane's parameters of lateral guidance, and the airframe's answer.

    ``period_s`` NAVL1_PERIOD, ``damping`` NAVL1_DAMPING, ``wp_radius_m`` WP_RADIUS,
    ``roll_limit_rad`` ROLL_LIMIT_DEG. ``turn_share``: the turn rate achieved at a bank, over that
    of a coordinated turn. ``believed_radius_m``: where above 0, legs are left early enough for a
    turn of this radius instead of by WP_RADIUS.
    """

    period_s: float = 15.0
    damping: float = 0.75
    wp_radius_m: float = 50.0
    roll_limit_rad: float = math.radians(65.0)
    turn_share: float = 0.79
    believed_radius_m: float = 0.0
    xtrack_gain: float = 0.02

    @property
    def l1_gain(self) -> float:
        """K_L1 = 4 damping^2."""
        return 4.0 * self.damping**2

    def l1_m(self, ground_speed_mps: float) -> float:
        """Return the L1 distance, damping * period * speed / pi [m]."""
        return max(self.damping * self.period_s * ground_speed_mps / math.pi, 0.1)


@compiled(f"{PAIR}({PAIR}, {PAIR}, {PAIR}, {PAIR}, f8, f8, f8)")
def sine_of_nu(
    begin: Point,
    target: Point,
    here: Point,
    velocity: Point,
    reach: float,
    integral: float,
    integrated: float,
) -> tuple[float, float]:
    """Return sin(Nu) on a leg, and the integrated cross-track error [rad]; positions in m.

    ``reach``: the L1 distance [m]; ``integrated``: the share of the angle to the line that is
    added to the integral.
    """
    begin_x, begin_y = begin
    target_x, target_y = target
    x, y = here
    vx, vy = velocity
    speed = math.hypot(vx, vy)
    from_x, from_y = here if begin_x == target_x and begin_y == target_y else begin
    course = math.atan2(target_y - from_y, target_x - from_x)
    ux, uy = math.cos(course), math.sin(course)
    ax, ay = x - begin_x, y - begin_y
    along, off, far = ax * ux + ay * uy, ax * uy - ay * ux, math.hypot(ax, ay)
    if far > reach and along / max(far, 1.0) < -CAPTURE_SINE:
        bearing = math.atan2(-ay, -ax)
    elif along > math.hypot(target_x - begin_x, target_y - begin_y) + PASSED_S * speed:
        bearing = math.atan2(target_y - y, target_x - x)
    else:
        to_line = math.asin(min(max(off / reach, -CAPTURE_SINE), CAPTURE_SINE))
        if abs(to_line) < INTEGRATED_RAD:
            moved = integral + to_line * integrated
            integral = min(max(moved, -MOST_INTEGRAL), MOST_INTEGRAL)
        bearing = course + to_line + integral
    nu = wrapped(bearing - math.atan2(vy, vx))
    return math.sin(min(max(nu, -HALF_TURN), HALF_TURN)), integral


class L1Guidance:
    """ArduPlane's AP_L1_Control, after S. Park, J. Deyst, J. P. How, AIAA-2004-4900.

    The lateral acceleration is K V^2 / L1 sin(Nu), Nu the angle between the velocity and the way to
    a point L1 ahead on the leg.
    """

    period_s = 0.1
    starts_at_target = True
    looks_ahead = 1

    def __init__(self, parameters: L1Parameters) -> None:
        """Begin without an integrated cross-track error."""
        self._p = parameters
        self._l1_gain = parameters.l1_gain
        self._integrated = parameters.xtrack_gain * self.period_s
        self._integral = 0.0

    def leaves(self, leg: Leg, motion: Motion) -> bool:
        """Whether the target is passed, or as near as the turn that comes there wants."""
        if leg.passed_by(motion):
            return True
        left_m = math.hypot(leg.target[0] - motion.x_m, leg.target[1] - motion.y_m)
        if leg.accept_m > 0.0:
            return left_m <= leg.accept_m
        believed_m = self._p.believed_radius_m
        reach = believed_m * MOST_TANGENT
        if believed_m <= 0.0:
            reach = min(self._p.wp_radius_m, self._p.l1_m(motion.speed_mps))
        if left_m > reach:
            return False  # whatever the turn
        turn = leg.turn_rad
        turn = HALF_TURN if turn is None else turn
        if believed_m > 0.0:
            return left_m <= believed_m * math.tan(0.5 * min(turn, MOST_TURN_RAD))
        return left_m <= reach * min(turn / HALF_TURN, 1.0)

    def along(self, leg: Leg, motion: Motion, airspeed_mps: float) -> float:
        """Return the turn rate demanded on a leg."""
        speed, here = motion.speed_mps, (motion.x_m, motion.y_m)
        reach = self._p.l1_m(speed)
        sine, self._integral = sine_of_nu(
            leg.begin if leg.tracked else here,
            leg.target,
            here,
            (motion.vx_mps, motion.vy_mps),
            reach,
            self._integral,
            self._integrated,
        )
        return self._turn_rate(self._l1_gain * speed**2 / reach * sine, airspeed_mps)

    def around(self, centre: Point, radius_m: float, motion: Motion, airspeed_mps: float) -> float:
        """Return the turn rate demanded for a circle: capture it, then hold it (PD)."""
        side = math.copysign(1.0, radius_m)
        radius, speed = abs(radius_m), max(motion.speed_mps, 1.0)
        omega = 2.0 * math.pi / self._p.period_s
        dx, dy = motion.x_m - centre[0], motion.y_m - centre[1]
        far = max(math.hypot(dx, dy), 0.1)
        outward = (motion.vx_mps * dx + motion.vy_mps * dy) / far
        clockwise = (motion.vx_mps * dy - motion.vy_mps * dx) / far
        nu = math.atan2(clockwise, -outward)
        nu = min(max(nu, -HALF_TURN), HALF_TURN)
        capture = self._l1_gain * speed**2 / self._p.l1_m(speed) * math.sin(nu)
        error = far - radius
        correction = error * omega**2 + outward * 2.0 * self._p.damping * omega
        tangent = clockwise * side
        if outward > 0.0 and tangent < 0.0:
            correction = max(correction, 0.0)
        hold = side * (correction + tangent**2 / max(0.5 * radius, far))
        demand = capture if error > 0.0 and side * capture < side * hold else hold
        return self._turn_rate(-demand, airspeed_mps)

    def _turn_rate(self, lateral_mps2: float, airspeed_mps: float) -> float:
        """Return the turn rate that a lateral acceleration, by way of a bank, ends in."""
        limit = self._p.roll_limit_rad
        bank = min(max(math.atan(lateral_mps2 / G_MPS2), -limit), limit)
        return self._p.turn_share * G_MPS2 * math.tan(bank) / airspeed_mps
