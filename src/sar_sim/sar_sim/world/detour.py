"""The helicopter leaves its pattern for what was found, and takes it up again where it left it.

It flies to the mark, hovers over it, circles it, or stays there for good. Back it comes on the
course that it left with, and goes on from that place: its pattern has stood still meanwhile.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sar_estimator.common.constants import G_MPS2
from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.states import FloatArray, Motion
from sar_sim.scenario.scenario import Find, Pilot
from sar_sim.world.helicopter import CornerTruth, Helicopter
from sar_sim.world.human_helicopter import wandered
from sar_sim.world.sampled_motion import STEP_S, SampledMotion

BANK_DEG, YAW_RATE_DPS = 20.0, 20.0
SHARP_RAD, SHARP_SHARE = math.radians(60.0), 0.5
REACHED_M, STOOD_MPS = 3.0, 1.0
CIRCLE_M, CIRCLE_SHARE, CIRCLE_LOOK_M = 150.0, 0.75, 50.0
BACK_M, JOINED_M, LINE_LOOK_M = 600.0, 150.0, 120.0
STAYS_S = 120.0
BLEND_S = 20.0
FARTHEST_S = 1200.0


def place(find: Find, helicopter: Motion, heading_rad: float) -> Pose:
    """Return where a find is, by what the helicopter does when it is made."""
    here = Pose(helicopter.x_m, helicopter.y_m, heading_rad)
    return here.offset(find.ahead_m, find.left_m)


def found_beside(helicopter: Helicopter, find: Find) -> Pose:
    """Return where a find is beside a simulated helicopter."""
    return place(find, helicopter.motion(find.time_s), helicopter.heading_rad(find.time_s))


class _Hand:
    """The pilot's hand: every step a course and a speed are wanted, and flown within limits."""

    def __init__(self, begin: Motion, heading_rad: float, cruise_mps: float, accel: float) -> None:
        self.x, self.y = begin.x_m, begin.y_m
        self.course, self.speed = heading_rad, begin.speed_mps
        self._cruise, self._accel = cruise_mps, accel
        self.rows: list[tuple[float, float, float, float]] = []

    def away(self, x_m: float, y_m: float) -> float:
        return math.hypot(x_m - self.x, y_m - self.y)

    def step(self, course_rad: float, speed_mps: float) -> None:
        """Fly a step towards a course and a speed; slower while far off the course."""
        off = wrap_angle(course_rad - self.course)
        wanted = min(speed_mps, self._cruise)
        if abs(off) > SHARP_RAD:
            wanted = min(wanted, SHARP_SHARE * self._cruise)
        most = self._accel * STEP_S
        self.speed += min(max(wanted - self.speed, -most), most)
        rate = min(
            math.radians(YAW_RATE_DPS),
            G_MPS2 * math.tan(math.radians(BANK_DEG)) / max(self.speed, 1.0),
        )
        self.course += min(max(off, -rate * STEP_S), rate * STEP_S)
        self.x += STEP_S * self.speed * math.cos(self.course)
        self.y += STEP_S * self.speed * math.sin(self.course)
        self.rows.append((self.x, self.y, self.course, self.speed))

    def to(self, x_m: float, y_m: float, *, near_m: float, stops: bool) -> None:
        """Fly to a point, until nearer than ``near_m``; there stop, or pass it."""
        for _ in range(round(FARTHEST_S / STEP_S)):
            left = self.away(x_m, y_m)
            if left < near_m and (not stops or self.speed < STOOD_MPS):
                return
            speed = self._cruise
            if stops:
                speed = math.sqrt(2.0 * 0.8 * self._accel * max(left - near_m / 2.0, 0.0))
            self.step(math.atan2(y_m - self.y, x_m - self.x), speed)

    def hover(self, seconds: float) -> None:
        for _ in range(round(seconds / STEP_S)):
            self.step(self.course, 0.0)

    def circle(self, x_m: float, y_m: float, seconds: float) -> None:
        """Circle a point to the left."""
        for _ in range(round(seconds / STEP_S)):
            bearing = math.atan2(self.y - y_m, self.x - x_m)
            off = (self.away(x_m, y_m) - CIRCLE_M) / CIRCLE_LOOK_M
            self.step(bearing + math.pi / 2.0 + math.atan(off), CIRCLE_SHARE * self._cruise)

    def along(self, line: Pose, end_mps: float) -> None:
        """Fly along a line to its pose, to be there with a speed."""
        for _ in range(round(FARTHEST_S / STEP_S)):
            left = -line.along(self.x, self.y)
            if left <= 0.0:
                return
            across = line.across(self.x, self.y)
            course = line.heading_rad - math.atan(across / LINE_LOOK_M)
            self.step(course, math.sqrt(max(end_mps, 2.0) ** 2 + 2.0 * self._accel * left))


