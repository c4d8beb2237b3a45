"""How much of the ground speed asked for a UAV makes good along a path, in wind. Pure.

Its airspeed is a state: it changes no faster than ``ACCEL_MPS2``, and stays within its limits. What
is asked for is the airspeed for the course on which the UAV will be some seconds later.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_estimator.common.states import Motion
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.paths.flight_path import FlightPath, FloatArray

ACCEL_MPS2 = 1.0
"""With which a small aeroplane changes its airspeed under ArduPlane's TECS, about."""
STEP_M = 10.0
LEAST_MPS = 2.0
LEAST_SHARE, MOST_SHARE = 0.5, 1.5


@compiled("float64[::1](float64[:, ::1], float64[::1], float64, float64[::1])")
def _times_along(
    parts: FloatArray, along_m: FloatArray, wanted_mps: float, air: FloatArray
) -> FloatArray:
    """Return when a UAV is at distances along a path [m], shape (n,), from the first on [s].

    ``parts``: as of ``FlightPath.parts``. ``air``: wind x and y, the slowest, the fastest and the
    present airspeed [m/s], for how much later it is told [s], with what it changes [m/s^2].
    """
    wind_x_mps, wind_y_mps, slowest_mps, fastest_mps, airspeed_mps, lead_s, accel_mps2 = air
    count = parts.shape[1]
    part = ahead = 0
    ground = wanted_mps
    out = np.zeros(along_m.shape[0])
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
        most = accel_mps2 * since
        airspeed_mps += min(max(needed - airspeed_mps, -most), most)
        out[i + 1] = out[i] + since
    return out


def airspeed_of(uav: Motion, air: AirEnvelope) -> float:
    """Return the airspeed of a motion [m/s]: the wind triangle."""
    return math.hypot(uav.vx_mps - air.wind_mps[0], uav.vy_mps - air.wind_mps[1])


class FlownPath(NamedTuple):
    """When a UAV will be where along the rest of a path in the map.

    ``times_s``: from now on, ``points_m``: where it is then, shapes (n,), (n, 2). ``share``: what
    it makes good of the ground speed wanted.
    """

    times_s: FloatArray
    points_m: FloatArray
    share: float


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
    along_m = from_m + np.linspace(0.0, left_m, max(2, math.ceil(left_m / STEP_M) + 1))
    if math.isfinite(air.fastest_mps):
        limits = (air.slowest_mps, air.fastest_mps)
        given = np.array((*air.wind_mps, *limits, airspeed_mps, lead_s, ACCEL_MPS2))
        times_s = _times_along(path.parts, along_m, wanted_mps, given)
    else:
        times_s = (along_m - from_m) / wanted_mps
    share = left_m / (wanted_mps * times_s[-1]) if left_m >= STEP_M else 1.0
    return FlownPath(times_s, path.points(along_m), min(max(share, LEAST_SHARE), MOST_SHARE))
