"""Distance between the two aircraft over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.apart_kernels import (
    knots_for,
    least_apart,
    least_apart_of_each,
    least_until,
)
from sar_planner.paths.flight_path import FlightPath, FloatArray
from sar_planner.paths.slot_intercept import PathBatch, radii_m
from sar_planner.prediction.forecast import Forecast, cornering

BESIDE_S = 6.0


@dataclass(frozen=True, slots=True)
class ClosestApproach:
    """The least distance [m] and its time [s] after the path's beginning."""

    distance_m: float
    time_s: float


def corner_forecast(
    p: CornerParameters,
    turn_rad: float = 0.5 * math.pi,
    *,
    hover_s: float = 0.0,
    at_m: float = 0.0,
) -> Forecast:
    """Return the helicopter's motion at a corner, in the corner's frame, slowing from time 0.

    ``hover_s``: for how long it stands there. ``at_m``: so far beyond the corner, and later [m].
    """
    return cornering(
        at_m / p.speed_mps,
        Pose(at_m, 0.0, 0.0),
        speed_mps=p.speed_mps,
        accel_mps2=p.accel_mps2,
        turn_rad=-turn_rad,
        hover_s=hover_s,
    )


def closest_approach(
    path: FlightPath, p: CornerParameters, turn_rad: float = 0.5 * math.pi
) -> ClosestApproach:
    """Return the closest approach while the path is flown at V and the helicopter turns."""
    forecast = corner_forecast(p, turn_rad)
    return closest_over_time(path, forecast, start_s=0.0, speed_mps=p.speed_mps)


def closest_over_time(
    path: FlightPath, forecast: Forecast, *, start_s: float, speed_mps: float
) -> ClosestApproach:
    """Return the closest approach of a path begun at ``start_s`` and flown at ``speed_mps``.

    Until the UAV has ended its path and the helicopter is back at V; from then on, at equal
    speeds, the distance is constant.
    """
    end_s = max(path.length_m / speed_mps, forecast.steady_s - start_s, 1e-3)

    def nearest(low_s: float, high_s: float, count: int) -> tuple[float, float, float]:
        times = np.linspace(low_s, high_s, count)
        gap = path.points(times * speed_mps) - forecast.positions(start_s + times)
        distances = np.hypot(gap[:, 0], gap[:, 1])
        best = int(distances.argmin())
        return float(distances[best]), float(times[best]), float(times[1] - times[0])

    distance, time, step = nearest(0.0, end_s, max(3, int(end_s / 0.1)))
    while step > 1e-6:
        low, high = max(0.0, time - step), min(end_s, time + step)
        distance, time, step = nearest(low, high, 41)
    return ClosestApproach(distance, time)


def least_apart_m(
    path: FlightPath, forecasts: Sequence[Forecast], *, start_s: float, speed_mps: float
) -> float:
    """Return the least distance [m] of a path to any of several forecasts, a lower bound.

    No more than ``TOLERANCE_M`` below it (``apart_kernels``). Each forecast is looked at for as
    long as by ``closest_over_time``.
    """
    pace = (0.0, speed_mps, path.length_m, speed_mps, speed_mps)
    least = math.inf
    for forecast in forecasts:
        table = forecast.table
        knots = knots_for(path.parts.shape[1], table.shape[1])
        one = least_apart(path.parts, pace, table, start_s, forecast.steady_s, 0.0, least, knots)
        least = min(least, one)
    return least


def apart_for_m(
    path: FlightPath, forecast: Forecast, for_s: float, *, start_s: float, speed_mps: float
) -> float:
    """Return the least distance [m], a lower bound as ``least_apart_m``, for so long."""
    pace = (0.0, speed_mps, path.length_m, speed_mps, speed_mps)
    table = forecast.table
    knots = knots_for(path.parts.shape[1], table.shape[1])
    return least_until(path.parts, pace, table, start_s, for_s, 0.0, math.inf, knots)


def beside_apart_m(
    path: FlightPath,
    beside_m: tuple[float, float],
    forecasts: Sequence[Forecast],
    *,
    start_s: float,
    speed_mps: float,
) -> float:
    """Return the least distance [m], for ``BESIDE_S``, of a UAV that flies beside its path.

    A lower bound, as ``least_apart_m``. ``beside_m``: how far, in x and y. Later it will have come
    back to it.
    """
    start = path.start
    moved = Pose(start.x_m + beside_m[0], start.y_m + beside_m[1], start.heading_rad)
    flown = FlightPath(moved, path.segments)
    return min(
        apart_for_m(flown, forecast, BESIDE_S, start_s=start_s, speed_mps=speed_mps)
        for forecast in forecasts
    )


def least_of_all_m(
    batch: PathBatch,
    forecasts: Sequence[Forecast],
    *,
    start_s: float,
    speeds_mps: float | FloatArray,
    kept_m: float | None = None,
) -> FloatArray:
    """Return the least distance on every path, shape (n,) [m], over several forecasts.

    A lower bound, as ``least_distances_m``.
    """
    least = np.full(len(batch), math.inf)
    for forecast in forecasts:
        one = least_distances_m(
            batch, forecast, start_s=start_s, speeds_mps=speeds_mps, kept_m=kept_m
        )
        least = np.minimum(least, one)
    return least


def least_distances_m(
    batch: PathBatch,
    forecast: Forecast,
    *,
    start_s: float,
    speeds_mps: float | FloatArray,
    lead_mps: float | None = None,
    kept_m: float | None = None,
) -> FloatArray:
    """Return the least distance to the helicopter on every path, shape (n,) [m].

    A lower bound, no more than ``TOLERANCE_M`` below it (``apart_kernels``). ``speeds_mps``: one
    for all paths, or one for each; ``lead_mps``: that on the first straights where it is another
    one. ``kept_m``: where it is only asked whether that is kept, the distance need be no more than
    sure to be no less, or to be less. Looked at until a path is flown and the helicopter is back at
    V. On the slot track, at V, the distance no longer changes.
    """
    speeds = np.empty(len(batch))
    speeds[:] = speeds_mps
    return least_apart_of_each(
        batch.rows,
        batch.start_values,
        radii_m(batch.radius_m),
        forecast.table,
        start_s,
        forecast.steady_s,
        forecast.speed_mps,
        speeds,
        0.0 if lead_mps is None else lead_mps,
        0.0 if kept_m is None else kept_m,
        math.inf if kept_m is None else kept_m,
    )
