"""A UAV under ArduPlane's lateral guidance flown in advance, compiled (``l1_predictor``).

Its state is an array: x, y [m], ground speed [m/s], course [rad], turn rate [rad/s], airspeed
[m/s]. Its handling is an array, in the order of the constants below. Angles counter-clockwise from
the x axis.
"""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_estimator.common.states import FloatArray

REACHED_M = 5.0
LEAST_GAP_M = 1e-3
LEAST_SPEED_MPS = 1.0
MOST_SINE = 0.7071
HALF_PI = 0.5 * math.pi
(
    STEP_S,  # of time [s]
    LOITER_M,  # radius of the loiter [m]
    LOITER_SIDE,  # -1 clockwise
    LAG_SHARE,  # share of a demanded turn rate that is reached in a step
    L1_S,  # L1 distance over ground speed [s]
    GAIN,  # turn rate over sin(Nu) [rad/s]
    PULL_MPS2,  # most lateral acceleration
    CRUISE_MPS,  # ground speed it goes to; NaN where the airspeed is kept
    CHANGE_MPS,  # most change of airspeed in a step
    WIND_X,  # where the wind blows to [m/s]
    WIND_Y,
    SLOWEST_MPS,  # airspeeds that it flies
    FASTEST_MPS,
    HANDLING,  # how many of these there are
) = range(14)
STANDS, LEAVES_LEFT, LEAVES_RIGHT = range(3)


@compiled("float64[:, ::1](float64[::1], f8, f8, f8, f8)")
def straight_on(
    times_s: FloatArray, x_m: float, y_m: float, vx_mps: float, vy_mps: float
) -> FloatArray:
    """Return where it is, shape (n, 2), that keeps its velocity."""
    out = np.empty((times_s.shape[0], 2))
    for i in range(times_s.shape[0]):
        out[i, 0], out[i, 1] = x_m + vx_mps * times_s[i], y_m + vy_mps * times_s[i]
    return out


@compiled("float64[::1](float64[::1], f8, f8, f8, f8)")
def spread(
    times_s: FloatArray, now_m: float, speed_mps: float, accel_mps2: float, ramp_s: float
) -> FloatArray:
    """Return a standard deviation of position, shape (n,) [m], as it grows from ``now_m``.

    By that of the velocity, and of the acceleration while it lasts.
    """
    out = np.empty(times_s.shape[0])
    for i in range(times_s.shape[0]):
        ramp = 0.5 * accel_mps2 * min(times_s[i], ramp_s) ** 2
        out[i] = math.hypot(now_m, math.hypot(speed_mps * times_s[i], ramp))
    return out


@compiled("float64[:,:,::1](float64[::1], f8, f8, f8, f8, f8, f8, f8, f8)")
def stop_and_turn(
    times_s: FloatArray,
    x_m: float,
    y_m: float,
    heading_rad: float,
    in_s: float,
    slowing_mps2: float,
    departing_mps2: float,
    cruise_mps: float,
    turn_rad: float,
) -> FloatArray:
    """Return where it is that comes to a stand, and stays; or turns to a side and departs.

    The stop is at x, y, after ``in_s``. Shape (3, n, 2): ``STANDS``, ``LEAVES_LEFT``,
    ``LEAVES_RIGHT``.
    """
    count = times_s.shape[0]
    out = np.empty((3, count, 2))
    cosine, sine = math.cos(heading_rad), math.sin(heading_rad)
    left, right = heading_rad + turn_rad, heading_rad - turn_rad
    left_x, left_y = math.cos(left), math.sin(left)
    right_x, right_y = math.cos(right), math.sin(right)
    ramp_s = cruise_mps / departing_mps2
    for i in range(count):
        left_s = max(in_s - times_s[i], 0.0)
        back = 0.5 * slowing_mps2 * left_s**2
        stand_x, stand_y = x_m - back * cosine, y_m - back * sine
        since = max(times_s[i] - in_s, 0.0)
        ramp = min(since, ramp_s)
        run = 0.5 * departing_mps2 * ramp**2 + cruise_mps * (since - ramp)
        out[STANDS, i, 0], out[STANDS, i, 1] = stand_x, stand_y
        out[LEAVES_LEFT, i, 0] = stand_x + run * left_x
        out[LEAVES_LEFT, i, 1] = stand_y + run * left_y
        out[LEAVES_RIGHT, i, 0] = stand_x + run * right_x
        out[LEAVES_RIGHT, i, 1] = stand_y + run * right_y
    return out


