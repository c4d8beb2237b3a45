"""From any pose onto the moving slot: timed, flyable, apart from the helicopter, and soon.

Everything is in the slot's frame: x along the leg, the slot track on y = 0, the helicopter's leg on
y = d. Two kinds of paths are searched. *Timed words*: for every arrival time the Dubins words to
where the slot will be then, flown at the constant speed that arrives in time, where that is within
the UAV's limits. *Captures* (``captures``): two or three headings on a grid, the straights solved
for arriving on the slot at the fastest or the slowest speed. Words are the quickest where nothing
is in the way; captures lead around the helicopter. From points along the path found it is looked
again, at the other speed: what is sooner then takes the rest's place.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sar_estimator.plane import Pose
from sar_planner.captures import CaptureProblem, PathBatch
from sar_planner.dubins import lengths_m, words
from sar_planner.forecast import Forecast
from sar_planner.geometry import FlightPath, FloatArray
from sar_planner.separation import closest_over_time, least_of_all_m, sampling_slack_m

STEP_S = 0.5
QUICK = 24
QUICK_SHARE = 1.1
CHUNK = 64
TRIED = 640
FARTHEST = 200
SLACK_S = 60.0
LOOKED_AGAIN = (0.1, 0.2, 0.35, 0.5, 0.6, 0.7, 0.8)
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
    """

    start: Pose
    start_s: float
    forecasts: tuple[Forecast, ...]
    turn_radius_m: float
    slowest_mps: float
    fastest_mps: float
    separation_m: float

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


@dataclass(frozen=True)
class _Capture:
    """One capture: its duration [s], speed, last turn, the other turns' sides, and its row."""

    time_s: float
    speed_mps: float
    last_turn_rad: float
    sides: tuple[int, int, int]
    row: FloatArray


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
        slack = sampling_slack_m(task.separation_m, task.turn_radius_m)
        self.needed_m = task.separation_m + slack
        self.slack_m = slack

    def distances_m(self, found: _Found) -> FloatArray:
        batch = PathBatch(self.task.start, self.task.turn_radius_m, found.rows)
        return least_of_all_m(
            batch, self.task.forecasts, start_s=self.task.start_s, speeds_mps=found.speeds
        )

    def first_kept(self, found: _Found, *, before_s: float = math.inf) -> int | None:
        """Return the soonest path that keeps the separation, arriving before ``before_s``."""
        durations = found.durations_s(self.task.turn_radius_m)
        order = np.argsort(durations, kind="stable")
        order = order[durations[order] < before_s]
        step = math.ceil(len(order) / TRIED)
        if step > 1:
            # A sample of a long list tells where the first one is.
            at = self._first(found, order[::step])
            if at is None:
                return None
            last = int(np.flatnonzero(order == at)[0])
            order = np.concatenate((order[:TRIED], order[max(0, last - step) : last + 1]))
        return self._first(found, order)

    def _first(self, found: _Found, order: NDArray[np.intp]) -> int | None:
        for begin in range(0, len(order), CHUNK):
            chosen = order[begin : begin + CHUNK]
            part = _Found(found.rows[chosen], found.speeds[chosen])
            kept = np.flatnonzero(self.distances_m(part) >= self.needed_m)
            if kept.size:
                return int(chosen[kept[0]])
        return None

    def families(self) -> Iterator[tuple[CaptureProblem, tuple[int, int, int]]]:
        """Yield every kind of capture: speed, last turn, and the sides of the other turns."""
        task = self.task
        for speed in (task.fastest_mps, task.slowest_mps):
            for last in LAST_TURNS_RAD:
                problem = CaptureProblem(
                    task.start, task.turn_radius_m, task.forecast.speed_mps / speed, last
                )
                for first in SIDES:
                    for second in SIDES:
                        for third in SIDES:
                            yield problem, (first, second, third)

    def captures(
        self,
        problem: CaptureProblem,
        sides: tuple[int, int, int],
        headings_1: FloatArray,
        headings_2: FloatArray,
    ) -> _Found:
        """Return the captures over a grid of two headings [rad], each of shape (n,)."""
        h1, h2 = (grid.ravel() for grid in np.meshgrid(headings_1, headings_2, indexing="ij"))
        first, second, third = sides
        turn_1 = first * np.mod(first * (h1 - problem.start.heading_rad), 2.0 * math.pi)
        turn_2 = second * np.mod(second * (h2 - h1), 2.0 * math.pi)
        batch = problem.solve(problem.arcs(turn_1, turn_2, third), self.task.ahead_m)
        speed = self.task.forecast.speed_mps / problem.slow_factor
        return _Found(batch.rows, np.full(len(batch), speed))

    def refine(
        self, problem: CaptureProblem, sides: tuple[int, int, int], row: FloatArray, time_s: float
    ) -> tuple[FloatArray, float]:
        """Search ever finer about a capture's two headings for a sooner one."""
        spread = REFINED_RAD
        for _ in range(REFINEMENTS):
            heading_1 = problem.start.heading_rad + row[1]
            steps = np.linspace(-spread, spread, REFINED_GRID)
            found = self.captures(problem, sides, heading_1 + steps, heading_1 + row[3] + steps)
            better = self.first_kept(found, before_s=time_s)
            if better is not None:
                row = found.rows[better]
                time_s = float(found.durations_s(self.task.turn_radius_m)[better])
            spread *= 0.5
        return row, time_s

    def polish(self, one: _Capture) -> _Capture:
        """Search ever finer about a capture's last turn, speed and headings for a sooner one."""
        task = self.task
        d_turn = POLISHED_LAST_RAD
        d_speed = POLISHED_SPEED_SHARE * (task.fastest_mps - task.slowest_mps)
        spread = POLISHED_RAD
        for _ in range(POLISHINGS):
            for turned, sped in ((d_turn, 0.0), (-d_turn, 0.0), (0.0, d_speed), (0.0, -d_speed)):
                last = one.last_turn_rad + turned
                speed = min(max(one.speed_mps + sped, task.slowest_mps), task.fastest_mps)
                problem = CaptureProblem(
                    task.start, task.turn_radius_m, task.forecast.speed_mps / speed, last
                )
                heading_1 = task.start.heading_rad + one.row[1]
                steps = np.linspace(-spread, spread, POLISHED_GRID)
                found = self.captures(
                    problem, one.sides, heading_1 + steps, heading_1 + one.row[3] + steps
                )
                at = self.first_kept(found, before_s=one.time_s)
                if at is not None:
                    time_s = float(found.durations_s(task.turn_radius_m)[at])
                    one = _Capture(time_s, speed, last, one.sides, found.rows[at])
            d_turn, d_speed, spread = 0.5 * d_turn, 0.5 * d_speed, 0.6 * spread
        return one

    def plan(self, rows: FloatArray, speed: float, *, kept: bool = True) -> RejoinPlan:
        found = _Found(rows[None, :], np.array([speed]))
        path = PathBatch(self.task.start, self.task.turn_radius_m, found.rows).path(0)
        closest = float(self.distances_m(found)[0]) - self.slack_m
        return RejoinPlan(path, speed, path.length_m / speed, closest, kept)