class Detour:
    """A helicopter that breaks its pattern off for one find. See ``Helicopter``."""

    def __init__(
        self, pattern: Helicopter, find: Find, pilot: Pilot, speed_mps: float, accel_mps2: float
    ) -> None:
        """Fly ``pattern`` but for the way to the mark and back; its wander is the pilot's."""
        self._pattern, self._begin_s = pattern, find.time_s
        self.start = pattern.start
        begin = pattern.motion(find.time_s)
        heading = pattern.heading_rad(find.time_s)
        mark = found_beside(pattern, find)
        hand = _Hand(begin, heading, speed_mps, accel_mps2)
        stays = find.helicopter == "stays"
        self._returns = not stays
        if find.helicopter == "circles":
            hand.to(mark.x_m, mark.y_m, near_m=CIRCLE_M, stops=False)
            hand.circle(mark.x_m, mark.y_m, find.hover_s)
        else:
            hand.to(mark.x_m, mark.y_m, near_m=REACHED_M, stops=True)
            hand.hover(find.orbit_s + STAYS_S if stays else find.hover_s)
        if self._returns:
            line = Pose(begin.x_m, begin.y_m, heading)
            back = line.offset(-BACK_M)
            hand.to(back.x_m, back.y_m, near_m=JOINED_M, stops=False)
            hand.along(line, begin.speed_mps)
        rows = np.array([(begin.x_m, begin.y_m, heading, begin.speed_mps), *hand.rows])
        self._track = _track(rows, begin, pilot, speed_mps, returns=self._returns)
        self._courses: list[float] = rows[:, 2].tolist()
        self.end_s = find.time_s + self._track.end_s
        self.corners = [one for one in pattern.corners if one.onset_time_s <= find.time_s]
        if self._returns:
            self.end_s += max(0.0, pattern.end_s - find.time_s)
            self.corners = [_later(one, find.time_s, self._track.end_s) for one in pattern.corners]

    def _in_pattern_s(self, time_s: float) -> float | None:
        """Return the pattern's own time; None on the detour."""
        if time_s <= self._begin_s:
            return time_s
        after = time_s - self._track.end_s
        return after if self._returns and after >= self._begin_s else None

    def motion(self, time_s: float) -> Motion:
        """Return the true motion at a time [s]."""
        own = self._in_pattern_s(time_s)
        if own is None:
            return self._track.at(time_s - self._begin_s).stamped(time_s)
        return self._pattern.motion(own).stamped(time_s)

    def heading_rad(self, time_s: float) -> float:
        """Return the heading at a time [rad]."""
        own = self._in_pattern_s(time_s)
        if own is None:
            step = int((time_s - self._begin_s) / STEP_S)
            return self._courses[min(step, len(self._courses) - 1)]
        return self._pattern.heading_rad(own)


def _later(corner: CornerTruth, from_s: float, by_s: float) -> CornerTruth:
    """Return a corner as much later as the detour takes, of what comes after its begin."""
    onset, stop = (
        time_s + by_s if time_s > from_s else time_s
        for time_s in (corner.onset_time_s, corner.stop_time_s)
    )
    return replace(corner, onset_time_s=onset, stop_time_s=stop)


def _track(
    rows: FloatArray, begin: Motion, pilot: Pilot, cruise_mps: float, *, returns: bool
) -> SampledMotion:
    """Add the pilot's wander to the rows x, y, course, speed; end as it began if it ``returns``."""
    rng = np.random.default_rng([pilot.seed, 7, round(10.0 * begin.time_s)])
    courses = np.ascontiguousarray(rows[:, 2])
    offsets = wandered(pilot, rng, courses, rows[:, 3] / cruise_mps, np.zeros((2, 2)))
    places = rows[:, :2] + offsets[:, :2]
    velocities = rows[:, 3:] * np.column_stack((np.cos(rows[:, 2]), np.sin(rows[:, 2])))
    velocities += offsets[:, 2:]
    _blend(places, velocities, begin, at_end=False)
    if returns:
        _blend(places, velocities, begin, at_end=True)
    return SampledMotion(places, velocities)


def _blend(places: FloatArray, velocities: FloatArray, to: Motion, *, at_end: bool) -> None:
    """Lead a track's first or last seconds smoothly from, or to, a motion: a cubic in time."""
    if not at_end:  # backwards in time
        places, velocities = places[::-1], velocities[::-1]
    sign = 1.0 if at_end else -1.0
    n = min(round(BLEND_S / STEP_S), len(places) - 1)
    time_s = sign * STEP_S * n
    s = np.linspace(0.0, 1.0, n + 1)[:, None]
    off = np.array((to.x_m, to.y_m)) - places[-1]
    slope = time_s * (np.array((to.vx_mps, to.vy_mps)) - velocities[-1])
    places[-n - 1 :] += off * (3.0 * s**2 - 2.0 * s**3) + slope * (s**3 - s**2)
    velocities[-n - 1 :] += (off * (6.0 * s - 6.0 * s**2) + slope * (3.0 * s**2 - 2.0 * s)) / time_s


def detoured(
    helicopter: Helicopter,
    finds: list[Find],
    pilot: Pilot,
    *,
    speed_mps: float,
    accel_mps2: float,
) -> Helicopter:
    """Return a helicopter that leaves its pattern for every find that it shall fly to."""
    for find in sorted(finds, key=lambda one: one.time_s):
        if find.helicopter != "goes_on":
            helicopter = Detour(helicopter, find, pilot, speed_mps, accel_mps2)
    return helicopter
