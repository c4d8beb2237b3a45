"""From any pose onto the moving slot: timed, flyable, apart from the helicopter, and soon.

Everything is in the slot's frame: x along the leg, the slot track on y = 0, the helicopter's leg on
y = d. Two kinds of paths are searched. *Timed words*: for every arrival time the Dubins words to
where the slot will be then, flown at the constant speed that arrives in time, where that is within
the UAV's limits. *Slot-intercept paths* (``slot_intercept``): two or three headings on a grid, the
straights solved for arriving on the slot at the fastest or the slowest speed. Words are the
quickest where nothing is in the way; intercepts lead around the helicopter. From points along the
path found it is looked again, at the other speed: what is sooner then takes the rest's place. Where
the helicopter costs much, ways of any number of turns are looked for on a grid (``hybrid_grid``).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose
from sar_planner.paths.dubins import WORDS, lengths_m, words
from sar_planner.paths.flight_path import FlightPath, FloatArray
from sar_planner.paths.intercept_kernels import soonest_intercept
from sar_planner.paths.slot_intercept import InterceptProblem, PathBatch, radii_m, turn_to
from sar_planner.prediction.forecast import Forecast, tables_of
from sar_planner.prediction.separation import least_apart_m, least_of_all_m
from sar_planner.rejoin.hybrid_grid import soonest_on_grids

STEP_S = 0.5
QUICK = 24
QUICK_SHARE = 1.1
CHUNK = 64
TRIED = 640
FARTHEST = 200
SLACK_S = 60.0
TRACK_RADII, TRACK_STEP = 12.0, 0.5
LOOKED_AGAIN = (0.1, 0.2, 0.35, 0.5, 0.6, 0.7, 0.8)
COSTLY_SHARE = 1.15
SOON_ENOUGH = 1.03
ENTRY_STEP_S = 0.05
ENTRIES_SHARE = 2.0
WORTHWHILE_S = 0.2
REFINEMENTS = 5
REFINED_SHARE = 1.25
REFINED_RAD = math.radians(6.0)
REFINED_GRID = 7
LAST_TURN = 6
POLISHED = 3
POLISHINGS = 5
POLISHED_LAST_RAD = math.radians(8.0)
POLISHED_RAD = math.radians(12.0)
POLISHED_GRID = 9
POLISHED_SPEED_SHARE = 0.25
HEADINGS_DEG: tuple[float, ...] = (
    *(0, 2.5, 5, 7.5, 10, 13, 16, 20, 24, 28, 32, 36, 40, 45, 50, 55, 60, 66, 72, 80),
    *(90, 105, 120, 135, 150, 165),
)
HEADINGS_RAD = np.radians(np.array([*HEADINGS_DEG, *(-angle for angle in HEADINGS_DEG[1:]), 180.0]))
LAST_TURNS_DEG = (0.0, -20.0, -35.0, -50.0, -57.5, -65.0, -80.0, 25.0, 50.0)
LAST_TURNS_RAD = tuple(math.radians(angle) for angle in LAST_TURNS_DEG)
SIDES = (1, -1)


@dataclass(frozen=True, slots=True)
class RejoinTask:
    """What is to be flown: from ``start`` at ``start_s`` onto the slot.

    ``forecasts``: the first is what is expected and has the slot, all are kept apart from.
    ``slowest_mps``, ``fastest_mps``: the UAV's ground speeds. ``separation_m``: least distance.
    ``is_shared``: with other UAVs, who may be in the slot now: no costly way about them is looked
    for, they are about to leave.
    """

    start: Pose
    start_s: float
    forecasts: tuple[Forecast, ...]
    turn_radius_m: float
    slowest_mps: float
    fastest_mps: float
    separation_m: float
    is_shared: bool = False

    @property
    def forecast(self) -> Forecast:
        """What is expected of the helicopter."""
        return self.forecasts[0]

    @property
    def ahead_m(self) -> float:
        """How far ahead of its slot the UAV is now, along the leg [m]."""
        return self.start.x_m - self.forecast.slot_x_m(self.start_s)


@dataclass(frozen=True)
class RejoinPlan:
    """The path, in the slot's frame, its constant speed [m/s] and its duration [s].

    ``closest_m``: the least distance to the helicopter. ``kept``: whether that is no less than
    asked for; where no path keeps it, the one that stays the farthest is given.
    """

    path: FlightPath
    speed_mps: float
    duration_s: float
    closest_m: float
    kept: bool


@dataclass(frozen=True)
class _Found:
    """Paths, their speeds [m/s], shape (n,), and durations [s], shape (n,)."""

    rows: FloatArray
    speeds: FloatArray

    def durations_s(self, radius_m: float) -> FloatArray:
        return lengths_m(self.rows, radius_m) / self.speeds


Sides = tuple[int, int, int]


@dataclass(frozen=True)
class _Intercept:
    """One intercept: its duration [s], speed, the sides of its first three turns, and its row."""

    time_s: float
    speed_mps: float
    sides: Sides
    row: FloatArray

    @property
    def last_turn_rad(self) -> float:
        return float(self.row[LAST_TURN])


def _latest_s(task: RejoinTask) -> float:
    """Return a time by which the slot can have been reached from anywhere near."""
    v = task.forecast.speed_mps
    gain = min(task.fastest_mps - v, v - task.slowest_mps)
    far = math.hypot(task.ahead_m, task.start.y_m) + 12.0 * task.turn_radius_m
    return far / max(gain, 0.02 * v) + SLACK_S


def timed_words(
    task: RejoinTask, step_s: float = STEP_S, until_s: float = math.inf
) -> tuple[FloatArray, FloatArray]:
    """Return the Dubins words that meet the slot: rows, shape (n, 7), and speeds, shape (n,).

    In order of arrival before ``until_s``, one set for every ``step_s`` [s].
    """
    rows, speeds, fits = _words_over_time(task, step_s, until_s)
    when, word = np.nonzero(fits.T)
    return rows[word, when], speeds[word, when]


def word_entries(task: RejoinTask, until_s: float) -> tuple[FloatArray, FloatArray]:
    """Return, as ``timed_words``, the words at the times from which on they can meet the slot.

    Some can only for a moment.
    """
    rows, speeds, fits = _words_over_time(task, ENTRY_STEP_S, until_s)
    fits[:, 1:] &= ~fits[:, :-1]
    when, word = np.nonzero(fits.T)
    return rows[word, when], speeds[word, when]


def _words_over_time(
    task: RejoinTask, step_s: float, until_s: float
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Return all words to the slot, their speeds, and whether these are within the limits."""
    times = np.arange(step_s, min(until_s, _latest_s(task)), step_s)
    slot = task.forecast.slot_x_m(task.start_s) + task.forecast.speed_mps * times
    targets = np.column_stack((slot, np.zeros_like(slot), np.zeros_like(slot)))
    rows = words(task.start, targets, task.turn_radius_m)
    speeds = lengths_m(rows, task.turn_radius_m) / times[None, :]
    fits = (speeds >= task.slowest_mps - 1e-9) & (speeds <= task.fastest_mps + 1e-9)
    return rows, speeds, np.asarray(fits, dtype=np.bool_)


