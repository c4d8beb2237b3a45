"""The helicopter's motion to come: stretches of constant acceleration, then cruise for ever."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sar_estimator.common.other_uavs import OtherUav
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_planner.paths.flight_path import CornerFrame, FloatArray

LEAST_SPEED_MPS, LEAST_WAY_M = 5.0, 1.0
OTHERS_HORIZON_S = 60.0


class Stretch(NamedTuple):
    """From ``time_s`` on, constant acceleration along the heading of ``start``."""

    time_s: float
    start: Pose
    speed_mps: float
    accel_mps2: float = 0.0


@dataclass(frozen=True)
class Forecast:
    """Where the helicopter will be, and the leg it will be on in the end.

    ``stretches``: in order of time; before the first it is taken to have cruised along it.
    ``leg``: a pose on the last leg's line. ``zero_s``: the time at which the helicopter, were its
    last cruise extended backwards, would pass that pose; ``speed_mps``: its speed V on that leg.
    """

    stretches: tuple[Stretch, ...]
    leg: Pose
    zero_s: float
    speed_mps: float

    def positions(self, times_s: FloatArray | Sequence[float]) -> FloatArray:
        """Return the helicopter's positions, shape (n, 2) [m], at ``times_s``."""
        times = np.asarray(times_s, dtype=np.float64)
        table = self.table
        stretch = np.maximum(np.searchsorted(table[0], times, side="right") - 1, 0)
        begun, x, y, east, north, speed, accel = table[:, stretch]
        duration = times - begun
        run = speed * duration + 0.5 * accel * np.square(np.maximum(duration, 0.0))
        out = np.empty((times.size, 2))
        out[:, 0] = x + east * run
        out[:, 1] = y + north * run
        return out

    @cached_property
    def table(self) -> FloatArray:
        """Time, x, y, direction, speed and acceleration of every stretch, shape (7, n)."""
        rows = [
            (time_s, x_m, y_m, math.cos(heading), math.sin(heading), speed_mps, accel_mps2)
            for time_s, (x_m, y_m, heading), speed_mps, accel_mps2 in self.stretches
        ]
        return np.ascontiguousarray(np.array(rows).T)

    def in_frame(self, frame: CornerFrame) -> Forecast:
        """Return the same motion in the coordinates of a frame."""
        moved = tuple(
            [
                Stretch(time_s, frame.to_frame(start), speed_mps, accel_mps2)
                for time_s, start, speed_mps, accel_mps2 in self.stretches
            ]
        )
        return Forecast(moved, frame.to_frame(self.leg), self.zero_s, self.speed_mps)

    def behind(self, lag_m: float) -> Forecast:
        """Return the same motion with a slot that is so far behind [m]."""
        zero_s = self.zero_s + lag_m / self.speed_mps
        return Forecast(self.stretches, self.leg, zero_s, self.speed_mps)

    def along_m(self, time_s: float) -> float:
        """Return how far along the leg, from ``leg``, the slot is at ``time_s`` [m]."""
        return self.speed_mps * (time_s - self.zero_s)

    def slot_x_m(self, time_s: float) -> float:
        """Return x [m] of the slot at ``time_s``, for a forecast in the slot's frame."""
        return self.leg.x_m + self.along_m(time_s)

    def faster_mps(self, helicopter: Motion | None) -> float:
        """Return by how much the helicopter flies faster along the leg than predicted [m/s]."""
        if helicopter is None:
            return 0.0
        off = helicopter.course_rad - self.leg.heading_rad
        return helicopter.speed_mps * math.cos(off) - self.speed_mps

    @property
    def steady_s(self) -> float:
        """The time from which on the helicopter cruises along its last leg [s]."""
        return self.stretches[-1].time_s


def tables_of(forecasts: Sequence[Forecast]) -> FloatArray:
    """Return the tables of several forecasts, shape (f, 7, m), stretches that never come added."""
    tables = [forecast.table for forecast in forecasts]
    out = np.zeros((len(tables), 7, max(table.shape[1] for table in tables)))
    out[:, 0] = math.inf
    for i, table in enumerate(tables):
        out[i, :, : table.shape[1]] = table
    return out


def cruising(time_s: float, helicopter: Pose, speed_mps: float) -> Forecast:
    """Return the forecast of a helicopter that goes on along its leg."""
    return Forecast((Stretch(time_s, helicopter, speed_mps),), helicopter, time_s, speed_mps)


