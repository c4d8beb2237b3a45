"""Distance between the two aircraft over time, during a corner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sar_planner.geometry import FlightPath, FloatArray
from sar_planner.parameters import CornerParameters


@dataclass(frozen=True, slots=True)
class ClosestApproach:
    """The least distance [m] and its time [s] after the helicopter begins to slow."""

    distance_m: float
    time_s: float


def helicopter_positions(times_s: FloatArray, p: CornerParameters) -> FloatArray:
    """Return the helicopter's positions, shape (n, 2) [m], in the corner's frame.

    It slows from (-s, 0) with constant a, turns on the spot, accelerates down x = 0 with a.
    """
    v, a, s = p.speed_mps, p.accel_mps2, p.stopping_m
    stop = v / a
    slowing = np.clip(times_s, 0.0, stop)
    x = -s + v * np.minimum(times_s, slowing) - 0.5 * a * slowing**2
    going = np.clip(times_s - stop, 0.0, stop)
    y = -0.5 * a * going**2 - v * np.maximum(times_s - 2.0 * stop, 0.0)
    return np.column_stack((x, y))


def closest_approach(path: FlightPath, p: CornerParameters) -> ClosestApproach:
    """Return the closest approach while the path is flown at V and the helicopter turns.

    Counted from the helicopter's slowing until the UAV has ended its path and the helicopter is
    back at V; from then on the distance is constant.
    """
    end_s = max(path.length_m / p.speed_mps, 2.0 * p.speed_mps / p.accel_mps2)

    def nearest(low_s: float, high_s: float, count: int) -> tuple[float, float, float]:
        times = np.linspace(low_s, high_s, count)
        gap = path.points(times * p.speed_mps) - helicopter_positions(times, p)
        distances = np.hypot(gap[:, 0], gap[:, 1])
        best = int(distances.argmin())
        return float(distances[best]), float(times[best]), float(times[1] - times[0])

    distance, time, step = nearest(0.0, end_s, max(3, int(end_s / 0.1)))
    while step > 1e-6:
        low, high = max(0.0, time - step), min(end_s, time + step)
        distance, time, step = nearest(low, high, 41)
    return ClosestApproach(distance, time)
