"""Paths and forecasts as tables, walked, and how much paths leave uncovered: compiled.

A path is a table of its parts, shape (5, n): x, y, heading, curvature (0 for straights) where each
begins, and the path distance there; the last part goes on for ever. A forecast is a table of its
stretches, shape (7, m): time, x, y, direction east and north, speed, acceleration; before the first
the helicopter cruised. SI units, radians.
"""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_planner.paths.flight_path import FloatArray


@compiled("UniTuple(float64, 2)(float64, float64, float64, float64, float64)")
def arc_end(
    x: float, y: float, heading: float, bend: float, length_m: float
) -> tuple[float, float]:
    """Return x and y behind an arc begun at a pose, or behind a straight: ``bend`` 0."""
    if bend == 0.0:
        return x + length_m * math.cos(heading), y + length_m * math.sin(heading)
    half = 0.5 * bend * length_m
    chord = length_m if abs(half) < 1e-9 else length_m * math.sin(half) / half
    return x + chord * math.cos(heading + half), y + chord * math.sin(heading + half)


@compiled("UniTuple(float64, 2)(float64[:, ::1], int64, float64)")
def place(parts: FloatArray, part: int, flown_m: float) -> tuple[float, float]:
    """Return x and y at a distance flown, on this part of a path."""
    along = flown_m - parts[4, part]
    return arc_end(parts[0, part], parts[1, part], parts[2, part], parts[3, part], along)


@compiled("float64(float64[:, ::1], int64, float64)")
def run_m(forecast: FloatArray, stretch: int, now_s: float) -> float:
    """Return how far the helicopter is along a stretch of its forecast at a time."""
    after = now_s - forecast[0, stretch]
    run: float = forecast[5, stretch] * after
    if after > 0.0:
        run += 0.5 * forecast[6, stretch] * after * after
    return run


@compiled("UniTuple(float64, 2)(float64[:, ::1], float64)")
def position_at(forecast: FloatArray, now_s: float) -> tuple[float, float]:
    """Return x and y of the helicopter at a time: ``Forecast.positions``."""
    stretch = 0
    while stretch + 1 < forecast.shape[1] and forecast[0, stretch + 1] <= now_s:
        stretch += 1
    run = run_m(forecast, stretch, now_s)
    return (
        forecast[1, stretch] + forecast[3, stretch] * run,
        forecast[2, stretch] + forecast[4, stretch] * run,
    )


@compiled("float64(float64[:, ::1], float64[::1], float64, float64, float64, float64[::1])")
def lay_out(
    parts: FloatArray, row: FloatArray, x: float, y: float, heading: float, radius: FloatArray
) -> float:
    """Fill ``parts``, shape (5, 9), with a batch's row that begins at a pose; return its length.

    ``radius``: of every one of the seven parts, 0 for a straight. Behind them it goes straight on.
    """
    flown = 0.0
    for i in range(row.size):
        parts[0, i], parts[1, i], parts[2, i], parts[4, i] = x, y, heading, flown
        if radius[i] == 0.0:
            parts[3, i] = 0.0
            x += row[i] * math.cos(heading)
            y += row[i] * math.sin(heading)
            flown += row[i]
        else:
            side = math.copysign(1.0, row[i])
            parts[3, i] = side / radius[i]
            half = 0.5 * row[i]
            chord = 2.0 * radius[i] * math.sin(abs(half))
            x += chord * math.cos(heading + half)
            y += chord * math.sin(heading + half)
            heading += row[i]
            flown += radius[i] * abs(row[i])
    last = row.size
    parts[0, last], parts[1, last], parts[2, last] = x, y, heading
    parts[3, last], parts[4, last] = 0.0, flown
    return flown


@compiled(
    "float64[::1](float64[:, ::1], float64[::1], float64[::1], float64[:, ::1], int64, float64,"
    " float64, float64)"
)
def uncovered_cells(
    rows: FloatArray,
    start: FloatArray,
    radius_m: FloatArray,
    cells: FloatArray,
    old: int,
    step_m: float,
    sight_m: float,
    edge_m: float,
) -> FloatArray:
    """Return how many of the cells, shape (m, 2) [m], every path leaves uncovered, shape (n,).

    The first ``old`` cells belong to the old track; of the others those beyond a path's end will be
    seen later. A cell counts by how far from ``sight_m``, over a width of ``edge_m``, it stays.
    Looked at every ``step_m`` along the path.
    """
    out = np.zeros(rows.shape[0])
    parts = np.empty((5, rows.shape[1] + 1))
    nearest = np.empty(cells.shape[0])
    for i in range(rows.shape[0]):
        length = lay_out(parts, rows[i], start[0], start[1], start[2], radius_m)
        end_x = parts[0, rows.shape[1]]
        nearest[:] = math.inf
        part, flown = 0, 0.0
        while flown < length + step_m:
            while part + 1 < parts.shape[1] and parts[4, part + 1] <= flown:
                part += 1
            x, y = place(parts, part, flown)
            for j in range(cells.shape[0]):
                gap_x, gap_y = cells[j, 0] - x, cells[j, 1] - y
                nearest[j] = min(nearest[j], gap_x * gap_x + gap_y * gap_y)
            flown += step_m
        for j in range(cells.shape[0]):
            if j < old or cells[j, 0] < end_x:
                share = (math.sqrt(nearest[j]) - sight_m) / edge_m + 0.5
                out[i] += min(max(share, 0.0), 1.0)
    return out
