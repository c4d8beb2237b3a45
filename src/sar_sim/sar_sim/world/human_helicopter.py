"""A helicopter that a human flies: he wanders, brakes unevenly, and turns as he likes.

Two parts are added. The *reference* is what he means to fly: legs, and corners in which he slows
down unevenly and then stops and yaws, passes slowly, or rolls (turns without a stop). The *wander*
is by how much he is beside it: a second-order Gauss-Markov process on each axis, driven along his
leg and across it by what ``Pilot`` says, less where he is slow.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_estimator.common.constants import G_MPS2
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import FloatArray, Motion
from sar_planner.patterns.legs import RIGHT_ANGLE_RAD, Leg
from sar_sim.scenario.scenario import Pattern, Pilot
from sar_sim.world.helicopter import (
    BROKEN_OFF_FACTOR,
    BROKEN_OFF_RAD,
    BROKEN_OFF_S,
    CornerTruth,
    Helicopter,
    PatternHelicopter,
    flown_legs,
    turned_rad,
)
from sar_sim.world.sampled_motion import STEP_S, SampledMotion

WOBBLE_S = 1.5
LEAST_ACCEL_MPS2 = 0.5
EASE_S = 1.5
EASE_TURN_S = 1.0
LEAST_WANDER_SHARE = 0.15
SHORTEST_CRUISE_S = 2.0
AT_ONCE_RAD_S = 1e3
FARTHEST_STEPS = 3000


class _Corner(NamedTuple):
    """How one corner is flown: drawn from the pilot's habits. ``turn_rad``: left is positive."""

    accel_mps2: float
    buildup_s: float
    leaving_mps2: float
    through_mps: float
    hover_s: float
    turn_rad: float
    wobble: FloatArray


class _Series(NamedTuple):
    """Speeds [m/s] and course changes [rad] of every step, each of shape (n,)."""

    speeds: FloatArray
    turns: FloatArray


@compiled("float64[::1](float64, float64, float64, float64, float64, float64[::1])")
def slowing(
    from_mps: float,
    to_mps: float,
    accel_mps2: float,
    buildup_s: float,
    flare_mps: float,
    wobble: FloatArray,
) -> FloatArray:
    """Return the speeds after every step of a slow-down, shape (n,) [m/s].

    ``buildup_s``: in which the deceleration builds up, 0 for at once. Below ``flare_mps`` above
    ``to_mps`` it is eased off. ``wobble``: share by which it varies, step by step.
    """
    out = np.empty(FARTHEST_STEPS)
    speed, accel, n = from_mps, 0.0 if buildup_s > 0.0 else accel_mps2, 0
    while n < FARTHEST_STEPS - 1:
        wanted = accel_mps2 * (1.0 + wobble[n % wobble.size])
        if flare_mps > 0.0 and speed - to_mps < flare_mps:
            wanted = max(LEAST_ACCEL_MPS2, wanted * (speed - to_mps) / flare_mps)
        if buildup_s > 0.0:
            most = accel_mps2 / buildup_s * STEP_S
            accel += min(max(wanted - accel, -most), most)
        else:
            accel = wanted
        speed -= accel * STEP_S
        if speed <= to_mps:
            break
        out[n] = speed
        n += 1
    out[n] = to_mps
    return out[: n + 1].copy()


