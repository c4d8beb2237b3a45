"""What a helicopter that flies a search pattern may do next: the monitor's own hypotheses.

A helicopter goes on, stops, stands, and departs in any of three directions; it brakes and speeds
up at a nominal acceleration. Which of these are *likely* depends on what it is doing now; the rest
is *possible*. Positions are in the map frame [m], times in seconds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sar_bridge.arduplane import l1_kernels
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.seen_helicopter import (
    CONTRADICTION,
    SURE_COURSE_MPS,
    SeenHelicopter,
)
from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.states import CornerEstimate, FloatArray, Motion, Phase

UNSEEN_S = 5.0
UNSEEN_STEP_S = 4.0
MOST_UNSEEN = 12
STOP_SIGMA_M = 4.0
EXPECTED_SIGMA_RAD = math.radians(6.0)
ACCEL_SHARE_SIGMA = 0.15
ANOTHER_WAY_RAD = math.radians(60.0)
FASTER, IS_FAST = 1.3, 1.0


class Future(NamedTuple):
    """One hypothesis: positions, shape (n, 2) [m], at the times asked for.

    ``sigma_m``: their standard deviation in any direction, shape (n,) [m]. ``who``: of whom.
    ``most_mps2``: the most acceleration on the way.
    """

    name: str
    positions: FloatArray
    sigma_m: FloatArray
    likely: bool = False
    who: str = "the helicopter"
    most_mps2: float = 0.0


class Helicopter(SeenHelicopter):
    """The helicopter as last told of, and what it may do next."""

    def futures(self, now_s: float, times_s: FloatArray) -> list[Future]:
        """Return the hypotheses at ``times_s`` after ``now_s``; none where it was never seen."""
        if self.motion is None:
            return []
        maker = {
            Phase.DECELERATING: self._slowing,
            Phase.STOPPED: self._standing,
            Phase.ACCELERATING: self._departing,
            Phase.LOST: self._lost,
        }.get(self.phase, self._cruising)
        ahead_s = now_s - self.motion.time_s
        found = maker(self.motion, ahead_s, now_s, times_s)
        most_mps2 = self._most_mps2
        return [future._replace(most_mps2=most_mps2) for future in found]

    @property
    def _most_mps2(self) -> float:
        """The most acceleration of any hypothesis [m/s^2]."""
        slowing = 0.0 if self.corner is None else self.corner.accel_mps2
        return max(self.model.accel_mps2, slowing)

    def _stop(self, here: Pose, speed: float, now_s: float) -> tuple[Pose, float, float]:
        """Return where it will stand when it stops, in how long [s], and its deceleration."""
        accel = self.model.accel_mps2
        corner = self.this_corner(here, now_s) if self.phase is Phase.DECELERATING else None
        if corner is not None:
            return corner.stop, max(0.0, corner.stop_time_s - now_s), corner.accel_mps2
        return here.offset(speed**2 / (2.0 * accel)), speed / accel, accel

    def _spread(self, times: FloatArray, velocity_sigma: float) -> FloatArray:
        """Return the standard deviation at ``times`` of a motion with an unsure velocity [m]."""
        return l1_kernels.spread(times, self.position_sigma_m, velocity_sigma, 0.0, 0.0)

    def _ramp_spread(self, times: FloatArray) -> FloatArray:
        """Return the same where the acceleration is not known better than to a share."""
        accel = self.model.accel_mps2
        unsure, ramp_s = ACCEL_SHARE_SIGMA * accel, self.cruise_mps / accel
        return l1_kernels.spread(times, self.position_sigma_m, 0.0, unsure, ramp_s)

    def _turned(self, stop: Pose, after_s: float, times: FloatArray, turn_rad: float) -> FloatArray:
        """Return where it is when it departs from a stop, turned by an angle."""
        out = Pose(stop.x_m, stop.y_m, stop.heading_rad + turn_rad)
        since = np.maximum(times - after_s, 0.0)
        return _along(out, _run(since, 0.0, self.model.accel_mps2, self.cruise_mps))

    def _stopping(
        self, here: Pose, speed: float, now_s: float, times: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return how it comes to a stand, and how it departs from there inside and outside."""
        stop, in_s, accel = self._stop(here, speed, now_s)
        model = self.model
        stands, left, right = l1_kernels.stop_and_turn(
            times, *stop, in_s, accel, model.accel_mps2, self.cruise_mps, model.turn_rad
        )
        inside, outside = (right, left) if model.turn_side > 0 else (left, right)
        return stands, inside, outside

    def _cruising(
        self, motion: Motion, ahead_s: float, now_s: float, times: FloatArray
    ) -> list[Future]:
        here = self.here(motion, ahead_s)
        vx, vy, sigma = self.velocity(motion)
        onward = l1_kernels.straight_on(times, here.x_m, here.y_m, vx, vy)
        straight = Pose(here.x_m, here.y_m, math.atan2(vy, vx))
        slowing, inside, outside = self._stopping(straight, math.hypot(vx, vy), now_s, times)
        spread = self._ramp_spread(times)
        return [
            Future("goes on", onward, self._spread(times, sigma), likely=True),
            Future("stops", slowing, spread, likely=True),
            Future("stops and turns inside", inside, spread),
            Future("stops and turns outside", outside, spread),
        ]

    def _lost(
        self, motion: Motion, ahead_s: float, now_s: float, times: FloatArray
    ) -> list[Future]:
        """Return how it goes on, and what it may have done unseen: a stop, and a turn either way.

        It was seen last up to ``UNSEEN_S`` before it was called lost.
        """
        found = self._cruising(motion, ahead_s, now_s, times)
        if self.sure is None:
            return found
        spread = self._ramp_spread(times)
        accel, turn_rad = self.model.accel_mps2, self.model.turn_rad
        for stop, in_s in unseen_stops(self.corner, *self.sure, self.model, now_s):
            stands, left, right = l1_kernels.stop_and_turn(
                times, *stop, in_s, accel, accel, self.cruise_mps, turn_rad
            )
            found += [
                Future("stood unseen", stands, spread),
                Future("turned left unseen", left, spread),
                Future("turned right unseen", right, spread),
            ]
        return found

    def _slowing(
        self, motion: Motion, ahead_s: float, now_s: float, times: FloatArray
    ) -> list[Future]:
        here = self.here(motion, ahead_s)
        slowing, inside, outside = self._stopping(here, motion.speed_mps, now_s, times)
        corner = self.this_corner(here, now_s)
        if corner is not None:  # its own course means little when it is slow
            here = Pose(here.x_m, here.y_m, corner.stop.heading_rad)
        forward = motion.vx_mps * math.cos(here.heading_rad)
        forward = max(0.0, forward + motion.vy_mps * math.sin(here.heading_rad))
        fastest = max(self.cruise_mps, forward)
        again = _along(here, _run(times, forward, self.model.accel_mps2, fastest))
        spread = self._ramp_spread(times)
        heading = here.heading_rad
        not_out, not_on = self._seen_off(motion, heading - self.model.inside_rad, heading)
        if corner is not None:
            spread = np.hypot(spread, math.sqrt(0.5 * float(np.trace(corner.covariance))))
        return [
            Future("turns inside", inside, spread, likely=True),
            Future("stands", slowing, spread),
            *(() if not_out else (Future("turns outside", outside, spread),)),
            *(() if not_on else (Future("goes on", again, spread),)),
        ]

    def _standing(
        self, motion: Motion, ahead_s: float, now_s: float, times: FloatArray
    ) -> list[Future]:
        here = self.here(motion, ahead_s)
        hovered = self.has_hovered
        if hovered and motion.speed_mps > SURE_COURSE_MPS:
            return self._leaving(motion, here, now_s, times)
        corner = self.this_corner(here, now_s)
        stop = here if corner is None else corner.stop
        since = UNSEEN_S if corner is None else min(UNSEEN_S, max(0.0, now_s - corner.stop_time_s))
        inside = self.model.inside_rad
        if hovered:
            stop, since = here, 0.0
        still = np.full_like(times, self.position_sigma_m)
        spread = self._ramp_spread(times)
        found = [
            Future("stands", _along(here, np.zeros_like(times)), still, likely=True),
            Future(
                "leaves inside",
                self._turned(stop, -since, times, inside),
                spread,
                likely=not hovered,
            ),
        ]
        heading = stop.heading_rad
        not_out, not_on = self._seen_off(motion, heading - inside, heading)
        if not not_out:
            leaves = self._turned(stop, 0.0, times, -inside)
            found.append(Future("leaves outside", leaves, spread))
        if not not_on:
            leaves = self._turned(stop, 0.0, times, 0.0)
            found.append(Future("leaves straight on", leaves, spread))
        away = math.hypot(here.x_m - stop.x_m, here.y_m - stop.y_m)
        if away > CONTRADICTION * math.hypot(self.position_sigma_m, STOP_SIGMA_M):
            found += self._departing(motion, ahead_s, now_s, times)
        return found

    def _seen_off(self, motion: Motion, *headings_rad: float) -> list[bool]:
        """Return which departures it is seen not to make: it moves, and another way than that."""
        sure = motion.speed_mps > max(SURE_COURSE_MPS, CONTRADICTION * self.velocity_sigma_mps)
        return [
            sure and abs(wrap_angle(motion.course_rad - heading)) > ANOTHER_WAY_RAD
            for heading in headings_rad
        ]

    def _leaving(self, motion: Motion, here: Pose, now_s: float, times: FloatArray) -> list[Future]:
        """Return how one that has hovered leaves: where it is seen to go."""
        run = _run(times, motion.speed_mps, self.model.accel_mps2, self.cruise_mps)
        spread = self._ramp_spread(times)
        slowing = self._stopping(here, motion.speed_mps, now_s, times)[0]
        return [
            Future("leaves", _along(here, run), np.hypot(spread, 0.05 * run), likely=True),
            Future("stops again", slowing, spread),
        ]

    def _departing(
        self, motion: Motion, ahead_s: float, now_s: float, times: FloatArray
    ) -> list[Future]:
        here = self.here(motion, ahead_s)
        out = here
        if self.corner is not None:
            out = way_out(self.inside(self.corner), here, self.position_sigma_m)
        forward = max(0.0, motion.speed_mps * math.cos(motion.course_rad - out.heading_rad))
        above, sigma = forward - self.cruise_mps, self.velocity_sigma_mps
        if above < CONTRADICTION * sigma:
            forward = min(forward, self.cruise_mps)
        fastest = max(self.cruise_mps, forward)
        run = _run(times, forward, self.model.accel_mps2, fastest)
        slowing = self._stopping(here, forward, now_s, times)[0]
        spread = self._ramp_spread(times)
        found = [
            Future("speeds up", _along(out, run), np.hypot(spread, 0.05 * run), likely=True),
            Future("stops again", slowing, spread),
        ]
        if above > IS_FAST * sigma:  # it is about to fly faster than it did before
            top = max(FASTER * self.cruise_mps, fastest)
            faster = _run(times, forward, self.model.accel_mps2, top)
            bound = np.full_like(spread, self.position_sigma_m)
            found.append(Future("departs faster", _along(out, faster), bound))
        return found