class _Search:
    """The search for one task."""

    def __init__(self, task: RejoinTask) -> None:
        self.task = task
        self._start = np.array((task.start.x_m, task.start.y_m, task.start.heading_rad))
        self._radii_m = radii_m(task.turn_radius_m)
        self._forecasts = tables_of(task.forecasts)
        self._steady = np.array([(one.steady_s, one.speed_mps) for one in task.forecasts])

    def distances_m(self, found: _Found, *, kept_m: float | None = None) -> FloatArray:
        batch = PathBatch(self.task.start, self.task.turn_radius_m, found.rows)
        return least_of_all_m(
            batch,
            self.task.forecasts,
            start_s=self.task.start_s,
            speeds_mps=found.speeds,
            kept_m=kept_m,
        )

    def first_kept(self, found: _Found, *, before_s: float = math.inf) -> int | None:
        """Return the soonest path that keeps the separation, arriving before ``before_s``."""
        durations = found.durations_s(self.task.turn_radius_m)
        order = np.argsort(durations, kind="stable")
        order = order[durations[order] < before_s]
        step = math.ceil(len(order) / TRIED)
        if step > 1:
            # A sample of a long list tells where the first one is.
            at = self.first_of(found, order[::step])
            if at is None:
                return None
            last = int(np.flatnonzero(order == at)[0])
            order = np.concatenate((order[:TRIED], order[max(0, last - step) : last + 1]))
        return self.first_of(found, order)

    def first_of(self, found: _Found, order: NDArray[np.intp]) -> int | None:
        """Return the first path, in an order, that keeps the separation."""
        for begin in range(0, len(order), CHUNK):
            chosen = order[begin : begin + CHUNK]
            part = _Found(found.rows[chosen], found.speeds[chosen])
            apart = self.distances_m(part, kept_m=self.task.separation_m)
            kept = np.flatnonzero(apart >= self.task.separation_m)
            if kept.size:
                return int(chosen[kept[0]])
        return None

    def families(self) -> Iterator[tuple[float, float, Sides]]:
        """Yield every kind of intercept: speed, last turn, and the sides of the other turns."""
        for speed in (self.task.fastest_mps, self.task.slowest_mps):
            for last in LAST_TURNS_RAD:
                for first, second, third in itertools.product(SIDES, repeat=3):
                    yield speed, last, (first, second, third)

    def soonest(
        self,
        speed_mps: float,
        last_turn_rad: float,
        sides: Sides,
        headings: tuple[FloatArray, FloatArray],
        before_s: float,
    ) -> _Intercept | None:
        """Return the soonest intercept that keeps the separation, over a grid of headings [rad].

        None where none arrives before ``before_s``.
        """
        task = self.task
        time_s, *row = soonest_intercept(
            self._start,
            self._radii_m,
            task.forecast.speed_mps / speed_mps,
            last_turn_rad,
            *headings,
            np.array(sides),
            task.ahead_m,
            self._forecasts,
            self._steady,
            task.start_s,
            speed_mps,
            self.task.separation_m,
            before_s,
        ).tolist()
        return _Intercept(time_s, speed_mps, sides, np.array(row)) if time_s < math.inf else None

    def _about(
        self, one: _Intercept, spread_rad: float, count: int
    ) -> tuple[FloatArray, FloatArray]:
        """Return a grid about an intercept's two headings."""
        heading_1 = self.task.start.heading_rad + one.row[1]
        steps = np.linspace(-spread_rad, spread_rad, count)
        return heading_1 + steps, heading_1 + one.row[3] + steps

    def refine(self, one: _Intercept) -> _Intercept:
        """Search ever finer about an intercept's two headings for a sooner one."""
        spread = REFINED_RAD
        for _ in range(REFINEMENTS):
            about = self._about(one, spread, REFINED_GRID)
            found = self.soonest(one.speed_mps, one.last_turn_rad, one.sides, about, one.time_s)
            one = found or one
            spread *= 0.5
        return one

    def polish(self, one: _Intercept) -> _Intercept:
        """Search ever finer about an intercept's last turn, speed and headings for a sooner one."""
        task = self.task
        d_turn = POLISHED_LAST_RAD
        d_speed = POLISHED_SPEED_SHARE * (task.fastest_mps - task.slowest_mps)
        spread = POLISHED_RAD
        for _ in range(POLISHINGS):
            for turned, sped in ((d_turn, 0.0), (-d_turn, 0.0), (0.0, d_speed), (0.0, -d_speed)):
                last = one.last_turn_rad + turned
                speed = min(max(one.speed_mps + sped, task.slowest_mps), task.fastest_mps)
                about = self._about(one, spread, POLISHED_GRID)
                one = self.soonest(speed, last, one.sides, about, one.time_s) or one
            d_turn, d_speed, spread = 0.5 * d_turn, 0.5 * d_speed, 0.6 * spread
        return one

    def on_grids(self, before_s: float) -> list[tuple[FlightPath, float]]:
        """Return paths on grids that take less than ``before_s``: ``soonest_on_grids``."""
        task = self.task
        return soonest_on_grids(
            task.start,
            task.start_s,
            task.forecast.slot_x_m(task.start_s),
            (task.forecast.speed_mps, task.slowest_mps, task.fastest_mps),
            task.turn_radius_m,
            self._forecasts,
            needed_m=self.task.separation_m,
            before_s=task.start_s + before_s,
        )

    def intercepts(self) -> _Found:
        """Return all intercepts over the grid of headings, whatever separation they keep."""
        task = self.task
        h1, h2 = (g.ravel() for g in np.meshgrid(HEADINGS_RAD, HEADINGS_RAD, indexing="ij"))
        start = np.full_like(h1, task.start.heading_rad)
        turns_1 = {side: turn_to(start, h1, side) for side in SIDES}
        turns_2 = {side: turn_to(h1, h2, side) for side in SIDES}
        speeds = (task.fastest_mps, task.slowest_mps)
        # What the arcs do is the same at either speed.
        found: tuple[list[FloatArray], list[FloatArray]] = [], []
        for last, first, second, third in itertools.product(LAST_TURNS_RAD, SIDES, SIDES, SIDES):
            arcs = None
            for speed, rows in zip(speeds, found, strict=True):
                factor = task.forecast.speed_mps / speed
                problem = InterceptProblem(task.start, task.turn_radius_m, factor, last)
                arcs = arcs or problem.arcs(turns_1[first], turns_2[second], third)
                rows.append(problem.solve(arcs, task.ahead_m).rows)
        fast, slow = (np.vstack(rows) for rows in found)
        each = np.repeat(speeds, (len(fast), len(slow)))
        return _Found(np.vstack((fast, slow)), each)

    def plan(self, rows: FloatArray, speed: float, *, kept: bool = True) -> RejoinPlan:
        found = _Found(rows[None, :], np.array([speed]))
        path = PathBatch(self.task.start, self.task.turn_radius_m, found.rows).path(0)
        closest = float(self.distances_m(found)[0])
        return RejoinPlan(path, speed, path.length_m / speed, closest, kept)