@compiled(
    "Tuple((float64[::1], float64[::1]))(float64, float64, float64, float64, float64, float64,"
    " float64, float64, float64)"
)
def turning(
    through_mps: float,
    to_mps: float,
    hover_s: float,
    turn_rad: float,
    yaw_rate: float,
    turn_accel_mps2: float,
    accel_mps2: float,
    buildup_s: float,
    leave_early_rad: float,
) -> tuple[FloatArray, FloatArray]:
    """Return speeds and course changes of a corner from its slowest moment back to cruise.

    The course changes with ``yaw_rate`` [rad/s] at most, and with ``turn_accel_mps2`` across at
    most; he speeds up once no more than ``leave_early_rad`` is left of the turn.
    """
    speeds, turns = np.empty(FARTHEST_STEPS), np.empty(FARTHEST_STEPS)
    left, rate, speed, accel = abs(turn_rad), 0.0, through_mps, 0.0
    side = 1.0 if turn_rad > 0.0 else -1.0
    n = 0
    hovering = round(hover_s / STEP_S)
    while n < FARTHEST_STEPS:
        turned = 0.0
        if n >= hovering:
            most = min(yaw_rate, turn_accel_mps2 / max(speed, 0.1))
            if buildup_s > 0.0:
                eased = max(0.05, left / EASE_TURN_S)
                rate = min(most, rate + most * STEP_S / EASE_TURN_S, eased)
            else:
                rate = most
            turned = min(left, rate * STEP_S)
            left -= turned
            if left <= leave_early_rad + 1e-9:
                wanted = accel_mps2
                if buildup_s > 0.0:
                    wanted = min(wanted, max(LEAST_ACCEL_MPS2, (to_mps - speed) / EASE_S))
                    accel = min(wanted, accel + accel_mps2 / buildup_s * STEP_S)
                else:
                    accel = wanted
                speed = min(to_mps, speed + accel * STEP_S)
        speeds[n], turns[n] = speed, side * turned
        n += 1
        if left <= 0.0 and speed >= to_mps:
            break
    return speeds[:n].copy(), turns[:n].copy()


@compiled(
    "float64[:, ::1](float64[:, ::1], float64[:, ::1], float64[::1], float64[::1], float64[:, ::1],"
    " float64[::1])"
)
def wander(
    noise: FloatArray,
    gusts: FloatArray,
    courses_rad: FloatArray,
    shares: FloatArray,
    begin: FloatArray,
    settings: FloatArray,
) -> FloatArray:
    """Return offsets and their velocities, shape (n, 4): x, y [m], vx, vy [m/s].

    o'' = -o / T^2 - 2 z o' / T + w, with the spectral density of w so that the velocity's rms is
    what it shall be: S = 4 z v^2 / T (Gelb 1974, section 3.8). ``noise``, ``gusts``: standard
    normal, shape (n, 2); ``courses_rad``: of the leg; ``shares``: of the wander, by speed;
    ``begin``: offset and velocity, shape (2, 2). ``settings``: rms velocity along and across, T, z,
    rms of gusts and their time.
    """
    along, across, time_s, damping, gust, gust_time_s = settings
    out = np.empty((noise.shape[0], 4))
    x, y = begin[0, 0], begin[0, 1]
    vx, vy = begin[1, 0], begin[1, 1]
    gx = gy = 0.0
    kept = math.exp(-STEP_S / gust_time_s)
    fresh = gust * math.sqrt(1.0 - kept * kept)
    per_step = math.sqrt(4.0 * damping / time_s * STEP_S)
    for i in range(noise.shape[0]):
        c, s = math.cos(courses_rad[i]), math.sin(courses_rad[i])
        a = along * per_step * noise[i, 0] * shares[i]
        b = across * per_step * noise[i, 1] * shares[i]
        gx, gy = kept * gx + fresh * gusts[i, 0], kept * gy + fresh * gusts[i, 1]
        vx += a * c - b * s + STEP_S * (gx - x / time_s**2 - 2.0 * damping * vx / time_s)
        vy += a * s + b * c + STEP_S * (gy - y / time_s**2 - 2.0 * damping * vy / time_s)
        x, y = x + STEP_S * vx, y + STEP_S * vy
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = x, y, vx, vy
    return out


def wandered(
    pilot: Pilot,
    rng: np.random.Generator,
    courses_rad: FloatArray,
    shares: FloatArray,
    begin: FloatArray,
) -> FloatArray:
    """Return a pilot's wander of every step, as ``wander`` has it.

    ``shares``: of his cruise speed, shape (n,); ``begin``: offset and velocity, shape (2, 2).
    """
    noise = rng.standard_normal((2, courses_rad.size, 2))
    axes = pilot.wander_along_mps, pilot.wander_across_mps
    settings = np.array(
        [*axes, pilot.wander_time_s, pilot.wander_damping, pilot.gust_mps2, pilot.gust_time_s]
    )
    shares = np.clip(shares, LEAST_WANDER_SHARE, 1.0)
    return wander(noise[0], noise[1], courses_rad, shares, begin, settings)