@compiled("float64(float64)")
def wrapped(angle_rad: float) -> float:
    """Return an angle within -pi and pi."""
    return angle_rad - 2.0 * math.pi * math.floor(angle_rad / (2.0 * math.pi) + 0.5)


@compiled("boolean(float64, float64, float64, float64, float64, float64)")
def is_passed(
    begin_x: float, begin_y: float, end_x: float, end_y: float, x: float, y: float
) -> bool:
    """Whether a point [m] is beyond a leg's finish line, or at its end."""
    dx, dy = x - end_x, y - end_y
    onward = dx * (end_x - begin_x) + dy * (end_y - begin_y)
    return onward >= 0.0 or math.hypot(dx, dy) < REACHED_M


@compiled(
    "Tuple((float64[::1], float64[::1]))(float64[:, ::1], float64[:, :], float64[::1], f8, f8)"
)
def apart(
    path: FloatArray, positions: FloatArray, sigma: FloatArray, beside: float, bulge_m: float
) -> tuple[FloatArray, FloatArray]:
    """Return how near a path comes to positions of the same times, and how sure that is [m].

    In the step that ends at each time; the first is the distance at the first time. Within a step
    the gap goes along a straight, or no more than ``bulge_m`` beside it. Shapes (n, 2), (n or more,
    2), (n or more,); ``beside``: the standard deviation of the path.
    """
    count = path.shape[0]
    distance, deviation = np.empty(count), np.empty(count)
    before_x = before_y = 0.0
    for i in range(count):
        x, y = path[i, 0] - positions[i, 0], path[i, 1] - positions[i, 1]
        deviation[i] = math.hypot(sigma[i], beside)
        distance[i] = math.hypot(x, y)
        if i > 0:
            way_x, way_y = x - before_x, y - before_y
            way2 = way_x * way_x + way_y * way_y
            # How far back along the step the gap is the least, as a share of it.
            back = (x * way_x + y * way_y) / way2 if way2 > 0.0 else 0.0
            back = min(max(back, 0.0), 1.0)
            least = math.hypot(x - back * way_x, y - back * way_y)
            distance[i] = max(least - bulge_m, 0.0)
        before_x, before_y = x, y
    return distance, deviation


@compiled("Tuple((f8, int64))(float64[::1], float64[::1], f8, int64)")
def closest(
    distance: FloatArray, sigma: FloatArray, sigmas: float, count: int
) -> tuple[float, int]:
    """Return the least of the first ``count`` distances, ``sigmas`` deviations added, and where."""
    least, where = math.inf, 0
    for i in range(min(count, distance.shape[0])):
        bound = distance[i] + sigmas * sigma[i]
        if bound < least:
            least, where = bound, i
    return least, where


@compiled("float64(float64, float64, float64, float64, float64)")
def over_ground(airspeed_mps: float, ux: float, uy: float, wind_x: float, wind_y: float) -> float:
    """Return the ground speed [m/s] on a course of direction ux, uy that an airspeed gives."""
    along = wind_x * ux + wind_y * uy
    across = wind_y * ux - wind_x * uy
    speed = along + math.sqrt(max(airspeed_mps * airspeed_mps - across * across, 0.0))
    return max(speed, LEAST_SPEED_MPS)


@compiled("void(float64[::1], float64[::1], float64)")
def turn(state: FloatArray, handling: FloatArray, wanted_radps: float) -> None:
    """Fly a step with a demanded turn rate."""
    speed, rate = state[2], state[4]
    limit = handling[PULL_MPS2] / speed
    wanted = min(max(wanted_radps, -limit), limit)
    rate += handling[LAG_SHARE] * (wanted - rate)
    course = state[3] + rate * handling[STEP_S]
    ux, uy = math.cos(course), math.sin(course)
    if not math.isnan(handling[CRUISE_MPS]):
        needed = math.hypot(
            handling[CRUISE_MPS] * ux - handling[WIND_X],
            handling[CRUISE_MPS] * uy - handling[WIND_Y],
        )
        needed = min(max(needed, handling[SLOWEST_MPS]), handling[FASTEST_MPS])
        change = handling[CHANGE_MPS]
        state[5] += min(max(needed - state[5], -change), change)
    speed = over_ground(state[5], ux, uy, handling[WIND_X], handling[WIND_Y])
    run = handling[STEP_S] * speed
    state[0] += run * ux
    state[1] += run * uy
    state[2], state[3], state[4] = speed, course, rate


