"""How much of the ground speed asked for a UAV makes good along a path, in wind. Pure.

Its airspeed is a state: it changes no faster than ``ACCEL_MPS2``, and stays within its limits. What
is asked for is the airspeed for the course on which the UAV will be some seconds later.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_estimator.common.states import Motion
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.paths.flight_path import FlightPath, FloatArray
from sar_planner.prediction.forecast import Forecast

ACCEL_MPS2 = 1.0
"""With which a small aeroplane changes its airspeed under ArduPlane's TECS, about."""
STEP_M = 10.0
LEAST_MPS = 2.0
LEAST_SHARE, MOST_SHARE = 0.5, 1.5


@compiled("f8[::1](f8, f8)")
def places_along(from_m: float, left_m: float) -> FloatArray:
    """Return distances evenly from one on [m], both ends included, ``STEP_M`` apart at most."""
    count = max(2, math.ceil(left_m / STEP_M) + 1)
    step_m = left_m / (count - 1)
    out = np.empty(count)
    for i in range(count - 1):
        out[i] = from_m + i * step_m
    out[count - 1] = from_m + left_m
    return out


@compiled("UniTuple(f8[::1], 2)(f8[:, ::1], f8, f8, f8, UniTuple(f8, 2), UniTuple(f8, 2), f8, f8)")
def _times_along(
    parts: FloatArray,
    from_m: float,
    left_m: float,
    wanted_mps: float,
    wind_mps: tuple[float, float],
    limits_mps: tuple[float, float],
    airspeed_mps: float,
    lead_s: float,
) -> tuple[FloatArray, FloatArray]:
    """Return distances along a path [m], ``STEP_M`` apart, and when a UAV is there [s].

    Shapes (n,). ``parts``: as of ``FlightPath.parts``. ``left_m``: of the path from ``from_m`` on.
    ``airspeed_mps``: now; ``limits_mps``: the slowest and the fastest that it may become, as wanted
    where that has no end. ``lead_s``: for how much later it is told.
    """
    along_m = places_along(from_m, left_m)
    out = np.zeros(along_m.shape[0])
    slowest_mps, fastest_mps = limits_mps
    if math.isinf(fastest_mps):
        for i in range(along_m.shape[0]):
            out[i] = (along_m[i] - from_m) / wanted_mps
        return along_m, out
    wind_x_mps, wind_y_mps = wind_mps
    count = parts.shape[1]
    part = ahead = 0
    ground = wanted_mps
    for i in range(along_m.shape[0] - 1):
        at = along_m[i]
        while part + 1 < count and parts[4, part + 1] <= at:
            part += 1
        then = at + lead_s * ground
        ahead = max(ahead, part)
        while ahead + 1 < count and parts[4, ahead + 1] <= then:
            ahead += 1
        course = parts[2, part] + parts[3, part] * (at - parts[4, part])
        later = parts[2, ahead] + parts[3, ahead] * (then - parts[4, ahead])
        needed = math.hypot(
            wanted_mps * math.cos(later) - wind_x_mps, wanted_mps * math.sin(later) - wind_y_mps
        )
        needed = min(max(needed, slowest_mps), fastest_mps)
        along = wind_x_mps * math.cos(course) + wind_y_mps * math.sin(course)
        across = wind_y_mps * math.cos(course) - wind_x_mps * math.sin(course)
        ground = along + math.sqrt(max(airspeed_mps**2 - across**2, 0.0))
        ground = max(ground, LEAST_MPS)
        since = (along_m[i + 1] - at) / ground
        most = ACCEL_MPS2 * since
        airspeed_mps += min(max(needed - airspeed_mps, -most), most)
        out[i + 1] = out[i] + since
    return along_m, out


def airspeed_of(uav: Motion, air: AirEnvelope) -> float:
    """Return the airspeed of a motion [m/s]: the wind triangle."""
    return math.hypot(uav.vx_mps - air.wind_mps[0], uav.vy_mps - air.wind_mps[1])


@dataclass(frozen=True)
class FlownPath:
    """When a UAV will be where along the rest of a path in the map.

    ``times_s``: from now on, ``along_m``: how far along it is then, shapes (n,). ``share``: what it
    makes good of the ground speed wanted.
    """

    path: FlightPath
    along_m: FloatArray
    times_s: FloatArray
    share: float

    @cached_property
    def points_m(self) -> FloatArray:
        """Where it is at these times, shape (n, 2)."""
        return self.path.points(self.along_m)

    def apart_m(self, forecast: Forecast, now_s: float) -> float:
        """Return the least distance [m] to the helicopter of a forecast at these times."""
        gaps = self.points_m - forecast.positions(now_s + self.times_s)
        return float(np.hypot(*gaps.T).min())


def flown(
    path: FlightPath,
    wanted_mps: float,
    air: AirEnvelope,
    airspeed_mps: float,
    *,
    from_m: float = 0.0,
    lead_s: float = 0.0,
) -> FlownPath:
    """Return how the rest of a path in the map is flown.

    ``wanted_mps``: the ground speed; it is flown where the airspeeds are not known.
    ``airspeed_mps``: now. ``from_m``: where the UAV is along the path. ``lead_s``: for how much
    later it is told its airspeed.
    """
    left_m = max(path.length_m - from_m, 0.0)
    along_m, times_s = _times_along(
        path.parts,
        from_m,
        left_m,
        wanted_mps,
        air.wind_mps,
        (air.slowest_mps, air.fastest_mps),
        airspeed_mps,
        lead_s,
    )
    share = left_m / (wanted_mps * float(times_s[-1])) if left_m >= STEP_M else 1.0
    return FlownPath(path, along_m, times_s, min(max(share, LEAST_SHARE), MOST_SHARE))
