"""The search for what is left of a path: from anywhere onto the slot, apart from the helicopter.

Everything is in the frame of the slot the path leads to (x along the slot track, the track on
y = 0), so that a correction for a slot that has moved is the same as for a UAV that has.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose
from sar_planner.paths.flight_path import FlightPath, FloatArray
from sar_planner.paths.slot_intercept import (
    STRAIGHT_P,
    STRAIGHT_Q,
    STRAIGHT_Y,
    InterceptProblem,
    PathBatch,
)
from sar_planner.prediction.forecast import Forecast
from sar_planner.prediction.separation import least_of_all_m
from sar_planner.rules.corner_coverage import SweepAt

PAIRS = ((STRAIGHT_Y, STRAIGHT_Q), (STRAIGHT_P, STRAIGHT_Y), (STRAIGHT_P, STRAIGHT_Q))
GRID_RAD = np.radians(np.arange(-172.5, 181.0, 7.5))
OVERSHOOTS_RAD = tuple(math.radians(slope) for slope in (20.0, 40.0, 60.0, 80.0))
SIDES = (1, -1)
COMPARED = 12
NEAR_RAD = np.radians((0.0, -2.5, 2.5, -8.0, 8.0))
CHUNK = 48
WIDEST = 600
LOYAL_M = 5.0
TRIED = 240
TWO_PI = 2.0 * math.pi
DETOUR_COST = 0.1
LONGEST_TURN_RAD = 1.4 * math.pi


def _no_circles(batch: PathBatch) -> PathBatch:
    """Return the paths without a last turn that nearly comes back to where it began."""
    return batch.take(np.abs(batch.rows[:, 5]) <= LONGEST_TURN_RAD)


def _near(turn_rad: float) -> FloatArray:
    """Return a turn and ones near it, to the same side [rad]; none stays none."""
    if turn_rad == 0.0:
        return np.zeros(1)
    near = turn_rad + NEAR_RAD
    return near[near * turn_rad > 0.0]


@dataclass(frozen=True)
class Recapture:
    """The search for a path from ``start`` at ``start_s`` that ends without lag.

    ``forecasts``: the first is what is expected, all are kept apart from. ``speed_mps``: what the
    UAV makes good along its path. ``sweep``: in a corner, of the cheapest paths the one
    is taken that leaves the least of them uncovered.
    """

    start: Pose
    start_s: float
    forecasts: tuple[Forecast, ...]
    turn_radius_m: float
    speed_mps: float
    separation_m: float
    longest_m: float
    sweep: SweepAt | None = None

    @property
    def _problem(self) -> InterceptProblem:
        v = self.forecasts[0].speed_mps
        return InterceptProblem(self.start, self.turn_radius_m, v / self.speed_mps)

    @property
    def _detour_m(self) -> float:
        return self.start.x_m - self.forecasts[0].slot_x_m(self.start_s)

    def distances_m(self, batch: PathBatch) -> FloatArray:
        """Return least distances to the helicopter [m], lower bounds: ``least_of_all_m``."""
        return least_of_all_m(
            batch, self.forecasts, start_s=self.start_s, speeds_mps=self.speed_mps
        )

    def _kept(
        self, batch: PathBatch, costs: FloatArray, wanted_m: float, least_m: float
    ) -> tuple[FlightPath, float] | None:
        """Return the cheapest path that stays ``wanted_m`` apart, and its least distance.

        Where there is none, the one that stays the farthest, no less than ``least_m``: the cheapest
        above some lower limit would graze it, and with every correction graze a lower one.
        """
        order = np.argsort(costs, kind="stable")
        order = order[batch.lengths_m[order] <= self.longest_m]
        if len(order) > 2 * TRIED:
            # Near the end of a long list neighbours are alike: a sample of them will do.
            rest = np.linspace(TRIED, len(order) - 1, TRIED).astype(int)
            order = order[np.concatenate((np.arange(TRIED), rest))]
        farthest = None
        for begin in range(0, len(order), CHUNK):
            part = batch.take(order[begin : begin + CHUNK])
            distances = self.distances_m(part)
            kept = np.flatnonzero(distances >= wanted_m)
            best = self._best_seeing(part, kept) if kept.size else int(np.argmax(distances))
            if farthest is None or distances[best] > farthest[1]:
                farthest = part.path(best), float(distances[best])
            if kept.size:
                return farthest
        return farthest if farthest is not None and farthest[1] >= least_m else None

    def _best_seeing(self, batch: PathBatch, kept: NDArray[np.intp]) -> int:
        """Return which of some paths to take; the first ones, ``kept``, are the cheapest."""
        if self.sweep is None or len(kept) == 1:
            return int(kept[0])
        compared = kept[:COMPARED]
        return int(compared[np.argmin(self.sweep.uncovered_m2(batch.take(compared)))])

    def best(self, row: FloatArray | None, wanted_m: float, least_m: float) -> FlightPath | None:
        """Return the path to fly, the old one given as a row; None where none is safe.

        The old one's headings with other straights, else the shortest of any headings, both ending
        without lag and ``wanted_m`` apart; else whichever of them stays the farthest apart, no less
        than ``least_m``; else the one that ends nearest to the slot, short ones preferred.
        """
        same = None
        if row is not None:
            batch = self._same_turns(row)
            changed = np.abs(batch.rows[:, [1, 3]] - row[[1, 3]]).sum(axis=1)
            costs = batch.lengths_m + self.turn_radius_m * changed
            same = self._kept(batch, costs, wanted_m, least_m)
            if same is not None and same[1] >= wanted_m - LOYAL_M:
                return same[0]
        batch = self._any_turns()
        exact = self._kept(batch, batch.lengths_m, wanted_m, least_m)
        if exact is not None and (same is None or exact[1] > same[1] + LOYAL_M):
            return exact[0]
        if same is not None:
            return same[0]
        inexact = self._any_lag()
        errors = np.abs(self._problem.detours_m(inexact) - self._detour_m)
        costs = errors + DETOUR_COST * inexact.lengths_m
        found = self._kept(inexact, costs, least_m, least_m)
        return None if found is None else found[0]

    def _same_turns(self, row: FloatArray) -> PathBatch:
        """Return the paths of the same turns, or of ones near them, with other straights.

        The third turn is the one that makes up for what the first two are changed by.
        """
        problem = replace(self._problem, last_turn_rad=float(row[6]))
        turn_1, turn_2 = (
            turn.ravel() for turn in np.meshgrid(_near(row[1]), _near(row[3]), indexing="ij")
        )
        sides = (int(math.copysign(1.0, row[5])),) if row[5] else SIDES
        arcs = [problem.arcs(turn_1, turn_2, side) for side in sides]
        batches = [
            problem.solve(one, self._detour_m, straights=pair) for pair in PAIRS for one in arcs
        ]
        return _no_circles(PathBatch.join(batches))

    def _any_turns(self) -> PathBatch:
        """Return the paths of any two headings that end without lag."""
        problem, detour = self._problem, self._detour_m
        h1, h2 = (grid.ravel() for grid in np.meshgrid(GRID_RAD, GRID_RAD, indexing="ij"))
        batches = []
        for first in SIDES:
            turn_1 = first * np.mod(first * (h1 - self.start.heading_rad), TWO_PI)
            for second in SIDES:
                turn_2 = second * np.mod(second * (h2 - h1), TWO_PI)
                short = (np.abs(turn_1) <= LONGEST_TURN_RAD) & (np.abs(turn_2) <= LONGEST_TURN_RAD)
                for third in SIDES:
                    arcs = problem.arcs(turn_1[short], turn_2[short], third)
                    batches.append(problem.solve(arcs, detour))
        return _no_circles(PathBatch.join(batches))

    def _any_lag(self) -> PathBatch:
        """Return paths of one heading, and of one that overshoots the slot track, any lag."""
        problem = self._problem
        turn_2 = np.zeros_like(GRID_RAD)
        batches = []
        for first in SIDES:
            turn_1 = first * np.mod(first * (GRID_RAD - self.start.heading_rad), TWO_PI)
            for last in SIDES:
                batches.append(problem.reach(problem.arcs(turn_1, turn_2, last)))
                for slope in OVERSHOOTS_RAD:
                    over = replace(problem, last_turn_rad=last * slope)
                    batches.append(over.reach(over.arcs(turn_1, turn_2, -last)))
        return PathBatch.join(batches)

    def widest(self) -> tuple[FlightPath, float] | None:
        """Return the path that stays the farthest from the helicopter, and its least distance."""
        batch = PathBatch.join([self._any_turns(), self._any_lag()])
        batch = batch.take(np.flatnonzero(batch.lengths_m <= self.longest_m))
        if len(batch) == 0:
            return None
        batch = batch.take(np.linspace(0, len(batch) - 1, min(len(batch), WIDEST)).astype(int))
        distances = self.distances_m(batch)
        best = int(np.argmax(distances))
        return batch.path(best), float(distances[best])
