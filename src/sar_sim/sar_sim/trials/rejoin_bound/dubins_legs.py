"""Whether Dubins words to poses that move with the slot stay clear, and from when on.

All are begun at (0, 0, 0). ``seen``: a pose's x, y, heading and the direction in which the slot,
and so the pose, moves (``rejoin_around.seen_from``). The helicopter's motion is a forecast's table.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.compiled import compiled
from sar_planner.paths.dubins import fill_words
from sar_planner.paths.flight_path import FloatArray
from sar_planner.paths.kernels import lay_out, place, position_at

SAMPLES = 48
LENGTH_SLACK_M = 1.0
LATER_SHARE = 0.01
LATER_S = 0.05


@compiled(
    "boolean(float64[::1], float64, float64[:, ::1], float64, UniTuple(float64, 3), float64,"
    " float64[::1], float64)"
)
def _is_clear(
    seen: FloatArray,
    lasts_s: float,
    table: FloatArray,
    begun_s: float,
    speeds_mps: tuple[float, float, float],
    slack_m: float,
    radius_m: FloatArray,
    clear_m: float,
) -> bool:
    """Whether some word that takes ``lasts_s`` keeps ``clear_m``.

    ``speeds_mps``: the slot's, the slowest and the fastest; ``slack_m``: by how much lengths may be
    out of what these allow.
    """
    rows, parts = np.empty((8, 7)), np.empty((5, 8))
    run = speeds_mps[0] * lasts_s
    x, y = seen[0] + run * math.cos(seen[3]), seen[1] + run * math.sin(seen[3])
    fill_words(x, y, 0.0, seen[2], radius_m[1], rows)
    for word in range(rows.shape[0]):
        if math.isnan(rows[word, 1]):
            continue
        length = lay_out(parts, rows[word], 0.0, 0.0, 0.0, radius_m)
        shortest = speeds_mps[1] * lasts_s - slack_m
        if not shortest <= length <= speeds_mps[2] * lasts_s + slack_m:
            continue
        part, clear = 0, True
        for i in range(SAMPLES):
            share = (i + 0.5) / SAMPLES
            while part + 1 < parts.shape[1] and parts[4, part + 1] <= share * length:
                part += 1
            at_x, at_y = place(parts, part, share * length)
            there_x, there_y = position_at(table, begun_s + share * lasts_s)
            gap_x, gap_y = at_x - there_x, at_y - there_y
            if gap_x * gap_x + gap_y * gap_y < clear_m * clear_m:
                clear = False
                break
        if clear:
            return True
    return False


@compiled(
    "boolean[::1](float64[:, ::1], float64[::1], float64[:, ::1], float64, UniTuple(float64, 3),"
    " float64, float64[::1], float64)"
)
def clear_hops(
    seen: FloatArray,
    lasts_s: FloatArray,
    table: FloatArray,
    begun_s: float,
    speeds_mps: tuple[float, float, float],
    slack_m: float,
    radius_m: FloatArray,
    clear_m: float,
) -> NDArray[np.bool_]:
    """Return whether some word to each pose, shape (n, 4), in its time, shape (n,), keeps clear.

    The helicopter is the same to all: ``table``, shape (7, m), hops begun at ``begun_s``.
    """
    out = np.empty(lasts_s.size, dtype=np.bool_)
    for i in range(lasts_s.size):
        out[i] = _is_clear(
            seen[i], lasts_s[i], table, begun_s, speeds_mps, slack_m, radius_m, clear_m
        )
    return out


@compiled(
    "float64[::1](float64[:, ::1], float64[::1], float64[::1], float64[:, :, ::1], float64,"
    " UniTuple(float64, 3), float64[::1], float64)"
)
def first_clear_s(
    seen: FloatArray,
    met_s: FloatArray,
    high_s: FloatArray,
    tables: FloatArray,
    begun_s: float,
    speeds_mps: tuple[float, float, float],
    radius_m: FloatArray,
    clear_m: float,
) -> FloatArray:
    """Return times, from ``met_s`` on, before which no word to moving poses keeps ``clear_m``.

    Infinite where none does before ``high_s``. Rounded down by ``LATER_SHARE``. ``tables``: the
    helicopter as seen from each begin, shape (n, 7, m), or (1, 7, m) where all are alike.
    """
    out = np.full(met_s.size, math.inf)
    for i in range(met_s.size):
        table = tables[i if tables.shape[0] > 1 else 0]
        now = before = met_s[i]
        while before < high_s[i]:
            slack_m = LENGTH_SLACK_M + LATER_SHARE * speeds_mps[2] * now
            if _is_clear(seen[i], now, table, begun_s, speeds_mps, slack_m, radius_m, clear_m):
                out[i] = before
                break
            before = now
            now += max(LATER_S, LATER_SHARE * now)
    return out
