"""Dubins' words: the paths of two or three arcs that can be shortest, or of exactly a length.

L. E. Dubins (1957); the closed forms follow A. M. Shkel and V. Lumelsky, Classification of the
Dubins set (2001). All words are returned, not only the shortest, and those of three arcs with a
long and with a short middle one: what can be reached with a path of exactly some length is bounded
by poses that such words reach (V. Patsko, S. Pyatko, A. Fedotov, 2003).
"""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.plane import Pose
from sar_planner.captures import COLUMNS, STRAIGHTS, TURNS
from sar_planner.geometry import FloatArray

TWO_PI = 2.0 * math.pi
WORDS = ("LSL", "RSR", "LSR", "RSL", "RLR", "LRL", "RLR", "LRL")


def _positive(angle_rad: FloatArray) -> FloatArray:
    turned = np.mod(angle_rad, TWO_PI)
    return np.where(turned > TWO_PI - 1e-9, 0.0, turned)


def words(start: Pose, targets: FloatArray, radius_m: float) -> FloatArray:
    """Return all words from ``start`` to every target pose, shape (8, n, 7).

    ``targets``: x, y, heading, shape (n, 3). The last axis is a row of ``PathBatch``: straights
    [m] and turns [rad] by turns; NaN where a word does not exist. The order is ``WORDS``.
    """
    dx = (targets[:, 0] - start.x_m) / radius_m
    dy = (targets[:, 1] - start.y_m) / radius_m
    bearing = np.arctan2(dy, dx)
    gap = np.hypot(dx, dy)
    a = np.mod(start.heading_rad - bearing, TWO_PI)
    b = np.mod(targets[:, 2] - bearing, TWO_PI)
    rows = np.full((len(WORDS), len(targets), COLUMNS), np.nan)
    ca, sa, cb, sb, cab = np.cos(a), np.sin(a), np.cos(b), np.sin(b), np.cos(a - b)

    def put(word: int, *, exists: FloatArray, parts: tuple[FloatArray, ...]) -> None:
        first, middle, last = parts
        letters = WORDS[word]
        sides = [1.0 if letter == "L" else -1.0 for letter in letters]
        out = rows[word]
        out[:, :] = 0.0
        out[:, 1] = sides[0] * first
        if letters[1] == "S":
            out[:, 2] = middle * radius_m
        else:
            out[:, 3] = sides[1] * middle
        out[:, 5] = sides[2] * last
        out[~(exists >= 0.0)] = np.nan

    with np.errstate(invalid="ignore"):
        square = 2.0 + gap**2 - 2.0 * cab + 2.0 * gap * (sa - sb)
        turn = np.arctan2(cb - ca, gap + sa - sb)
        straight = np.sqrt(np.maximum(square, 0.0))
        put(0, exists=square + 1e-12, parts=(_positive(turn - a), straight, _positive(b - turn)))

        square = 2.0 + gap**2 - 2.0 * cab + 2.0 * gap * (sb - sa)
        turn = np.arctan2(ca - cb, gap - sa + sb)
        straight = np.sqrt(np.maximum(square, 0.0))
        put(1, exists=square + 1e-12, parts=(_positive(a - turn), straight, _positive(turn - b)))

        square = -2.0 + gap**2 + 2.0 * cab + 2.0 * gap * (sa + sb)
        straight = np.sqrt(np.maximum(square, 0.0))
        turn = np.arctan2(-ca - cb, gap + sa + sb) - np.arctan2(-2.0, straight)
        put(2, exists=square, parts=(_positive(turn - a), straight, _positive(turn - b)))

        square = -2.0 + gap**2 + 2.0 * cab - 2.0 * gap * (sa + sb)
        straight = np.sqrt(np.maximum(square, 0.0))
        turn = np.arctan2(ca + cb, gap - sa - sb) - np.arctan2(2.0, straight)
        put(3, exists=square, parts=(_positive(a - turn), straight, _positive(b - turn)))

        cosine = (6.0 - gap**2 + 2.0 * cab + 2.0 * gap * (sa - sb)) / 8.0
        exists = 1.0 - np.abs(cosine)
        small = np.arccos(np.clip(cosine, -1.0, 1.0))
        for word, middle in ((4, TWO_PI - small), (6, small)):
            first = _positive(a - np.arctan2(ca - cb, gap - sa + sb) + 0.5 * middle)
            put(word, exists=exists, parts=(first, middle, _positive(a - b - first + middle)))

        cosine = (6.0 - gap**2 + 2.0 * cab + 2.0 * gap * (sb - sa)) / 8.0
        exists = 1.0 - np.abs(cosine)
        small = np.arccos(np.clip(cosine, -1.0, 1.0))
        for word, middle in ((5, TWO_PI - small), (7, small)):
            first = _positive(-a + np.arctan2(-ca + cb, gap + sa - sb) + 0.5 * middle)
            put(word, exists=exists, parts=(first, middle, _positive(b - a - first + middle)))
    return rows


def lengths_m(rows: FloatArray, radius_m: float) -> FloatArray:
    """Return the lengths [m] of rows, shape (..., 7)."""
    size = np.abs(rows)
    straights: FloatArray = size[..., STRAIGHTS].sum(axis=-1)
    arcs: FloatArray = radius_m * size[..., TURNS].sum(axis=-1)
    return straights + arcs