def rejoin(task: RejoinTask) -> RejoinPlan | None:
    """Return the soonest path found onto the slot, or None where no path meets it at all."""
    plan, quick = _one_search(task)
    if plan is None or quick or not plan.kept:
        return plan
    for share in LOOKED_AGAIN:
        plan = _looked_again(task, plan, share)
    return plan


def _looked_again(task: RejoinTask, plan: RejoinPlan, share: float) -> RejoinPlan:
    """Return a sooner plan whose first ``share`` is the plan's, else the plan.

    Such a path can have more turns than one search tries. It is flown at one speed, too.
    """
    from_m = share * plan.path.length_m
    flown_s = share * plan.duration_s
    begin = plan.path.pose_at(from_m)
    rest, _ = _one_search(replace(task, start=begin, start_s=task.start_s + flown_s))
    if rest is None or not rest.kept:
        return plan
    duration_s = flown_s + rest.duration_s
    if duration_s >= plan.duration_s - WORTHWHILE_S:
        return plan
    path = plan.path.cut(0.0, from_m).then(rest.path)
    speed = path.length_m / duration_s
    closest = min(
        closest_over_time(path, forecast, start_s=task.start_s, speed_mps=speed).distance_m
        for forecast in task.forecasts
    )
    if closest < task.separation_m:
        return plan
    return RejoinPlan(path, speed, duration_s, closest, kept=True)


def _soonest_s(task: RejoinTask, rows: FloatArray, speeds: FloatArray) -> float:
    """Return the least duration [s], infinite for none."""
    return float((lengths_m(rows, task.turn_radius_m) / speeds).min(initial=math.inf))


def _one_search(task: RejoinTask) -> tuple[RejoinPlan | None, bool]:
    """Return the soonest path of the two kinds, and whether it is about the soonest there is."""
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
            return search.plan(quick.rows[index], float(quick.speeds[index])), True
    kinds = list(search.families())
    captured = [search.captures(*kind, HEADINGS_RAD, HEADINGS_RAD) for kind in kinds]
    everything = _Found(
        np.vstack([found.rows, *(part.rows for part in captured)]),
        np.concatenate([found.speeds, *(part.speeds for part in captured)]),
    )
    index = search.first_kept(everything)
    if index is None:
        return _farthest(search, everything), False
    best_row, best_speed = everything.rows[index], float(everything.speeds[index])
    best_s = first_s = float(lengths_m(best_row, task.turn_radius_m)) / best_speed
    refined = []
    for kind, part in zip(kinds, captured, strict=True):
        at = search.first_kept(part, before_s=REFINED_SHARE * first_s)
        if at is None:
            continue
        begun_s = float(part.durations_s(task.turn_radius_m)[at])
        row, time_s = search.refine(*kind, part.rows[at], begun_s)
        speed, last = float(part.speeds[at]), float(row[LAST_TURN])
        refined.append(_Capture(time_s, speed, last, kind[1], row))
    for one in sorted(refined, key=lambda capture: capture.time_s)[:POLISHED]:
        polished = search.polish(one)
        if polished.time_s < best_s:
            best_row, best_speed, best_s = polished.row, polished.speed_mps, polished.time_s
    return search.plan(best_row, best_speed), best_s <= SOON_ENOUGH * soonest


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