def unseen_stops(
    corner: CornerEstimate | None, sure: Motion, phase: Phase, model: HelicopterModel, now_s: float
) -> list[tuple[Pose, float]]:
    """Return where a helicopter may have stopped unseen, and left in how long from now [s].

    ``sure``, ``phase``: its motion and phase when it was seen last.
    """
    if phase in (Phase.DECELERATING, Phase.STOPPED) and corner is not None:
        first_s = corner.stop_time_s
        leaves_s = np.arange(first_s, max(now_s, first_s) + UNSEEN_STEP_S, UNSEEN_STEP_S)
        return [(corner.stop, at_s - now_s) for at_s in leaves_s[-MOST_UNSEEN:]]
    if sure.speed_mps < SURE_COURSE_MPS:
        return []
    slowing_s = sure.speed_mps / model.accel_mps2
    found = []
    for begun_s in np.arange(sure.time_s - UNSEEN_S, now_s, UNSEEN_STEP_S):
        way_m = sure.speed_mps * (begun_s - sure.time_s + 0.5 * slowing_s)
        found.append((sure.pose.offset(way_m), begun_s + slowing_s - now_s))
    return found[-MOST_UNSEEN:]


def way_out(inside: Pose, here: Pose, position_sigma_m: float) -> Pose:
    """Return where a helicopter is on the line on which it leaves its stop.

    ``inside``: the stop, turned by the right angle to the pattern's side, which is weighed against
    the bearing from the stop; the bearing alone where both contradict each other.
    """
    dx, dy = here.x_m - inside.x_m, here.y_m - inside.y_m
    away = max(math.hypot(dx, dy), 1.0)
    off = wrap_angle(math.atan2(dy, dx) - inside.heading_rad)
    sigma = math.hypot(max(position_sigma_m, 1.0), STOP_SIGMA_M) / away
    weight = EXPECTED_SIGMA_RAD**2 / (EXPECTED_SIGMA_RAD**2 + sigma**2)
    if abs(off) > CONTRADICTION * math.hypot(sigma, EXPECTED_SIGMA_RAD):
        weight = 1.0
    out = Pose(inside.x_m, inside.y_m, inside.heading_rad + weight * off)
    return out.offset(max(0.0, out.along(here.x_m, here.y_m)))


def _run(times: FloatArray, speed: float, accel: float, until_mps: float) -> FloatArray:
    """Return the way [m] at ``times`` from a speed, speeding up until another."""
    ramp_s = max(0.0, (until_mps - speed) / accel)
    ramp = np.clip(times, 0.0, ramp_s)
    way: FloatArray = speed * ramp + 0.5 * accel * ramp**2
    return way + until_mps * np.maximum(times - ramp_s, 0.0)


def _along(pose: Pose, run: FloatArray) -> FloatArray:
    heading = np.array((math.cos(pose.heading_rad), math.sin(pose.heading_rad)))
    return np.array((pose.x_m, pose.y_m)) + run[:, None] * heading
