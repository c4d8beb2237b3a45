"""The planner's inner loops, compiled: how near paths come, and how much they leave uncovered.

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

SAMPLE_M = 5.0


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
def _run_m(forecast: FloatArray, stretch: int, now_s: float) -> float:
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
    run = _run_m(forecast, stretch, now_s)
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
    "float64(float64[:, ::1], float64, float64[:, ::1], float64, float64, float64, float64,"
    " float64, float64, float64, float64)"
)
def least_apart(
    parts: FloatArray,
    length_m: float,
    forecast: FloatArray,
    start_s: float,
    steady_s: float,
    cruise_mps: float,
    speed_mps: float,
    lead_m: float,
    lead_mps: float,
    step_m: float,
    enough_m: float,
) -> float:
    """Return the least distance [m] of a path begun at ``start_s`` to a helicopter.

    The first ``lead_m`` are flown at ``lead_mps``, the rest at ``speed_mps``; behind its end the
    UAV goes on at the helicopter's ``cruise_mps``. Until the path is flown and the helicopter is
    steady. Looked at every ``step_m`` of the UAV's way, or less often while they are too far apart
    to come nearer than they were; no longer once nearer than ``enough_m``.
    """
    fastest = max(speed_mps, lead_mps)
    step_s = step_m / fastest
    closing = fastest
    for i in range(forecast.shape[1]):
        closing = max(closing, fastest + forecast[5, i])
    closing = max(closing, fastest + cruise_mps)
    lead_s = lead_m / lead_mps
    flown_s = lead_s + max(length_m - lead_m, 0.0) / speed_mps
    end_s = max(flown_s, steady_s - start_s, step_s)
    part = stretch = 0
    least, since = math.inf, 0.0
    while True:
        if since < lead_s:
            flown = lead_mps * since
        elif since < flown_s:
            flown = lead_m + speed_mps * (since - lead_s)
        else:
            flown = length_m + cruise_mps * (since - flown_s)
        while part + 1 < parts.shape[1] and parts[4, part + 1] <= flown:
            part += 1
        x, y = place(parts, part, flown)
        now = start_s + since
        while stretch + 1 < forecast.shape[1] and forecast[0, stretch + 1] <= now:
            stretch += 1
        run = _run_m(forecast, stretch, now)
        gap_x = x - forecast[1, stretch] - forecast[3, stretch] * run
        gap_y = y - forecast[2, stretch] - forecast[4, stretch] * run
        apart = math.sqrt(gap_x * gap_x + gap_y * gap_y)
        least = min(least, apart)
        if since >= end_s or least < enough_m:
            return least
        since = min(end_s, since + max(step_s, (apart - least) / closing))


@compiled(
    "float64[::1](float64[:, ::1], float64[::1], float64[::1], float64[:, ::1], float64, float64,"
    " float64, float64[::1], float64, float64, float64)"
)
def least_apart_of_each(
    rows: FloatArray,
    start: FloatArray,
    radius_m: FloatArray,
    forecast: FloatArray,
    start_s: float,
    steady_s: float,
    cruise_mps: float,
    speeds_mps: FloatArray,
    lead_mps: float,
    step_m: float,
    enough_m: float,
) -> FloatArray:
    """Return ``least_apart`` of every row of a batch, shape (n,) [m].

    ``start``: x, y and heading of all of them. ``lead_mps``: on their first straights; 0 for the
    speed that each has on the rest.
    """
    out = np.empty(rows.shape[0])
    parts = np.empty((5, rows.shape[1] + 1))
    for i in range(rows.shape[0]):
        length = lay_out(parts, rows[i], start[0], start[1], start[2], radius_m)
        speed = speeds_mps[i]
        out[i] = least_apart(
            parts,
            length,
            forecast,
            start_s,
            steady_s,
            cruise_mps,
            speed,
            rows[i, 0] if lead_mps > 0.0 else 0.0,
            lead_mps if lead_mps > 0.0 else speed,
            step_m,
            enough_m,
        )
    return out


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


@compiled("float64(float64, float64, int64)")
def turn_between(heading_rad: float, target_rad: float, side: int) -> float:
    """Return how far to turn to one side from a heading to another, from 0 to 2 pi."""
    turned = side * (target_rad - heading_rad)
    turned -= 2.0 * math.pi * math.floor(turned / (2.0 * math.pi))
    return 0.0 if turned > 2.0 * math.pi - 1e-9 else turned


@compiled(
    "float64[::1](float64[::1], float64[::1], float64, float64, float64[::1], float64[::1],"
    " int64[::1], float64, float64[:, :, ::1], float64[:, ::1], float64, float64, float64, float64)"
)
def soonest_intercept(
    start: FloatArray,
    radius_m: FloatArray,
    slow_factor: float,
    last_turn_rad: float,
    headings_1: FloatArray,
    headings_2: FloatArray,
    sides: FloatArray,
    detour_m: float,
    forecasts: FloatArray,
    steady: FloatArray,
    start_s: float,
    speed_mps: float,
    needed_m: float,
    before_s: float,
) -> FloatArray:
    """Return the soonest intercept that keeps ``needed_m``: its duration [s] and its row (7).

    The duration is infinite where none is sooner than ``before_s``. Over a grid of the headings on
    the two straights, which are solved for as by ``slot_intercept.InterceptProblem.solve``;
    ``sides``: of the first three turns. ``forecasts``: tables, shape (f, 7, m); ``steady``: when
    each is steady [s], and at what speed, shape (f, 2). In one piece: it is compiled, and its loops
    give a path up as soon as it cannot be the soonest.
    """
    radius = radius_m[1]
    last_side = 0.0 if last_turn_rad == 0.0 else math.copysign(1.0, last_turn_rad)
    sin_0, cos_0 = math.sin(start[2]), math.cos(start[2])
    sin_3, cos_3 = math.sin(-last_turn_rad), math.cos(last_turn_rad)
    sins, coss = np.sin(headings_2), np.cos(headings_2)
    lasts = np.empty(headings_2.size)
    for j in range(headings_2.size):
        lasts[j] = turn_between(headings_2[j], -last_turn_rad, sides[2])
    out = np.zeros(8)
    out[0] = before_s
    row = np.zeros(7)
    row[6] = last_turn_rad
    parts = np.empty((5, 8))
    found = False
    for heading_1 in headings_1:
        sin_1, cos_1 = math.sin(heading_1), math.cos(heading_1)
        turn_1 = turn_between(start[2], heading_1, sides[0])
        lateral_1 = sides[0] * (cos_0 - cos_1) + last_side * (cos_3 - 1.0)
        forward_1 = sides[0] * (sin_1 - sin_0) - last_side * sin_3
        turned = turn_1 + abs(last_turn_rad)
        for j in range(headings_2.size):
            sin_2, cos_2 = sins[j], coss[j]
            det = sin_1 * (slow_factor - cos_2) - sin_2 * (slow_factor - cos_1)
            if abs(det) < 1e-3:
                continue
            turn_2 = turn_between(heading_1, headings_2[j], sides[1])
            arcs = radius * (turned + turn_2 + lasts[j])
            if arcs >= out[0] * speed_mps:
                continue
            lateral = lateral_1 + sides[1] * (cos_1 - cos_2) + sides[2] * (cos_2 - cos_3)
            forward = forward_1 + sides[1] * (sin_2 - sin_1) + sides[2] * (sin_3 - sin_2)
            want_y = -start[1] - radius * lateral
            want_e = detour_m - slow_factor * arcs + radius * forward
            first = (want_y * (slow_factor - cos_2) - sin_2 * want_e) / det
            second = (sin_1 * want_e - (slow_factor - cos_1) * want_y) / det
            time = (arcs + first + second) / speed_mps
            if first < -1e-9 or second < -1e-9 or time >= out[0]:
                continue
            row[1], row[2], row[3] = sides[0] * turn_1, max(first, 0.0), sides[1] * turn_2
            row[4], row[5] = max(second, 0.0), sides[2] * lasts[j]
            length = lay_out(parts, row, start[0], start[1], start[2], radius_m)
            kept = True
            for f in range(forecasts.shape[0]):
                if kept:
                    least = least_apart(
                        parts,
                        length,
                        forecasts[f],
                        start_s,
                        steady[f, 0],
                        steady[f, 1],
                        speed_mps,
                        0.0,
                        speed_mps,
                        SAMPLE_M,
                        needed_m,
                    )
                    kept = least >= needed_m
            if kept:
                found = True
                out[0] = time
                out[1:] = row
    if not found:
        out[0] = math.inf
    return out