def rejoin(task: RejoinTask) -> RejoinPlan | None:
    """Return the soonest path found onto the slot, or None where no path meets it at all."""
    plan, soonest_s, is_soon = _one_search(task)
    if plan is None or is_soon or not plan.kept:
        return plan
    if task.is_shared and plan.duration_s > COSTLY_SHARE * soonest_s:
        return plan
    plan = _looked_again(task, plan)
    if plan.duration_s > COSTLY_SHARE * soonest_s:
        on_grid = _on_grids(task, plan)
        if on_grid is not plan:
            plan = _looked_again(task, on_grid)
    return plan


def onto_track(task: RejoinTask) -> RejoinPlan:
    """Return the path onto the slot's track, flown at the fastest, that ends least behind it.

    Of those that keep the separation, else what keeps the most. For a UAV that cannot meet the
    slot before the leg ends, or is too slow on it in the wind.
    """
    radius_m, v = task.turn_radius_m, task.forecast.speed_mps
    reach_m = abs(task.start.y_m) + TRACK_RADII * radius_m
    ends = task.start.x_m + np.arange(-reach_m, reach_m, TRACK_STEP * radius_m)
    targets = np.column_stack((ends, np.zeros_like(ends), np.zeros_like(ends)))
    rows = words(task.start, targets, radius_m).reshape(-1, LAST_TURN + 1)
    lags = v * lengths_m(rows, radius_m) / task.fastest_mps - np.tile(ends, len(WORDS))
    rows = rows[np.argsort(lags)[: np.count_nonzero(np.isfinite(lags))]]
    search = _Search(task)
    found = _Found(rows, np.full(len(rows), task.fastest_mps))
    kept = search.first_of(found, np.arange(len(rows)))
    best = int(np.argmax(search.distances_m(found))) if kept is None else kept
    return search.plan(rows[best], task.fastest_mps, kept=kept is not None)


