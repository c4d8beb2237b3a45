"""The families of paths that the deadbeat rules choose from, at one corner's parameters.

See ``deadbeat_rules`` for the rules' shapes and symbols.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import CornerFrame, FlightPath, FloatArray
from sar_planner.paths.slot_intercept import (
    STRAIGHT_P,
    STRAIGHT_Q,
    STRAIGHT_Y,
    Arcs,
    InterceptProblem,
    PathBatch,
)
from sar_planner.prediction.separation import (
    ClosestApproach,
    closest_approach,
    corner_forecast,
    least_distances_m,
)
from sar_planner.rules.corner_coverage import sweep_of
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule

HALF_PI = math.pi / 2.0
LEAST_TURN_RAD, MOST_TURN_RAD = np.radians((60.0, 135.0)).tolist()
FIRST_TURNS_RAD = np.radians(np.r_[9.0:60.0:3.0, 60.0:151.0:10.0])
SLOPES_RAD = np.radians(np.arange(0.0, 181.0, 6.0))
LOOP_TURNS_RAD = np.radians(np.arange(120.0, 251.0, 10.0))
WEAVE_TURNS_RAD = np.radians(np.arange(15.0, 100.0, 10.0))
WEAVE_SECOND_RAD = np.radians(np.arange(0.0, 91.0, 15.0))
WEAVE_LAST_RAD = np.radians((36.0, 46.0, 56.0, 66.0, 76.0))
MAX_STRAIGHT_SPACINGS = 2.4
MAX_STRAIGHT_SHARE = 2.6


@lru_cache(maxsize=8)
def _weaves_rad(turn_rad: float) -> FloatArray:
    """Return the grid of headings alpha, beta, delta [rad], shape (n, 3). Not to be changed.

    The left turn gamma leads on from where the others do, or there is none.
    """
    axes = turn_rad + WEAVE_TURNS_RAD, WEAVE_SECOND_RAD, WEAVE_LAST_RAD
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    possible: FloatArray = grid[grid.sum(axis=1) >= turn_rad]
    return possible


@lru_cache(maxsize=8)
def _curve_arcs(heading_rad: float, radius_m: float, slow_factor: float) -> Arcs:
    """Return the arcs of the adjustable curves; from where does not matter. Not to be changed.

    ``heading_rad``: at their beginning, over the new slot track: the turn.
    """
    alpha, slope = (
        grid.ravel()
        for grid in np.meshgrid(heading_rad + FIRST_TURNS_RAD, SLOPES_RAD, indexing="ij")
    )
    beta = slope - (heading_rad - alpha)
    forward = beta >= 0.0
    problem = InterceptProblem(Pose(0.0, 0.0, heading_rad), radius_m, slow_factor)
    return problem.arcs(-alpha[forward], beta[forward], -1)


def _woven(problem: InterceptProblem, headings: FloatArray) -> tuple[InterceptProblem, Arcs]:
    """Return the problem and the arcs of weaves of headings alpha, beta, delta [rad], (n, 3)."""
    alpha, beta, delta = headings.T
    woven = replace(problem, last_turn_rad=-delta)
    return woven, woven.arcs(-alpha, -beta, 1)


@lru_cache(maxsize=8)
def _weave_arcs(heading_rad: float, radius_m: float, slow_factor: float) -> Arcs:
    """Return the arcs of the grid of weaves; from where does not matter. Not to be changed."""
    problem = InterceptProblem(Pose(0.0, 0.0, heading_rad), radius_m, slow_factor)
    return _woven(problem, _weaves_rad(heading_rad))[1]


def slot_frame(p: CornerParameters, turn_rad: float = HALF_PI) -> CornerFrame:
    """Return the frame of the new slot track, whose origin is abeam the corner."""
    return CornerFrame(Pose(0.0, 0.0, -turn_rad).offset(0.0, -p.spacing_m), 1)


@dataclass(frozen=True)
class Candidates:
    """Paths of one rule and the L(k+1) [m] of each."""

    rule: Rule
    batch: PathBatch
    next_lags_m: FloatArray


class DeadbeatPaths:
    """The paths of all four rules at one corner's parameters, in the new slot track's frame.

    ``frame``: that frame.
    """

    def __init__(
        self,
        parameters: CornerParameters,
        *,
        path_efficiency: float = 1.0,
        turn_rad: float = HALF_PI,
        aim_m: float = 0.0,
        least_efficiency: float | None = None,
    ) -> None:
        """Prepare what does not depend on the lag.

        ``path_efficiency``: share of V that the UAV makes good along its path after the lead-in,
        above 1 where it flies faster. ``turn_rad``: the size of the turn [rad].
        ``aim_m``: the L(k+1) that is wanted [m]. ``least_efficiency``: paths are to stay apart with
        that share, too, where it is given. Raises ``NoPathError`` for one that the rules are not
        for.
        """
        if not LEAST_TURN_RAD <= turn_rad <= MOST_TURN_RAD:
            raise NoPathError(
                f"turn of {math.degrees(turn_rad):.0f} degrees: expected "
                f"{math.degrees(LEAST_TURN_RAD):.0f} to {math.degrees(MOST_TURN_RAD):.0f}"
            )
        self.parameters = parameters
        self._path_efficiency = path_efficiency
        least = path_efficiency if least_efficiency is None else least_efficiency
        self._shares = (path_efficiency, *((least,) if least < path_efficiency else ()))
        self._turn_rad, self.aim_m = turn_rad, aim_m
        self.frame = slot_frame(parameters, turn_rad)
        self._slot_forecast = corner_forecast(parameters, turn_rad).in_frame(self.frame)

    def problem(self, lag_m: float) -> InterceptProblem:
        """Return the problem in the slot's frame: the UAV at (-(s + L), -d) in the corner's."""
        p = self.parameters
        start = Pose(-(p.stopping_m + lag_m), -p.spacing_m, 0.0)
        return InterceptProblem(
            self.frame.to_frame(start),
            p.turn_radius_m,
            1.0 / self._path_efficiency,
            lead_factor=1.0,
        )

    def _offset_m(self, problem: InterceptProblem) -> float:
        return problem.start.x_m + 3.0 * self.parameters.stopping_m

    def _candidates(self, rule: Rule, problem: InterceptProblem, batch: PathBatch) -> Candidates:
        return Candidates(rule, batch, problem.detours_m(batch) - self._offset_m(problem))

    def exact(
        self, problem: InterceptProblem, lead_m: float, straights: tuple[int, int]
    ) -> PathBatch:
        """Return the adjustable curves with the L(k+1) wanted, by these two straights."""
        arcs = _curve_arcs(problem.start.heading_rad, problem.radius_m, problem.slow_factor)
        offset_m = self._offset_m(problem) + self.aim_m
        batch = problem.solve(arcs, offset_m, straights=straights, lead_m=lead_m)
        return self._short(batch, lead_m)

    def weaves(self, problem: InterceptProblem, lead_m: float, headings: FloatArray) -> PathBatch:
        """Return the weaves with that L(k+1) of headings alpha, beta, delta [rad], shape (n, 3)."""
        possible = headings[headings.sum(axis=1) >= self._turn_rad]
        return self._solved(*_woven(problem, possible), lead_m)

    def grid_of_weaves(self, problem: InterceptProblem, lead_m: float) -> PathBatch:
        """Return the weaves with the L(k+1) wanted of a coarse grid of headings."""
        woven = replace(problem, last_turn_rad=-_weaves_rad(problem.start.heading_rad)[:, 2])
        arcs = _weave_arcs(problem.start.heading_rad, problem.radius_m, problem.slow_factor)
        return self._solved(woven, arcs, lead_m)

    def _solved(self, woven: InterceptProblem, arcs: Arcs, lead_m: float) -> PathBatch:
        batches = [
            woven.solve(arcs, self._offset_m(woven) + self.aim_m, straights=pair, lead_m=lead_m)
            for pair in ((STRAIGHT_Y, STRAIGHT_Q), (STRAIGHT_P, STRAIGHT_Y))
        ]
        return self._short(PathBatch.join(batches), lead_m)

    def _short(self, batch: PathBatch, lead_m: float) -> PathBatch:
        d = self.parameters.spacing_m
        wider = math.tan(0.5 * self._turn_rad)  # how far from the corner the slot tracks cross
        crossed_m = batch.start.y_m / math.sin(self._turn_rad)
        beyond = max(0.0, crossed_m + lead_m - d * wider)
        longest = MAX_STRAIGHT_SPACINGS * d * max(1.0, wider) + MAX_STRAIGHT_SHARE * beyond
        return batch.take(batch.rows[:, STRAIGHT_Y] + batch.rows[:, STRAIGHT_Q] <= longest)

    def curves(self, problem: InterceptProblem, lead_m: float) -> Candidates:
        """Return adjustable curves that begin to turn at once after the lead-in."""
        arcs = _curve_arcs(problem.start.heading_rad, problem.radius_m, problem.slow_factor)
        batch = problem.reach(arcs, lead_m=lead_m)
        return self._candidates(Rule.D2, problem, self._short(batch, lead_m))

    def cut(self, problem: InterceptProblem, lead_m: float) -> Candidates:
        """Return the cut corner, where the lead-in leaves it."""
        arcs = problem.arcs(np.array([-self._turn_rad]), np.array([0.0]), -1)
        batch = problem.reach(arcs, straight=STRAIGHT_P, lead_m=lead_m)
        return self._candidates(Rule.D1, problem, batch)

    def loops(
        self, problem: InterceptProblem, leads_m: FloatArray, turns_rad: FloatArray = LOOP_TURNS_RAD
    ) -> Candidates:
        """Return outside loops of all these lead-ins [m] and first turns [rad]."""
        arcs = problem.arcs(turns_rad, np.zeros_like(turns_rad), 1)
        batches = [problem.reach(arcs, lead_m=float(lead)) for lead in leads_m]
        return self._candidates(Rule.D3, problem, PathBatch.join(batches))

    def uncovered_m2(self, batch: PathBatch) -> FloatArray:
        """Return the area of the UAV's swaths about the corner that paths leave uncovered [m^2]."""
        return sweep_of(self.parameters.spacing_m, self._turn_rad).uncovered_m2(batch)

    def closest(self, path: FlightPath) -> ClosestApproach:
        """Return the closest approach of a path that is flown at V."""
        return closest_approach(path, self.parameters, self._turn_rad)

    def keep(self, batch: PathBatch, separation_m: float) -> NDArray[np.bool_]:
        """Return which paths are certain to keep a separation, shape (n,)."""
        speed = self.parameters.speed_mps
        kept = np.ones(len(batch), dtype=np.bool_)
        for share in self._shares:
            distances = least_distances_m(
                batch,
                self._slot_forecast,
                start_s=0.0,
                speeds_mps=speed * share,
                lead_mps=speed,
                kept_m=separation_m,
            )
            kept &= distances >= separation_m
        return kept

    def plan_of(self, rule: Rule, lag_m: float, batch: PathBatch) -> CornerPlan:
        """Return the plan to fly a batch's only path, in the corner's frame."""
        path = self.frame.path_to_map(batch.path(0))
        p = self.parameters
        late = (1.0 / self._path_efficiency - 1.0) * (
            path.length_m - float(batch.rows[0, STRAIGHT_P])
        )
        ended_m = self.frame.to_frame(path.end).x_m
        next_lag_m = path.length_m - ended_m - 3.0 * p.stopping_m
        return CornerPlan(rule, lag_m, next_lag_m + late, path, p)
