"""Dubins' words: the paths of two or three arcs that can be shortest, or of exactly a length.

L. E. Dubins (1957); the closed forms follow A. M. Shkel and V. Lumelsky, Classification of the
Dubins set (2001). All words are returned, not only the shortest, and those of three arcs with a
long and with a short middle one: what can be reached with a path of exactly some length is bounded
by poses that such words reach (V. Patsko, S. Pyatko, A. Fedotov, 2003).
"""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_estimator.common.pose import Pose
from sar_planner.paths.flight_path import FloatArray
from sar_planner.paths.slot_intercept import STRAIGHTS, TURNS

TWO_PI = 2.0 * math.pi
WORDS = ("LSL", "RSR", "LSR", "RSL", "RLR", "LRL", "RLR", "LRL")
FIRST, STRAIGHT, MIDDLE, LAST = 1, 2, 3, 5


@compiled("float64(float64)")
def _positive(angle_rad: float) -> float:
    """Return the same direction from 0 to 2 pi."""
    turned = angle_rad - TWO_PI * math.floor(angle_rad / TWO_PI)
    return 0.0 if turned > TWO_PI - 1e-9 else turned


@compiled("void(float64, float64, float64, float64[:, ::1])")
def _with_straight(a: float, b: float, gap: float, out: FloatArray) -> None:
    """Fill in the words CSC; angles [rad] from the line to the target, ``gap`` in radii."""
    ca, sa, cb, sb, cab = math.cos(a), math.sin(a), math.cos(b), math.sin(b), math.cos(a - b)
    for word in range(4):
        left_first, same = word in (0, 2), word < 2
        side = 1.0 if left_first else -1.0
        turned = sa - sb if same else sa + sb
        square = gap * gap + 2.0 * gap * side * turned
        square += 2.0 - 2.0 * cab if same else 2.0 * cab - 2.0
        if square < (-1e-12 if same else 0.0):
            continue
        straight = math.sqrt(max(square, 0.0))
        if same:
            line = math.atan2(side * (cb - ca), gap + side * turned)
        else:
            line = math.atan2(-side * (ca + cb), gap + side * turned)
            line -= math.atan2(-2.0 * side, straight)
        last_side = side if same else -side
        out[word, FIRST] = side * _positive(side * (line - a))
        out[word, STRAIGHT] = straight
        out[word, LAST] = last_side * _positive(last_side * (b - line))


@compiled("void(float64, float64, float64, float64[:, ::1])")
def _of_arcs(a: float, b: float, gap: float, out: FloatArray) -> None:
    """Fill in the words CCC, as ``_with_straight``."""
    ca, sa, cb, sb, cab = math.cos(a), math.sin(a), math.cos(b), math.sin(b), math.cos(a - b)
    for word in range(4, 8):
        side = -1.0 if word in (4, 6) else 1.0
        turned = side * (sa - sb)
        cosine = (6.0 - gap * gap + 2.0 * cab - 2.0 * gap * turned) / 8.0
        if abs(cosine) > 1.0:
            continue
        small = math.acos(cosine)
        middle = TWO_PI - small if word < 6 else small
        line = math.atan2(side * (cb - ca), gap + turned)
        first = _positive(side * (line - a) + 0.5 * middle)
        out[word, FIRST] = side * first
        out[word, MIDDLE] = -side * middle
        out[word, LAST] = side * _positive(side * (b - a) - first + middle)


@compiled("void(float64, float64, float64, float64, float64, float64[:, ::1])")
def fill_words(
    dx_m: float, dy_m: float, start_rad: float, end_rad: float, radius_m: float, out: FloatArray
) -> None:
    """Fill ``out``, shape (8, 7), with the words to a pose ``dx_m``, ``dy_m`` away: ``words``."""
    bearing = math.atan2(dy_m, dx_m)
    gap = math.hypot(dx_m, dy_m) / radius_m
    a, b = _positive(start_rad - bearing), _positive(end_rad - bearing)
    out[:, :] = 0.0
    out[:, FIRST] = math.nan
    _with_straight(a, b, gap, out)
    _of_arcs(a, b, gap, out)
    for word in range(out.shape[0]):
        if math.isnan(out[word, FIRST]):
            out[word, :] = math.nan
        out[word, STRAIGHT] *= radius_m


@compiled("float64[:, :, ::1](float64[::1], float64[:, ::1], float64)")
def _words_to_each(start: FloatArray, targets: FloatArray, radius_m: float) -> FloatArray:
    """Return ``words``, the target's axis first: shape (n, 8, 7)."""
    rows = np.empty((targets.shape[0], 8, 7))
    for i in range(targets.shape[0]):
        fill_words(
            targets[i, 0] - start[0],
            targets[i, 1] - start[1],
            start[2],
            targets[i, 2],
            radius_m,
            rows[i],
        )
    return rows


def words(start: Pose, targets: FloatArray, radius_m: float) -> FloatArray:
    """Return all words from ``start`` to every target pose, shape (8, n, 7).

    ``targets``: x, y, heading, shape (n, 3). The last axis is a row of ``PathBatch``: straights
    [m] and turns [rad] by turns; NaN where a word does not exist. The order is ``WORDS``.
    """
    begin = np.array((start.x_m, start.y_m, start.heading_rad))
    rows = _words_to_each(begin, np.ascontiguousarray(targets, dtype=np.float64), radius_m)
    return rows.transpose(1, 0, 2)


def lengths_m(rows: FloatArray, radius_m: float) -> FloatArray:
    """Return the lengths [m] of rows, shape (..., 7)."""
    size = np.abs(rows)
    straights: FloatArray = size[..., STRAIGHTS].sum(axis=-1)
    arcs: FloatArray = radius_m * size[..., TURNS].sum(axis=-1)
    return straights + arcs