class HumanHelicopter:
    """The helicopter on its pattern, flown by a human; begins at time 0 at cruise speed.

    ``corners``: the corners as flown; of one that is passed or rolled the acceleration is that of a
    stop which would cost as much time. ``end_s``: when the last leg is flown. Raises ``ValueError``
    when a leg is too short to reach cruise speed and slow again.
    """

    def __init__(self, pattern: Pattern, pilot: Pilot, speed_mps: float, accel_mps2: float) -> None:
        """Fly it; everything is drawn from the pilot's seed."""
        self._pilot, self._speed, self._accel = pilot, speed_mps, accel_mps2
        self._rng = np.random.default_rng([pilot.seed, 3])
        self._parts: list[_Series] = []
        self._courses: list[float] = []
        self._count = 0
        self.start = pattern.start
        marks = self._fly(flown_legs(pattern))
        self._lay(marks)

    # The reference -----------------------------------------------------------------------------

    def _draw(self, nominal_rad: float, *, odd: str) -> _Corner:
        """Return how the next corner is flown, which turns by ``nominal_rad`` in the pattern."""
        pilot, rng = self._pilot, self._rng
        kinds, spread, through = rng.uniform(size=3), rng.standard_normal(2), rng.uniform(-1.0, 1.0)
        accels = self._accel * np.exp(pilot.accel_spread * spread)
        if pilot.kind != "robot":
            accels = np.clip(accels, pilot.accel_low_mps2, pilot.accel_high_mps2)
        speed = 0.0
        if kinds[0] < pilot.roll_share:
            speed = pilot.roll_mps + pilot.roll_spread_mps * through
        elif kinds[1] < pilot.pass_share:
            speed = pilot.pass_mps
        turn = turned_rad(nominal_rad, pilot.turn_spread_deg * rng.uniform(-1.0, 1.0))
        if odd == "other_way":
            turn = -turn
        if odd == "break_off":
            turn = math.copysign(BROKEN_OFF_RAD, nominal_rad)
        hover = pilot.hover_s + pilot.hover_spread_s * rng.uniform()
        kept = math.exp(-STEP_S / WOBBLE_S)
        drawn = rng.standard_normal(300)
        wobble, value = np.empty(300), 0.0
        for i, fresh in enumerate(drawn.tolist()):
            value = kept * value + math.sqrt(1.0 - kept * kept) * fresh
            wobble[i] = pilot.accel_wobble * min(max(value, -2.0), 2.0)
        return _Corner(
            float(accels[0]),
            pilot.buildup_s * float(rng.uniform(2.0 / 3.0, 4.0 / 3.0)),
            float(accels[1]),
            speed,
            0.0 if speed > 0.0 else hover,
            turn,
            wobble,
        )

    def _fly(self, legs: list[Leg]) -> list[tuple[int, int, float]]:
        """Fly every leg; return each corner's steps of onset and end, and the speed before it."""
        pilot, rng = self._pilot, self._rng
        marks = []
        left_out, speed, error = 0.0, self._speed, 0.0
        for i, (length, nominal) in enumerate(legs):
            k, last = i + 1, i == len(legs) - 1
            odd = pilot.anomaly if k == pilot.anomaly_corner else ""
            if i == 0:
                speed = self._speed + pilot.speed_sigma_mps * float(rng.standard_normal())
            end_speed = speed + pilot.speed_drift_mps * float(rng.uniform(-1.0, 1.0))
            shift = pilot.corner_sigma_m * float(rng.standard_normal())
            next_error = math.radians(pilot.heading_sigma_deg * float(rng.standard_normal()))
            next_speed = self._speed + pilot.speed_sigma_mps * float(rng.standard_normal())
            # After the last leg there is none, but it is drawn all the same.
            corner = self._draw(nominal or RIGHT_ANGLE_RAD, odd=odd)
            if odd == "break_off":
                next_speed = BROKEN_OFF_FACTOR * self._speed
            slow, out, spent, begun = self._corner(corner, end_speed, next_speed, next_error, error)
            cruise = length - left_out + (0.0 if last else shift - spent)
            if cruise < SHORTEST_CRUISE_S * speed:
                raise ValueError(
                    f"leg {k} of {length:.0f} m: expected at least {length - cruise:.0f} m "
                    "to reach cruise speed and slow again"
                )
            if odd == "go_on":
                cruise = self._slow_and_go_on(cruise, speed)
            self._cruise(cruise, speed, end_speed)
            if last:
                break
            onset = self._count
            self._add(slow)
            self._add(out)
            marks.append((onset, self._count, end_speed))
            if odd == "break_off":
                self._cruise(BROKEN_OFF_S * next_speed, next_speed, next_speed)
                break
            left_out, speed, error = begun, next_speed, next_error
        return marks

    def _corner(
        self, corner: _Corner, speed: float, next_speed: float, next_error: float, error: float
    ) -> tuple[_Series, _Series, float, float]:
        """Return a corner's steps, and what of the old and of the new leg it takes [m]."""
        pilot = self._pilot
        speeds = slowing(
            speed,
            corner.through_mps,
            corner.accel_mps2,
            corner.buildup_s,
            pilot.flare_mps,
            corner.wobble,
        )
        slow = _Series(speeds, np.zeros(speeds.size))
        turn = corner.turn_rad + next_error - error
        yaw = math.radians(pilot.yaw_rate_dps) if pilot.yaw_rate_dps > 0.0 else AT_ONCE_RAD_S
        banked = G_MPS2 * math.tan(math.radians(pilot.bank_deg))
        if corner.through_mps > pilot.pass_mps:
            yaw = AT_ONCE_RAD_S
        leave = math.radians(pilot.leave_early_deg)
        out = _Series(
            *turning(
                *(corner.through_mps, next_speed, corner.hover_s, turn, yaw, banked),
                *(corner.leaving_mps2, corner.buildup_s, leave),
            )
        )
        courses = _courses(out.turns)
        x, y = float(np.cos(courses) @ out.speeds), float(np.sin(courses) @ out.speeds)
        on_new = STEP_S * y / math.sin(turn)
        on_old = STEP_S * x - on_new * math.cos(turn)
        return slow, out, STEP_S * float(speeds.sum()) + on_old, on_new

    def _slow_and_go_on(self, cruise_m: float, speed_mps: float) -> float:
        """Fly half of a leg, slow to a third, speed up again; return what is left of it [m]."""
        low, half = speed_mps / 3.0, 0.5 * cruise_m
        self._cruise(half, speed_mps, speed_mps)
        ramp = slowing(speed_mps, low, self._accel, self._pilot.buildup_s, 0.0, np.zeros(1))
        self._add(_Series(ramp, np.zeros(ramp.size)))
        self._add(_Series(np.append(ramp[-2::-1], speed_mps), np.zeros(ramp.size)))
        return max(speed_mps, half - 2.0 * STEP_S * float(ramp.sum()))

    def _cruise(self, length_m: float, speed_mps: float, end_mps: float) -> None:
        steps = max(1, round(2.0 * length_m / (speed_mps + end_mps) / STEP_S))
        share = (np.arange(steps) + 0.5) / steps
        speeds = speed_mps + (end_mps - speed_mps) * share
        speeds *= length_m / (STEP_S * float(speeds.sum()))
        self._add(_Series(speeds, np.zeros(steps)))

    def _add(self, series: _Series) -> None:
        self._parts.append(series)
        self._count += series.speeds.size

    # The wander, and both together --------------------------------------------------------------

    def _lay(self, marks: list[tuple[int, int, float]]) -> None:
        """Integrate the reference, add the wander, and note the corners."""
        pilot = self._pilot
        speeds = np.concatenate([part.speeds for part in self._parts])
        courses = self.start.heading_rad + _courses(np.concatenate([p.turns for p in self._parts]))
        steps = STEP_S * speeds[:, None] * np.column_stack((np.cos(courses), np.sin(courses)))
        places = np.array(self.start[:2]) + np.vstack((np.zeros((1, 2)), np.cumsum(steps, axis=0)))
        self.end_s = STEP_S * speeds.size
        # A position stands between two steps' speeds.
        means = np.concatenate((speeds[:1], 0.5 * (speeds[1:] + speeds[:-1]), speeds[-1:]))
        headings = np.concatenate((courses, courses[-1:]))
        velocities = means[:, None] * np.column_stack((np.cos(headings), np.sin(headings)))
        begin = self._rng.standard_normal((2, 2))
        axes = np.array((pilot.wander_along_mps, pilot.wander_across_mps))
        c, s = math.cos(self.start.heading_rad), math.sin(self.start.heading_rad)
        begin = (begin * axes * np.array(((pilot.wander_time_s,), (1.0,)))) @ np.array(
            ((c, s), (-s, c))
        )
        offsets = wandered(pilot, self._rng, headings, means / self._speed, begin)
        self.corners = [
            self._truth(k, mark, places, headings, offsets) for k, mark in enumerate(marks, start=1)
        ]
        places += offsets[:, :2]
        velocities += offsets[:, 2:]
        self._flown = SampledMotion(places, velocities)
        self._headings = headings.tolist()

    def _truth(
        self,
        k: int,
        mark: tuple[int, int, float],
        places: FloatArray,
        headings: FloatArray,
        offsets: FloatArray,
    ) -> CornerTruth:
        """Return a corner as flown. Its legs' lines cross at the stop."""
        onset, end, speed = mark
        x, y = places[onset].tolist()
        before = Pose(x, y, float(headings[onset]))
        x, y = places[end].tolist()
        after = Pose(x, y, float(headings[min(end, headings.size - 1)]))
        turn = after.heading_rad - before.heading_rad
        ahead = before.along(after.x_m, after.y_m)
        left = before.across(after.x_m, after.y_m)
        to_stop = ahead - left / math.tan(turn)
        # What the corner costs against cruise to it and away from it, at the speeds before and
        # after; a stop with s = V^2 / 2a costs 2 s / V.
        leaving = float(np.hypot(*(places[min(end + 1, len(places) - 1)] - places[end]))) / STEP_S
        away = left / math.sin(turn)
        lost_s = STEP_S * (end - onset) - to_stop / speed - away / max(leaving, 1.0)
        equal_m = max(0.5 * speed * lost_s, 0.5)
        moved = before.offset(to_stop)
        at_stop = onset + int(np.argmin(np.hypot(*(places[onset:end] - moved[:2]).T)))
        shift = offsets[at_stop, :2].tolist()
        stop = Pose(moved.x_m + shift[0], moved.y_m + shift[1], moved.heading_rad)
        begun = offsets[onset, :2].tolist()
        passed_s = STEP_S * onset + to_stop / speed
        return CornerTruth(
            k,
            STEP_S * onset,
            Pose(before.x_m + begun[0], before.y_m + begun[1], before.heading_rad),
            passed_s + equal_m / speed,
            stop,
            speed,
            speed**2 / (2.0 * equal_m),
            (moved.x_m, moved.y_m),
        )

    def motion(self, time_s: float) -> Motion:
        """Return the true motion at ``time_s`` [s], counted from the start."""
        return self._flown.at(time_s)

    def heading_rad(self, time_s: float) -> float:
        """Return the reference's course [rad]: along the leg being flown, through a corner."""
        heading: float = self._headings[min(max(int(time_s / STEP_S), 0), len(self._headings) - 1)]
        return heading


def _courses(turns: FloatArray) -> FloatArray:
    """Return the course of every step, half of its own turn included, shape (n,) [rad]."""
    return np.asarray(np.cumsum(turns) - 0.5 * turns)


def flown_by(pilot: Pilot, pattern: Pattern, speed_mps: float, accel_mps2: float) -> Helicopter:
    """Return the helicopter that a pilot flies on a pattern. Raises ``ValueError`` as they do."""
    kind = HumanHelicopter if pilot.is_human else PatternHelicopter
    return kind(pattern, pilot, speed_mps, accel_mps2)
