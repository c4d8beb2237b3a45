"""How near a path comes to a forecast, bounded from below, compiled.

Where neither a part of the path nor a stretch of the forecast ends, the way from the helicopter to
the UAV is r(t), with |r''| <= A = v^2 / R + |a|. Over a piece of such a time, h long, it is no
farther than A h^2 / 8 from the chord of its ends. So the least distance of the piece is the chord's
from the origin, that much more or less: exactly the chord's where both are straight and uniform.
Pieces are halved until that is sure enough.

Tables are those of ``kernels``. A forecast's way must have no jumps. A path's *pace* is
(lead_m, lead_mps, length_m, speed_mps, cruise_mps): the first ``lead_m`` are flown at ``lead_mps``,
the rest at ``speed_mps``, what is behind its end at ``cruise_mps``.
"""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_planner.paths.flight_path import FloatArray
from sar_planner.paths.kernels import lay_out, place, run_m

Pace = tuple[float, float, float, float, float]

TOLERANCE_M = 0.1
ROUNDING_M = 1e-5  # of what is computed from times since 1970
SAME_S, LEAST_S = 1e-9, 1e-3
HALVINGS = 40
(
    SINCE_S,  # after the path's beginning
    GAP_X,  # from the helicopter to the UAV [m]
    GAP_Y,
    BENT_MPS2,  # A, on the piece that ends here
    PART,  # of the path, on that piece
    STRETCH,  # of the forecast, on that piece; -1 before the first
    KNOT,  # how many of these there are
) = range(7)


@compiled("float64[:, ::1](int64, int64)")
def knots_for(parts: int, stretches: int) -> FloatArray:
    """Return room for the pieces of a path and a forecast of so many parts and stretches."""
    return np.empty((parts + stretches + HALVINGS, KNOT))


@compiled("float64(float64, float64, float64, float64)")
def from_origin(a_x: float, a_y: float, b_x: float, b_y: float) -> float:
    """Return how far the straight from a to b is from the origin."""
    way_x, way_y = b_x - a_x, b_y - a_y
    square = way_x * way_x + way_y * way_y
    if square > 0.0:
        share = min(max(-(a_x * way_x + a_y * way_y) / square, 0.0), 1.0)
        a_x += share * way_x
        a_y += share * way_y
    return math.sqrt(a_x * a_x + a_y * a_y)


@compiled("UniTuple(float64, 2)(UniTuple(float64, 5))")
def _phase_ends_s(pace: Pace) -> tuple[float, float]:
    """Return when the lead-in is flown, and the path [s]."""
    lead_m, lead_mps, length_m, speed_mps, _ = pace
    lead_s = lead_m / lead_mps
    return lead_s, lead_s + max(length_m - lead_m, 0.0) / speed_mps


@compiled(
    "float64(float64[:, ::1], UniTuple(float64, 5), float64[:, ::1], float64, float64[:, ::1],"
    " int64)"
)
def _fill_gap(
    parts: FloatArray, pace: Pace, forecast: FloatArray, start_s: float, knots: FloatArray, at: int
) -> float:
    """Fill in the gap of a knot whose time, part and stretch are known; return the distance."""
    lead_m, lead_mps, length_m, speed_mps, cruise_mps = pace
    since = knots[at, SINCE_S]
    lead_s, flown_s = _phase_ends_s(pace)
    if since < lead_s:
        flown = lead_mps * since
    elif since < flown_s:
        flown = lead_m + speed_mps * (since - lead_s)
    else:
        flown = length_m + cruise_mps * (since - flown_s)
    x, y = place(parts, int(knots[at, PART]), flown)
    stretch = max(int(knots[at, STRETCH]), 0)
    run = run_m(forecast, stretch, start_s + since)
    x -= forecast[1, stretch] + forecast[3, stretch] * run
    y -= forecast[2, stretch] + forecast[4, stretch] * run
    knots[at, GAP_X], knots[at, GAP_Y] = x, y
    return math.sqrt(x * x + y * y)


