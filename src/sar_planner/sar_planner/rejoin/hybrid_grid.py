"""The soonest way onto the slot among many: poses on a grid, layer by layer in time.

Every step the UAV goes straight on or turns left or right with its least radius. Of the poses that
fall into one cell of a grid in the slot's frame the first is kept, whatever its exact pose (hybrid
A*'s cells: D. Dolgov et al. 2010). From every pose that is kept the Dubins words onto the slot are
tried, the soonest first. So a way is found that has any number of turns, such as one that hugs what
is kept free while the helicopter moves; it is as good as the grid is fine.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.compiled import compiled
from sar_estimator.common.pose import Pose
from sar_planner.paths.apart_kernels import knots_for, least_until
from sar_planner.paths.dubins import fill_words
from sar_planner.paths.flight_path import Arc, FlightPath, FloatArray, Segment, Straight
from sar_planner.paths.kernels import arc_end, lay_out
from sar_planner.paths.slot_intercept import PathBatch, radii_m

REACH_RADII = 15.0
MOST_POSES = 200_000
MANY_POSES = 8000
# Places that are looked at by one search, some 1.2 s: a planner must not be silent for longer.
MOST_WORK, WORDS_WORK, CLEAR_WORK = 80_000_000, 60, 15
LEAST_STEP_S, STEP_SHARE = 0.1, 0.03
# How long a step and how wide a cell is, in turn radii; how many headings are told apart.
GRIDS = ((0.33, 0.16, 48), (0.25, 0.12, 64), (0.17, 0.08, 96), (0.11, 0.04, 160))


@compiled(
    "boolean(float64[:, ::1], float64, float64, float64, float64[:, :, ::1], float64,"
    " float64[:, ::1], int64[::1])"
)
def _is_clear(
    parts: FloatArray,
    length_m: float,
    speed_mps: float,
    begun_s: float,
    forecasts: FloatArray,
    needed_m: float,
    knots: FloatArray,
    work: NDArray[np.int64],
) -> bool:
    """Whether a path, a table of its parts, keeps ``needed_m`` from all forecasts: ``least_until``.

    Forecasts are tables, shape (f, 7, m). ``work``, shape (1,): is counted up by what is looked at.
    """
    pace = (0.0, speed_mps, length_m, speed_mps, speed_mps)
    for f in range(forecasts.shape[0]):
        work[0] += CLEAR_WORK
        kept = least_until(
            parts, pace, forecasts[f], begun_s, length_m / speed_mps, needed_m, needed_m, knots
        )
        if not kept >= needed_m:
            return False
    return True


@compiled("UniTuple(float64, 3)(float64, float64, float64, float64, float64)")
def _after(
    x: float, y: float, heading: float, bend: float, length_m: float
) -> tuple[float, float, float]:
    """Return the pose behind an arc, or a straight."""
    end_x, end_y = arc_end(x, y, heading, bend, length_m)
    return end_x, end_y, heading + bend * length_m


@compiled("float64(float64, float64, float64, float64)")
def _straight_s(ahead_m: float, y_m: float, slot_mps: float, fastest_mps: float) -> float:
    """Return the least time to the slot: straight, from so far ahead of it and beside it."""
    spread = fastest_mps * fastest_mps - slot_mps * slot_mps
    b = -slot_mps * ahead_m
    return (b + math.sqrt(b * b + spread * (ahead_m * ahead_m + y_m * y_m))) / spread


@compiled(
    "float64(float64[::1], float64, float64, float64[::1], float64[::1], float64[:, :, ::1],"
    " float64, float64, float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1],"
    " int64[::1])"
)
def _soonest_word(  # noqa: PLR0917 - compiled functions take arguments by position
    pose: FloatArray,
    now_s: float,
    slot_x_m: float,
    speeds_mps: FloatArray,
    radius_m: FloatArray,
    forecasts: FloatArray,
    needed_m: float,
    before_s: float,
    rows: FloatArray,
    parts: FloatArray,
    knots: FloatArray,
    best_row: FloatArray,
    work: NDArray[np.int64],
) -> float:
    """Return when the soonest clear word from a pose meets the slot, infinite if not before.

    ``slot_x_m``: where the slot is at ``now_s``; ``speeds_mps``: the slot's, the slowest and the
    fastest; ``rows``, shape (8, 7), ``parts``, shape (5, 8), and ``knots``: room to work in;
    ``best_row``: is filled with the word.
    """
    slot, slowest, fastest = speeds_mps[0], speeds_mps[1], speeds_mps[2]
    radius = radius_m[1]
    lasts = max(_straight_s(pose[0] - slot_x_m, pose[1], slot, fastest), LEAST_STEP_S)
    while now_s + lasts < before_s and work[0] < MOST_WORK:
        work[0] += WORDS_WORK
        fill_words(slot_x_m + slot * lasts - pose[0], -pose[1], pose[2], 0.0, radius, rows)
        for word in range(rows.shape[0]):
            row = rows[word]
            length = row[2] + radius * (abs(row[1]) + abs(row[3]) + abs(row[5]))
            speed = length / lasts
            if not slowest - 1e-9 <= speed <= fastest + 1e-9:
                continue
            lay_out(parts, row, pose[0], pose[1], pose[2], radius_m)
            if _is_clear(parts, length, speed, now_s, forecasts, needed_m, knots, work):
                best_row[:] = row
                return now_s + lasts
        lasts += max(LEAST_STEP_S, STEP_SHARE * lasts)
    return math.inf


@compiled("boolean(uint64[:, :, ::1], int64, int64, int64)")
def _is_first(seen: NDArray[np.uint64], column: int, line: int, around: int) -> bool:
    """Whether nothing has come into a cell before, and it is one of the grid; note that it has.

    ``seen``: a bit for every heading.
    """
    if not (0 <= column < seen.shape[0] and 0 <= line < seen.shape[1]):
        return False
    bit = np.uint64(1) << np.uint64(around % 64)
    if seen[column, line, around // 64] & bit:
        return False
    seen[column, line, around // 64] |= bit
    return True


@compiled("int64[::1](int64, int64[::1], int64[::1])")
def _turns_to(pose: int, came: NDArray[np.int64], turned: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the turns of the steps from the first pose to one; ``came``: from which each did."""
    count, at = 0, pose
    while at > 0:
        count, at = count + 1, came[at]
    sides, at = np.empty(count, dtype=np.int64), pose
    for i in range(count - 1, -1, -1):
        sides[i], at = turned[at], came[at]
    return sides