def _on_grids(task: RejoinTask, plan: RejoinPlan) -> RejoinPlan:
    """Return a sooner plan from grids of poses, else the plan."""
    for path, met_s in _Search(task).on_grids(plan.duration_s):
        plan = _sooner(task, plan, path, met_s - task.start_s)
    return plan


def _looked_again(task: RejoinTask, plan: RejoinPlan) -> RejoinPlan:
    """Return a sooner plan that begins as the plan does, else the plan.

    Such a path can have more turns than one search tries.
    """
    for share in LOOKED_AGAIN:
        plan = _looked_from(task, plan, share)
    return plan


def _looked_from(task: RejoinTask, plan: RejoinPlan, share: float) -> RejoinPlan:
    """Return a sooner plan whose first ``share`` is the plan's, else the plan."""
    from_m = share * plan.path.length_m
    flown_s = share * plan.duration_s
    begin = plan.path.pose_at(from_m)
    rest, _, _ = _one_search(replace(task, start=begin, start_s=task.start_s + flown_s))
    if rest is None or not rest.kept:
        return plan
    path = plan.path.cut(0.0, from_m).then(rest.path)
    return _sooner(task, plan, path, flown_s + rest.duration_s)


def _sooner(task: RejoinTask, plan: RejoinPlan, path: FlightPath, duration_s: float) -> RejoinPlan:
    """Return the plan of a path, flown at one speed, where it is sooner and keeps the separation.

    Else the plan.
    """
    if duration_s >= plan.duration_s - WORTHWHILE_S:
        return plan
    speed = path.length_m / duration_s
    closest = least_apart_m(path, task.forecasts, start_s=task.start_s, speed_mps=speed)
    if closest < task.separation_m:
        return plan
    return RejoinPlan(path, speed, duration_s, closest, kept=True)


