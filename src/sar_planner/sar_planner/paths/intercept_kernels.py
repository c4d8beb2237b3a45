"""Intercepts of the slot that stay apart, the soonest of a grid of headings: compiled."""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_planner.paths.apart_kernels import knots_for, least_apart
from sar_planner.paths.flight_path import FloatArray
from sar_planner.paths.kernels import lay_out


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
    knots = knots_for(8, forecasts.shape[2])
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
                    pace = (0.0, speed_mps, length, speed_mps, steady[f, 1])
                    least = least_apart(
                        parts, pace, forecasts[f], start_s, steady[f, 0], needed_m, needed_m, knots
                    )
                    kept = least >= needed_m
            if kept:
                out[0] = time
                out[1:] = row
    if out[0] >= before_s:
        out[0] = math.inf
    return out