@compiled("void(float64[::1], float64[::1], float64, float64, float64, float64)")
def along(
    state: FloatArray,
    handling: FloatArray,
    begin_x: float,
    begin_y: float,
    end_x: float,
    end_y: float,
) -> None:
    """Fly a step along a line; without a length it leads to its end from anywhere.

    Nu is the angle from the course to the point L1 ahead on the line.
    """
    way_x, way_y = end_x - begin_x, end_y - begin_y
    length = math.hypot(way_x, way_y)
    if length < LEAST_GAP_M:
        nu = wrapped(math.atan2(end_y - state[1], end_x - state[0]) - state[3])
    else:
        off = (way_x * (state[1] - begin_y) - way_y * (state[0] - begin_x)) / length
        sine = min(max(off / (handling[L1_S] * state[2]), -MOST_SINE), MOST_SINE)
        nu = wrapped(math.atan2(way_y, way_x) - state[3]) - math.asin(sine)
    turn(state, handling, handling[GAIN] * math.sin(min(max(nu, -HALF_PI), HALF_PI)))


@compiled("void(float64[::1], float64[::1], float64, float64)")
def around(state: FloatArray, handling: FloatArray, centre_x: float, centre_y: float) -> None:
    """Fly a step onto and along the loiter circle about a point."""
    radius, side = handling[LOITER_M], handling[LOITER_SIDE]
    out_x, out_y = state[0] - centre_x, state[1] - centre_y
    away = math.hypot(out_x, out_y)
    wanted = math.atan2(out_y, out_x) + side * (HALF_PI + math.atan((away - radius) / radius))
    turned = wrapped(wanted - state[3])
    turn(state, handling, state[2] / radius * (side + turned))


@compiled(
    "float64[:, ::1](float64[:, ::1], int64, float64[::1], float64[::1], float64[::1], int64)"
)
def fly_and_loiter(
    points: FloatArray,
    at: int,
    begin: FloatArray,
    state: FloatArray,
    handling: FloatArray,
    steps: int,
) -> FloatArray:
    """Return where it comes, shape (steps + 1, 2), that flies to waypoint ``at`` from ``begin``.

    Behind the list it loiters about the last one; without any, about where it was. ``begin`` and
    ``state`` are used up.
    """
    out = np.empty((steps + 1, 2))
    count = points.shape[0]
    out[0] = state[:2]
    centre_x, centre_y = state[0], state[1]
    if count:
        centre_x, centre_y = points[count - 1, 0], points[count - 1, 1]
    for i in range(steps):
        while at < count and is_passed(
            begin[0], begin[1], points[at, 0], points[at, 1], state[0], state[1]
        ):
            begin[:] = points[at]
            at += 1
        if at < count:
            along(state, handling, begin[0], begin[1], points[at, 0], points[at, 1])
        else:
            around(state, handling, centre_x, centre_y)
        out[i + 1] = state[:2]
    return out


@compiled("float64[:, ::1](float64[:, ::1], float64[::1], float64[::1], float64[::1], int64)")
def fly_in(
    points: FloatArray, begin: FloatArray, state: FloatArray, handling: FloatArray, steps: int
) -> FloatArray:
    """Return where it comes, shape (steps, 2), that flies a list, and straight on behind.

    A leg whose finish line is behind when it begins, begins where the UAV is. ``begin`` and
    ``state`` are used up.
    """
    out = np.empty((steps, 2))
    count, at = points.shape[0], 0
    for i in range(steps):
        if at < count and is_passed(
            begin[0], begin[1], points[at, 0], points[at, 1], state[0], state[1]
        ):
            begin[:] = points[at]
            at += 1
            if at < count and is_passed(
                begin[0], begin[1], points[at, 0], points[at, 1], state[0], state[1]
            ):
                begin[:] = state[:2]
        if at >= count:
            turn(state, handling, 0.0)
        else:
            along(state, handling, begin[0], begin[1], points[at, 0], points[at, 1])
        out[i] = state[:2]
    return out