def _soonest_s(task: RejoinTask, rows: FloatArray, speeds: FloatArray) -> float:
    """Return the least duration [s], infinite for none."""
    return float((lengths_m(rows, task.turn_radius_m) / speeds).min(initial=math.inf))


def _one_search(task: RejoinTask) -> tuple[RejoinPlan | None, float, bool]:
    """Return the soonest path of the two kinds, and whether it is about the soonest there is.

    Between them the time [s] of the soonest word, whatever separation it keeps.
    """
    search = _Search(task)
    coarse = timed_words(task)
    soonest = _soonest_s(task, *coarse)
    entries = word_entries(task, ENTRIES_SHARE * soonest)
    soonest = min(soonest, _soonest_s(task, *entries))
    word_rows = np.concatenate((coarse[0], entries[0]))
    word_speeds = np.concatenate((coarse[1], entries[1]))
    order = np.argsort(lengths_m(word_rows, task.turn_radius_m) / word_speeds, kind="stable")
    word_rows, word_speeds = word_rows[order], word_speeds[order]
    found = _Found(word_rows, word_speeds)
    if len(word_rows):
        quick = _Found(word_rows[:QUICK], word_speeds[:QUICK])
        index = search.first_kept(quick, before_s=QUICK_SHARE * soonest + STEP_S)
        if index is not None:
            return search.plan(quick.rows[index], float(quick.speeds[index])), soonest, True
    index = search.first_kept(found)
    best: _Intercept | None = None
    word_s = math.inf
    if index is not None:
        word_s = float(found.durations_s(task.turn_radius_m)[index])
    first_s = word_s
    headings = (HEADINGS_RAD, HEADINGS_RAD)
    kinds = list(search.families())
    for kind in kinds:
        first = search.soonest(*kind, headings, first_s)
        first_s = first_s if first is None else first.time_s
    if first_s == math.inf:
        others = search.intercepts()
        everything = _Found(
            np.vstack((found.rows, others.rows)), np.concatenate((found.speeds, others.speeds))
        )
        return _farthest(search, everything), soonest, False
    begun = [search.soonest(*kind, headings, REFINED_SHARE * first_s) for kind in kinds]
    refined = [search.refine(one) for one in begun if one is not None]
    refined.sort(key=lambda intercept: intercept.time_s)
    for one in refined[:POLISHED]:
        polished = search.polish(one)
        if polished.time_s < (word_s if best is None else best.time_s):
            best = polished
    if best is None:
        assert index is not None
        return search.plan(found.rows[index], float(found.speeds[index])), soonest, False
    is_soon = best.time_s <= SOON_ENOUGH * soonest
    return search.plan(best.row, best.speed_mps), soonest, is_soon


def _farthest(search: _Search, found: _Found) -> RejoinPlan | None:
    """Return the path that stays the farthest from the helicopter."""
    if len(found.rows) == 0:
        return None
    durations = found.durations_s(search.task.turn_radius_m)
    order = np.argsort(durations, kind="stable")
    order = order[durations[order] <= durations[order[0]] + SLACK_S]
    order = order[np.linspace(0, len(order) - 1, min(len(order), FARTHEST)).astype(int)]
    part = _Found(found.rows[order], found.speeds[order])
    best = int(np.argmax(search.distances_m(part)))
    return search.plan(part.rows[best], float(part.speeds[best]), kept=False)