@compiled(
    "Tuple((float64, int64))(float64[:, ::1], UniTuple(float64, 5), float64[:, ::1], float64,"
    " float64, float64, float64[:, ::1])"
)
def _cut_at_kinks(
    parts: FloatArray,
    pace: Pace,
    forecast: FloatArray,
    start_s: float,
    end_s: float,
    enough_m: float,
    knots: FloatArray,
) -> tuple[float, int]:
    """Fill ``knots`` with the ends of the pieces without kinks; return the least there, how many.

    No further once nearer than ``enough_m``. A least distance of 0 where there is no room for all.
    """
    lead_m, lead_mps, length_m, speed_mps, cruise_mps = pace
    lead_s, flown_s = _phase_ends_s(pace)
    last_part, last_stretch = parts.shape[1] - 1, forecast.shape[1] - 1
    part, stretch = 0, -1
    since, count, least = 0.0, 1, math.inf
    while count < knots.shape[0]:
        # The phase, the part and the stretch that begin with this time.
        if since < lead_s - SAME_S:
            mps, begun_s, begun_m, until = lead_mps, 0.0, 0.0, lead_s
        elif since < flown_s - SAME_S:
            mps, begun_s, begun_m, until = speed_mps, lead_s, lead_m, flown_s
        else:
            mps, begun_s, begun_m, until = cruise_mps, flown_s, length_m, math.inf
            part = last_part
        slack_m = SAME_S * mps
        flown = begun_m + mps * (since - begun_s)
        while part < last_part and parts[4, part + 1] <= flown + slack_m:
            part += 1
        while stretch < last_stretch and forecast[0, stretch + 1] - start_s <= since + SAME_S:
            stretch += 1
        if count == 1:
            knots[0, SINCE_S], knots[0, PART], knots[0, STRETCH] = 0.0, part, stretch
            least = _fill_gap(parts, pace, forecast, start_s, knots, 0)
        if since >= end_s or least < enough_m:
            return least, count
        if part < last_part:
            until = min(until, begun_s + (parts[4, part + 1] - begun_m) / mps)
        if stretch < last_stretch:
            until = min(until, forecast[0, stretch + 1] - start_s)
        since = min(until, end_s)
        knots[count, SINCE_S], knots[count, PART], knots[count, STRETCH] = since, part, stretch
        bent = abs(parts[3, part]) * mps * mps
        if stretch >= 0:
            bent += abs(forecast[6, stretch])
        knots[count, BENT_MPS2] = bent
        least = min(least, _fill_gap(parts, pace, forecast, start_s, knots, count))
        count += 1
    return 0.0, 1


@compiled(
    "float64(float64[:, ::1], UniTuple(float64, 5), float64[:, ::1], float64, float64, float64,"
    " float64, float64[:, ::1])"
)
def least_until(
    parts: FloatArray,
    pace: Pace,
    forecast: FloatArray,
    start_s: float,
    end_s: float,
    enough_m: float,
    sure_m: float,
    knots: FloatArray,
) -> float:
    """Return a lower bound of the least distance [m] of a path, for ``end_s`` from its beginning.

    The path is begun at ``start_s``. The bound is at most ``TOLERANCE_M`` (and ``ROUNDING_M``)
    below the least distance. Where that is less than ``enough_m``, what is returned is less too,
    but need be no bound; where it is more than ``sure_m``, the bound need be no more than that.
    NaN where something is not finite. ``knots``: of ``knots_for``, is written to.
    """
    nearest, count = _cut_at_kinks(parts, pace, forecast, start_s, end_s, enough_m, knots)
    bound, fullest = nearest, knots.shape[0] - 1
    while count > 1 and nearest >= enough_m:
        last = count - 1
        first = last - 1
        chord = from_origin(
            knots[first, GAP_X], knots[first, GAP_Y], knots[last, GAP_X], knots[last, GAP_Y]
        )
        lasts = knots[last, SINCE_S] - knots[first, SINCE_S]
        bulge = 0.125 * knots[last, BENT_MPS2] * lasts * lasts
        nearest = min(nearest, chord + bulge)
        below = chord - bulge
        unsure = below < min(bound, sure_m, nearest - TOLERANCE_M)
        if not (unsure and lasts > LEAST_S and last < fullest):
            if not below >= bound:
                bound = below
            count -= 1
            continue
        knots[count] = knots[last]
        knots[last, SINCE_S] -= 0.5 * lasts
        nearest = min(nearest, _fill_gap(parts, pace, forecast, start_s, knots, last))
        count += 1
    return max(min(bound, nearest) - ROUNDING_M, 0.0)


@compiled(
    "float64(float64[:, ::1], UniTuple(float64, 5), float64[:, ::1], float64, float64, float64,"
    " float64, float64[:, ::1])"
)
def least_apart(
    parts: FloatArray,
    pace: Pace,
    forecast: FloatArray,
    start_s: float,
    steady_s: float,
    enough_m: float,
    sure_m: float,
    knots: FloatArray,
) -> float:
    """Return ``least_until`` the path is flown and the helicopter is steady, at ``steady_s``."""
    end_s = max(_phase_ends_s(pace)[1], steady_s - start_s)
    return least_until(parts, pace, forecast, start_s, end_s, enough_m, sure_m, knots)


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
    enough_m: float,
    sure_m: float,
) -> FloatArray:
    """Return ``least_apart`` of every row of a batch, shape (n,) [m].

    ``start``: x, y and heading of all of them. ``lead_mps``: on their first straights; 0 for the
    speed that each has on the rest. ``cruise_mps``: behind their ends.
    """
    out = np.empty(rows.shape[0])
    parts = np.empty((5, rows.shape[1] + 1))
    knots = knots_for(parts.shape[1], forecast.shape[1])
    for i in range(rows.shape[0]):
        length = lay_out(parts, rows[i], start[0], start[1], start[2], radius_m)
        speed = speeds_mps[i]
        pace = (0.0, speed, length, speed, cruise_mps)
        if lead_mps > 0.0:
            pace = (rows[i, 0], lead_mps, length, speed, cruise_mps)
        out[i] = least_apart(parts, pace, forecast, start_s, steady_s, enough_m, sure_m, knots)
    return out