@compiled(
    "Tuple((float64, int64[::1], float64[::1], int64))(UniTuple(float64, 2), int64, float64[::1],"
    " float64, float64, float64[::1], float64[::1], float64[:, :, ::1], float64, float64)"
)
def _search(  # noqa: PLR0917 - compiled functions take arguments by position
    sizes_radii: tuple[float, float],
    headings: int,
    start: FloatArray,
    start_s: float,
    slot_x_m: float,
    speeds_mps: FloatArray,
    radius_m: FloatArray,
    forecasts: FloatArray,
    needed_m: float,
    before_s: float,
) -> tuple[float, NDArray[np.int64], FloatArray, int]:
    """Return when the slot is met, the turns (-1, 0, 1) of the steps till then, the last word.

    And how many poses the grid holds, or could hold where the search was broken off.

    Steps are flown at the fastest speed; the time is infinite where none is before ``before_s``.
    ``sizes_radii``: of a step and of a cell, in turn radii. It ends after ``MOST_WORK``. In one
    piece: it is compiled, and its tables are its own.
    """
    radius = radius_m[1]
    step_m, cell_m, reach_m = sizes_radii[0] * radius, sizes_radii[1] * radius, REACH_RADII * radius
    slot, fastest = speeds_mps[0], speeds_mps[2]
    step_s, across = step_m / fastest, int(2.0 * reach_m / cell_m)
    seen = np.zeros((across, across, headings // 64 + 1), dtype=np.uint64)
    poses, came, turned = (
        np.empty((MOST_POSES, 3)),
        np.empty(MOST_POSES, dtype=np.int64),
        np.empty(MOST_POSES, dtype=np.int64),
    )
    poses[0], came[0] = start, -1
    begin, end, total, now = 0, 1, 1, start_s
    best, who = before_s, -1
    work = np.zeros(1, dtype=np.int64)
    rows, word, best_word = np.empty((8, 7)), np.empty(7), np.zeros(7)
    parts, step = np.empty((5, 8)), np.zeros((5, 1))
    knots = knots_for(8, forecasts.shape[2])
    while begin < end and now < best and work[0] < MOST_WORK:
        slot_x = slot_x_m + slot * (now - start_s)
        for i in range(begin, end):
            pose = poses[i]
            if now + _straight_s(pose[0] - slot_x, pose[1], slot, fastest) >= best:
                continue
            met = _soonest_word(
                pose,
                now,
                slot_x,
                speeds_mps,
                radius_m,
                forecasts,
                needed_m,
                best,
                rows,
                parts,
                knots,
                word,
                work,
            )
            if met < best:
                best, who = met, i
                best_word[:] = word
            for side in range(-1, 2):
                bend = side / radius
                step[:3, 0], step[3, 0] = pose, bend
                if work[0] >= MOST_WORK or not _is_clear(
                    step, step_m, fastest, now, forecasts, needed_m, knots, work
                ):
                    continue
                x, y, heading = _after(pose[0], pose[1], pose[2], bend, step_m)
                column = int((x - slot_x - slot * step_s + reach_m) // cell_m)
                line = int((y + reach_m) // cell_m)
                around = int((heading / (2.0 * math.pi)) % 1.0 * headings) % headings
                if total >= MOST_POSES or not _is_first(seen, column, line, around):
                    continue
                poses[total, 0], poses[total, 1], poses[total, 2] = x, y, heading
                came[total], turned[total] = i, side
                total += 1
        begin, end, now = end, total, now + step_s
    if work[0] >= MOST_WORK:
        total = MOST_POSES
    return best if who >= 0 else math.inf, _turns_to(who, came, turned), best_word, total


def soonest_on_grids(
    start: Pose,
    start_s: float,
    slot_x_m: float,
    speeds_mps: tuple[float, float, float],
    radius_m: float,
    forecasts: FloatArray,
    *,
    needed_m: float,
    before_s: float,
) -> list[tuple[FlightPath, float]]:
    """Return paths onto the slot, ever sooner ones, and when they meet it [s].

    In the slot's frame: the slot is at ``slot_x_m`` at ``start_s``. ``speeds_mps``: the slot's, the
    slowest and the fastest of the UAV; the last word is flown with any of these, what is before it
    with the fastest. ``forecasts``: tables, shape (f, 7, m), of what ``needed_m`` is kept from.

    Grids are laid ever finer until one holds more than ``MANY_POSES``: where there is little room
    the fine ones are small, and needed.
    """
    if speeds_mps[2] <= speeds_mps[0]:
        return []
    begin = np.array((start.x_m, start.y_m, start.heading_rad))
    radii = radii_m(radius_m)
    found: list[tuple[FlightPath, float]] = []
    for step_radii, cell_radii, headings in GRIDS:
        met_s, sides, word, poses = _search(
            (step_radii, cell_radii),
            headings,
            begin,
            start_s,
            slot_x_m,
            np.array(speeds_mps),
            radii,
            forecasts,
            needed_m,
            before_s,
        )
        if met_s < math.inf:
            before_s = met_s
            steps: list[Segment] = [
                Arc(radius_m, side * step_radii) if side else Straight(step_radii * radius_m)
                for side in sides.tolist()
            ]
            path = FlightPath(start, ()).then(FlightPath(start, tuple(steps)))
            last = PathBatch(path.end, radius_m, word[None, :]).path(0)
            found.append((path.then(last), met_s))
        if poses > MANY_POSES:
            break
    return found
