"""A helicopter that flies a search pattern by the paper's motion model (section II).

Legs at constant speed; at a corner a constant deceleration to a stand, a turn on the spot, and a
constant acceleration. Exact at any time: every stretch is a parabola in time.
"""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_planner.patterns.legs import Leg, legs_of
from sar_sim.scenario.scenario import Pattern, Pilot

BROKEN_OFF_FACTOR = 1.6
BROKEN_OFF_S = 120.0
BROKEN_OFF_RAD = 2.6


@dataclass(frozen=True, slots=True)
class CornerTruth:
    """What really happened at corner ``k`` (from 1). ``stop`` carries the incoming heading.

    ``crossing_m``: where its legs' lines cross, x and y: the stop, less what a human is beside his
    line there.
    """

    k: int
    onset_time_s: float
    onset: Pose
    stop_time_s: float
    stop: Pose
    speed_mps: float
    accel_mps2: float
    crossing_m: tuple[float, float]


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Constant acceleration along a heading, from ``start_s``."""

    start_s: float
    start: Pose
    speed_mps: float
    accel_mps2: float
    duration_s: float

    def motion(self, time_s: float) -> Motion:
        t = time_s - self.start_s
        c, s = math.cos(self.start.heading_rad), math.sin(self.start.heading_rad)
        run = self.speed_mps * t + 0.5 * self.accel_mps2 * t * t
        v = self.speed_mps + self.accel_mps2 * t
        return Motion(
            time_s,
            self.start.x_m + run * c,
            self.start.y_m + run * s,
            v * c,
            v * s,
            self.accel_mps2 * c,
            self.accel_mps2 * s,
        )


def flown_legs(pattern: Pattern) -> list[Leg]:
    """Return a scenario's legs, the last one cut where it is an expanding square."""
    return legs_of(
        pattern.kind,
        leg_m=pattern.first_leg_m,
        spacing_m=pattern.track_spacing_m,
        corners=pattern.corners,
        side=pattern.turn_side,
        last_m=pattern.last_leg_m if pattern.kind == "expanding_square" else None,
    )


def turned_rad(nominal_rad: float, more_deg: float) -> float:
    """Return a turn to the same side as another, by so much more."""
    return math.copysign(math.radians(abs(math.degrees(nominal_rad)) + more_deg), nominal_rad)


class Helicopter(Protocol):
    """A simulated helicopter; time counts from its start."""

    @property
    def start(self) -> Pose:
        """Where it begins."""
        ...

    @property
    def corners(self) -> list[CornerTruth]:
        """The corners as flown."""
        ...

    @property
    def end_s(self) -> float:
        """When its flight is over [s]."""
        ...

    def motion(self, time_s: float) -> Motion:
        """Return the true motion at a time [s]."""
        ...

    def heading_rad(self, time_s: float) -> float:
        """Return the heading at a time [rad]."""
        ...


class PatternHelicopter:
    """The helicopter on its pattern, beginning at time 0 at cruise speed.

    ``corners``: the corners as flown. ``end_s``: when the last leg is flown. Raises ``ValueError``
    when a leg is too short to reach cruise speed and stop again.
    """

    def __init__(self, pattern: Pattern, pilot: Pilot, speed_mps: float, accel_mps2: float) -> None:
        """Lay out every stretch; the pilot's variation is drawn from his seed."""
        rng = np.random.default_rng(pilot.seed)
        self.corners: list[CornerTruth] = []
        self._stretches: list[_Stretch] = []
        self._end = pattern.start
        self.start = self._end
        self.end_s = 0.0
        entry_accel = accel_mps2
        legs = flown_legs(pattern)
        for i, (length, nominal) in enumerate(legs):
            k = i + 1
            odd = pilot.anomaly if k == pilot.anomaly_corner else ""
            speed = speed_mps + pilot.speed_sigma_mps * rng.standard_normal()
            accel = accel_mps2 * math.exp(pilot.accel_spread * rng.standard_normal())
            shift = pilot.corner_sigma_m * rng.standard_normal()
            end_speed = speed + pilot.speed_drift_mps * rng.uniform(-1.0, 1.0)
            turn = turned_rad(nominal, pilot.turn_spread_deg * rng.uniform(-1.0, 1.0))
            hover = pilot.hover_s + pilot.hover_spread_s * rng.uniform()
            last = i == len(legs) - 1
            speeding = 0.0 if i == 0 else speed**2 / (2.0 * entry_accel)
            slowing = 0.0 if last else end_speed**2 / (2.0 * accel)
            cruise = length + (0.0 if last else shift) - speeding - slowing
            if cruise < 0.0:
                raise ValueError(
                    f"leg {k} of {length:.0f} m: expected at least {speeding + slowing:.0f} m "
                    "to reach cruise speed and stop"
                )
            if i > 0:
                self._add(0.0, entry_accel, speed / entry_accel)
            if odd == "go_on":
                cruise = self._slow_and_go_on(cruise, speed, accel)
            duration = 2.0 * cruise / (speed + end_speed)
            self._add(speed, (end_speed - speed) / duration, duration)
            if last:
                break
            onset_s, onset = self.end_s, self._end
            self._add(end_speed, -accel, end_speed / accel)
            stop = self._end
            crossing = stop.x_m, stop.y_m
            self.corners.append(
                CornerTruth(k, onset_s, onset, self.end_s, stop, end_speed, accel, crossing)
            )
            self._add(0.0, 0.0, hover)
            if odd == "other_way":
                turn = -turn
            if odd == "break_off":
                self._end = Pose(
                    stop.x_m, stop.y_m, stop.heading_rad + math.copysign(BROKEN_OFF_RAD, turn)
                )
                self._add(0.0, accel, BROKEN_OFF_FACTOR * speed / accel)
                self._add(BROKEN_OFF_FACTOR * speed, 0.0, BROKEN_OFF_S)
                break
            self._end = Pose(stop.x_m, stop.y_m, stop.heading_rad + turn)
            entry_accel = accel
        self._starts = [stretch.start_s for stretch in self._stretches]

    def _slow_and_go_on(self, cruise_m: float, speed_mps: float, accel_mps2: float) -> float:
        """Fly half of a leg, slow to a third, speed up again; return what is left of it [m]."""
        low = speed_mps / 3.0
        ramp_s = (speed_mps - low) / accel_mps2
        half = 0.5 * cruise_m
        self._add(speed_mps, 0.0, half / speed_mps)
        self._add(speed_mps, -accel_mps2, ramp_s)
        self._add(low, accel_mps2, ramp_s)
        return max(speed_mps, half - (speed_mps + low) * ramp_s)

    def _add(self, speed_mps: float, accel_mps2: float, duration_s: float) -> None:
        if duration_s <= 0.0:
            return
        stretch = _Stretch(self.end_s, self._end, speed_mps, accel_mps2, duration_s)
        self._stretches.append(stretch)
        self.end_s += duration_s
        over = stretch.motion(self.end_s)
        self._end = Pose(over.x_m, over.y_m, self._end.heading_rad)

    def motion(self, time_s: float) -> Motion:
        """Return the true motion at ``time_s`` [s], counted from the start."""
        index = max(0, bisect.bisect_right(self._starts, time_s) - 1)
        return self._stretches[index].motion(time_s)

    def heading_rad(self, time_s: float) -> float:
        """Return the heading [rad] of the stretch being flown."""
        index = max(0, bisect.bisect_right(self._starts, time_s) - 1)
        return self._stretches[index].start.heading_rad
