"""What a helicopter may do that follows no pattern: go on, turn on, stand, fly to a place. Pure."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.states import Motion
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import FlightPath
from sar_planner.prediction.forecast import Forecast, Stretch, departing
from sar_planner.prediction.separation import apart_for_m
from sar_planner.prediction.situation import Situation

STANDING_MPS = 5.0
HEADS_RAD = math.radians(40.0)
WATCHED_S, LEAST_WATCHED_S = 15.0, 5.0
CIRCLES_RAD = math.radians(45.0)
STRAIGHT_S, STRAIGHT_RAD = 10.0, math.radians(20.0)
LEAVES_CIRCLE_S = 12.0
ARC_S, ARC_STEP_S = 300.0, 2.0
FRONT_M = 1000.0
"""Ahead of the helicopter, within which the UAV does not cross its track."""
FRONT_STEP_S = 2.0


@dataclass(frozen=True, slots=True)
class Possible:
    """One forecast, and for how long it counts from now on [s]."""

    forecast: Forecast
    for_s: float = math.inf


def least_apart_m(
    possible: Sequence[Possible], path: FlightPath, start_s: float, speed_mps: float
) -> float:
    """Return the least distance [m] to all that is possible of a path, while it is flown.

    A lower bound: ``apart_for_m``. ``start_s``: when it is begun. Infinite where nothing is
    possible.
    """
    flown_s = path.length_m / speed_mps
    return min(
        (
            apart_for_m(
                path, one.forecast, min(flown_s, one.for_s), start_s=start_s, speed_mps=speed_mps
            )
            for one in possible
        ),
        default=math.inf,
    )


class FreeFlight:
    """Watches the helicopter's course, and says what it may do."""

    def __init__(self, situation: Situation, corner: CornerParameters) -> None:
        """Have seen nothing."""
        self._s, self._corner = situation, corner
        self._seen: deque[tuple[float, float]] = deque()
        self._course_rad = 0.0

    def watch(self) -> None:
        """Take its newest course, once a second."""
        now = self._s.helicopter
        if now is None or (self._seen and 0.0 <= now.time_s - self._seen[-1][0] < 1.0):
            return
        since_s = now.time_s - self._seen[-1][0] if self._seen else math.inf
        if now.speed_mps < STANDING_MPS or not 0.0 <= since_s <= LEAST_WATCHED_S:
            self._seen.clear()
        if now.speed_mps < STANDING_MPS:
            return
        self._course_rad += wrap_angle(now.course_rad - self._course_rad)
        self._seen.append((now.time_s, self._course_rad))
        while now.time_s - self._seen[0][0] > WATCHED_S:
            self._seen.popleft()

    @property
    def turn_rate(self) -> float:
        """With what rate it circles, left positive [rad/s]; 0 where it does not."""
        if not self._seen:
            return 0.0
        (first_s, first), (last_s, last) = self._seen[0], self._seen[-1]
        turned = last - first
        if last_s - first_s < LEAST_WATCHED_S or abs(turned) < CIRCLES_RAD:
            return 0.0
        return turned / (last_s - first_s)

    @property
    def flies_straight(self) -> bool:
        """Whether its course has not changed for as long as it is watched, and that is long."""
        if not self._seen:
            return False
        courses = [course for _, course in self._seen]
        watched_s = self._seen[-1][0] - self._seen[0][0]
        return watched_s > STRAIGHT_S and max(courses) - min(courses) < STRAIGHT_RAD

    @property
    def keeps_its_place(self) -> bool:
        """Whether it hovers or circles: what it may do holds for long."""
        return self._s.hovers or self.turn_rate != 0.0

    def possible(
        self, now_s: float, place: tuple[float, float], *, comes: bool
    ) -> tuple[Possible, ...]:
        """Return what it may do; ``comes``: it may fly to ``place`` wherever it heads now.

        Later that is believed while it heads there: else a UAV that circles the place would make
        way for a helicopter that searches on. One that hovers may leave any way: it is taken to
        stand, and is seen when it leaves. Of one that circles it is believed that it goes on so.
        """
        helicopter = self._s.helicopter
        if helicopter is None:
            return ()
        now = helicopter.after(now_s - helicopter.time_s)
        standing = Possible(Forecast((Stretch(now_s, now.pose, 0.0),), now.pose, now_s, 0.0))
        if self._s.hovers:
            return (standing,)
        accel, fastest = self._corner.accel_mps2, max(now.speed_mps, self._corner.speed_mps)
        onward = departing(now_s, now.pose, now.speed_mps, speed_mps=fastest, accel_mps2=accel)
        rate = self.turn_rate
        if rate != 0.0:
            turning = _turning(now_s, now, rate)
            return standing, Possible(onward, LEAVES_CIRCLE_S), Possible(turning, ARC_S)
        found = [standing, Possible(onward)]
        if not self._s.has_hovered:  # who has may leave otherwise than a corner
            found += [Possible(one) for one in self._s.forecasts(now_s)]
        dx, dy = place[0] - now.x_m, place[1] - now.y_m
        towards = Pose(now.x_m, now.y_m, math.atan2(dy, dx))
        off = abs(wrap_angle(towards.heading_rad - now.course_rad))
        if comes or (off < HEADS_RAD and now.speed_mps > STANDING_MPS):
            found.append(Possible(_going(now_s, towards, math.hypot(dx, dy), fastest)))
        return tuple(found)

    def is_cut_off_by(self, path: FlightPath, now_s: float) -> bool:
        """Whether a path that is begun now crosses its track ahead of it, near it."""
        helicopter = self._s.helicopter
        if helicopter is None or helicopter.speed_mps < STANDING_MPS:
            return False
        now = helicopter.after(now_s - helicopter.time_s)
        times = np.arange(0.0, path.length_m / self._corner.speed_mps, FRONT_STEP_S)
        course = now.course_rad
        along = np.array((math.cos(course), math.sin(course)))
        flown = path.points(times * self._corner.speed_mps) - (now.x_m, now.y_m)
        ahead = flown @ along - now.speed_mps * times
        beside = flown @ np.array((-along[1], along[0]))
        crossed = beside[:-1] * beside[1:] < 0.0
        return bool((crossed & (ahead[1:] > 0.0) & (ahead[1:] < FRONT_M)).any())


def _going(now_s: float, towards: Pose, away_m: float, speed_mps: float) -> Forecast:
    """Return how it flies to a place, and stands there."""
    there = Stretch(now_s + away_m / speed_mps, towards.offset(away_m), 0.0)
    return Forecast((Stretch(now_s, towards, speed_mps), there), towards, now_s, speed_mps)


def _turning(now_s: float, now: Motion, rate: float) -> Forecast:
    """Return how it turns on: an arc of straight steps."""
    pose, speed = now.pose, now.speed_mps
    stretches = []
    for i in range(round(ARC_S / ARC_STEP_S)):
        chord = Pose(pose.x_m, pose.y_m, pose.heading_rad + 0.5 * rate * ARC_STEP_S)
        stretches.append(Stretch(now_s + i * ARC_STEP_S, chord, speed))
        end = chord.offset(speed * ARC_STEP_S)
        pose = Pose(end.x_m, end.y_m, pose.heading_rad + rate * ARC_STEP_S)
    return Forecast(tuple(stretches), stretches[-1].start, now_s, speed)