def departing(
    time_s: float, helicopter: Pose, now_mps: float, *, speed_mps: float, accel_mps2: float
) -> Forecast:
    """Return the forecast of a helicopter that speeds up from ``now_mps`` along its leg."""
    ramp_s = max(0.0, speed_mps - now_mps) / accel_mps2
    first = Stretch(time_s, helicopter, now_mps, accel_mps2)
    run = now_mps * ramp_s + 0.5 * accel_mps2 * ramp_s**2
    cruise = Stretch(time_s + ramp_s, helicopter.offset(run), speed_mps)
    zero = time_s + ramp_s - run / speed_mps
    return Forecast((first, cruise), helicopter, zero, speed_mps)


def along_list(motion: Motion, points: FloatArray, now_s: float, horizon_s: float) -> Forecast:
    """Return the forecast of another UAV: along a list, shape (n, 2) [m], at its present speed.

    Straight to each waypoint from where it is, for ``horizon_s``; behind the list, straight on.
    """
    speed = max(motion.speed_mps, LEAST_SPEED_MPS)
    here = motion.after(now_s - motion.time_s).pose
    stretches = [Stretch(now_s, here, speed)]
    time_s = now_s
    for x_m, y_m in points[_ahead(points, here) :].tolist():
        way_m = math.hypot(x_m - here.x_m, y_m - here.y_m)
        if way_m < LEAST_WAY_M or time_s > now_s + horizon_s:
            continue
        heading = math.atan2(y_m - here.y_m, x_m - here.x_m)
        stretches.append(Stretch(time_s, Pose(here.x_m, here.y_m, heading), speed))
        here, time_s = Pose(x_m, y_m, heading), time_s + way_m / speed
    last = stretches[-1]
    return Forecast(tuple(stretches), last.start, last.time_s, speed)


def along_lists(others: Sequence[OtherUav], now_s: float) -> list[Forecast]:
    """Return the forecasts of other UAVs, each along its list as far as it is known."""
    return [
        along_list(
            one.motion,
            np.empty((0, 2)) if one.flown is None else one.flown.points,
            now_s,
            OTHERS_HORIZON_S,
        )
        for one in others
    ]


def _ahead(points: FloatArray, here: Pose) -> int:
    """Return the number of the waypoint that is flown to: that ends the leg nearest to a pose."""
    if len(points) < 2:
        return 0
    at = np.array((here.x_m, here.y_m))
    ways = np.diff(points, axis=0)
    square = np.maximum(np.square(ways).sum(axis=1), LEAST_WAY_M**2)
    share = np.clip(((at - points[:-1]) * ways).sum(axis=1) / square, 0.0, 1.0)
    off = np.hypot(*(points[:-1] + share[:, None] * ways - at).T)
    leg = int(np.argmin(off))
    return leg if leg == 0 and share[0] <= 0.0 else leg + 1


def cornering(
    onset_s: float,
    stop: Pose,
    *,
    speed_mps: float,
    accel_mps2: float,
    turn_rad: float = -math.pi / 2.0,
    hover_s: float = 0.0,
    leaving_mps2: float | None = None,
) -> Forecast:
    """Return the forecast of a corner: slow with a, stand at ``stop``, turn, speed up with a.

    ``stop`` carries the incoming heading. ``leaving_mps2``: with which it speeds up, where that is
    another acceleration. With no hover 3 V^2 / 2a of cruise are lost in all, as
    in the paper's T_h = 3V/2a + Y/V.
    """
    stop_s = onset_s + speed_mps / accel_mps2
    stopping = speed_mps**2 / (2.0 * accel_mps2)
    slowing = Stretch(onset_s, stop.offset(-stopping), speed_mps, -accel_mps2)
    out = Pose(stop.x_m, stop.y_m, stop.heading_rad + turn_rad)
    leaving = accel_mps2 if leaving_mps2 is None else leaving_mps2
    then = departing(stop_s + hover_s, out, 0.0, speed_mps=speed_mps, accel_mps2=leaving)
    standing = (Stretch(stop_s, out, 0.0),) if hover_s > 0.0 else ()
    return Forecast((slowing, *standing, *then.stretches), out, then.zero_s, speed_mps)
