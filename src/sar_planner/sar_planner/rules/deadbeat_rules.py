"""The deadbeat rules: for any lag the path that leaves the least lag and stays apart.

Four named rules, all of the shape S(p) C S(y) C S(q) C C of ``slot_intercept``, in the corner's
frame:

* D1 cut corner: S(p) R(pi/2).
* D2 adjustable curve: S(p) R(alpha) S(y) L(beta) R(gamma), the paper's curve with its lead-in p,
  its straight y, its slope and its first turn alpha all free (the paper has alpha = pi).
* D3 outside loop: S(p) L(pi + psi) S(q) L(pi/2 - psi), lead-in and slope free.
* D4 weave: S(p) R(alpha) S(y) R(beta) S(q) L(gamma) R(delta), the curve with a third heading: it
  crosses the new slot track as early as it can, swings back, and so sees most of both swaths.

For a lag L(k) the rule is chosen whose path leaves the smallest |L(k+1)| while the closest approach
over the whole manoeuvre is no less than ``separation_m``; among equals the one with the best
coverage of the corner, then the shortest. L(k+1) = E - d - 3 s, where E is the path's detour.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import CornerFrame, FloatArray
from sar_planner.paths.slot_intercept import (
    STRAIGHT_P,
    STRAIGHT_Q,
    STRAIGHT_Y,
    Arcs,
    InterceptProblem,
    PathBatch,
)
from sar_planner.prediction.separation import corner_forecast, least_distances_m, sampling_slack_m
from sar_planner.rules.corner_coverage import sweep_of
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule, next_lag_m

HALF_PI = math.pi / 2.0
FIRST_TURNS_RAD = np.radians(np.r_[99.0:150.0:3.0, 150.0:241.0:10.0])
SLOPES_RAD = np.radians(np.arange(0.0, 181.0, 6.0))
LOOP_TURNS_RAD = np.radians(np.arange(120.0, 251.0, 10.0))
LOOP_LEADS = np.arange(0.0, 4.1, 0.5)
WEAVE_TURNS_RAD = np.radians(np.arange(105.0, 190.0, 10.0))
WEAVE_SECOND_RAD = np.radians(np.arange(0.0, 91.0, 15.0))
WEAVE_LAST_RAD = np.radians((36.0, 46.0, 56.0, 66.0, 76.0))
WEAVES_RAD = np.stack(
    np.meshgrid(WEAVE_TURNS_RAD, WEAVE_SECOND_RAD, WEAVE_LAST_RAD, indexing="ij"), axis=-1
).reshape(-1, 3)
# The left turn gamma leads on from where the others do, or there is none.
WEAVES_RAD = WEAVES_RAD[WEAVES_RAD.sum(axis=1) >= HALF_PI]
WEAVES_ABOUT_RAD = np.radians(
    np.stack(np.meshgrid((-5, 0, 5), (-7, 0, 7), (-5, 0, 5), indexing="ij"), axis=-1).reshape(-1, 3)
)
WOVEN = 8
LAG_STEP, LAG_STEPS = 0.1, 24
SEEN = 0.04
CONVERGED_M = 0.5
MAX_STRAIGHT_SPACINGS = 2.4
MAX_STRAIGHT_SHARE = 2.6
COMPARED = 5
CHUNK = 32
FINER = 16


@lru_cache(maxsize=8)
def _curve_arcs(heading_rad: float, radius_m: float, slow_factor: float) -> Arcs:
    """Return the arcs of the adjustable curves; from where does not matter. Not to be changed."""
    alpha, slope = (
        grid.ravel() for grid in np.meshgrid(FIRST_TURNS_RAD, SLOPES_RAD, indexing="ij")
    )
    beta = slope - (HALF_PI - alpha)
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
    return _woven(problem, WEAVES_RAD)[1]


def slot_frame(p: CornerParameters) -> CornerFrame:
    """Return the frame of the new slot track, whose origin is abeam the corner."""
    return CornerFrame(Pose(-p.spacing_m, 0.0, -HALF_PI), 1)


@dataclass(frozen=True)
class Candidates:
    """Paths of one rule and the L(k+1) [m] of each."""

    rule: Rule
    batch: PathBatch
    next_lags_m: FloatArray


class DeadbeatRules:
    """The four rules at one corner's parameters."""

    def __init__(self, parameters: CornerParameters, *, path_efficiency: float = 1.0) -> None:
        """Prepare what does not depend on the lag.

        ``path_efficiency``: share of V that the UAV makes good along its path after the lead-in,
        above 1 where it flies faster.
        """
        self.parameters = parameters
        self._path_efficiency = path_efficiency
        self._frame = slot_frame(parameters)
        self._slot_forecast = corner_forecast(parameters).in_frame(self._frame)

    def problem(self, lag_m: float) -> InterceptProblem:
        """Return the problem in the slot's frame: the UAV at (-(s + L), -d) in the corner's."""
        p = self.parameters
        start = Pose(-(p.stopping_m + lag_m), -p.spacing_m, 0.0)
        return InterceptProblem(
            self._frame.to_frame(start),
            p.turn_radius_m,
            1.0 / self._path_efficiency,
            lead_factor=1.0,
        )

    @property
    def _offset_m(self) -> float:
        return self.parameters.spacing_m + 3.0 * self.parameters.stopping_m

    def _candidates(self, rule: Rule, problem: InterceptProblem, batch: PathBatch) -> Candidates:
        return Candidates(rule, batch, problem.detours_m(batch) - self._offset_m)

    def exact(
        self, problem: InterceptProblem, lead_m: float, straights: tuple[int, int]
    ) -> PathBatch:
        """Return the adjustable curves with L(k+1) = 0, by these two straights."""
        arcs = _curve_arcs(problem.start.heading_rad, problem.radius_m, problem.slow_factor)
        batch = problem.solve(arcs, self._offset_m, straights=straights, lead_m=lead_m)
        return self._short(batch, lead_m)

    def weaves(self, problem: InterceptProblem, lead_m: float, headings: FloatArray) -> PathBatch:
        """Return the weaves with L(k+1) = 0 of headings alpha, beta, delta [rad], shape (n, 3)."""
        possible = headings[headings.sum(axis=1) >= HALF_PI]
        return self._solved(*_woven(problem, possible), lead_m)

    def _grid_of_weaves(self, problem: InterceptProblem, lead_m: float) -> PathBatch:
        woven = replace(problem, last_turn_rad=-WEAVES_RAD[:, 2])
        arcs = _weave_arcs(problem.start.heading_rad, problem.radius_m, problem.slow_factor)
        return self._solved(woven, arcs, lead_m)

    def _solved(self, woven: InterceptProblem, arcs: Arcs, lead_m: float) -> PathBatch:
        batches = [
            woven.solve(arcs, self._offset_m, straights=pair, lead_m=lead_m)
            for pair in ((STRAIGHT_Y, STRAIGHT_Q), (STRAIGHT_P, STRAIGHT_Y))
        ]
        return self._short(PathBatch.join(batches), lead_m)

    def _best_weave(
        self, problem: InterceptProblem, lead_m: float, separation_m: float
    ) -> PathBatch | None:
        """Return the weave that leaves the least uncovered, of a grid, then of one about it."""
        coarse = self._grid_of_weaves(problem, lead_m)
        best, uncovered = self._least_uncovered(coarse, separation_m)
        if best is None or uncovered < SEEN * self.parameters.spacing_m**2:
            return best
        headings = np.abs(best.rows[0, [1, 3, 6]])
        finer = self.weaves(problem, lead_m, np.maximum(headings + WEAVES_ABOUT_RAD, 0.0))
        return self._least_uncovered(PathBatch.join([best, finer]), separation_m)[0]

    def _least_uncovered(
        self, batch: PathBatch, separation_m: float
    ) -> tuple[PathBatch | None, float]:
        """Return, of the shortest safe paths, the one that sees the most, and what it does not."""
        order = np.argsort(batch.lengths_m, kind="stable")
        found = self._first_safe(batch, order, separation_m, WOVEN)
        if not found:
            return None, math.inf
        return self._best_covering(batch.take(found))

    def _first_safe(
        self, batch: PathBatch, order: NDArray[np.intp], separation_m: float, count: int
    ) -> list[int]:
        """Return the first paths of an order that keep the separation, no more than ``count``."""
        found: list[int] = []
        for begin in range(0, len(order), CHUNK):
            chosen = order[begin : begin + CHUNK]
            safe = self._keep(batch.take(chosen), separation_m)
            found += chosen[safe].tolist()
            if len(found) >= count:
                break
        return found[:count]

    def uncovered_m2(self, batch: PathBatch) -> FloatArray:
        """Return the area of the UAV's swaths about the corner that paths leave uncovered [m^2]."""
        return sweep_of(self.parameters.spacing_m).uncovered_m2(batch)

    def _short(self, batch: PathBatch, lead_m: float) -> PathBatch:
        p = self.parameters
        beyond = max(0.0, batch.start.y_m + lead_m - p.spacing_m)
        longest = MAX_STRAIGHT_SPACINGS * p.spacing_m + MAX_STRAIGHT_SHARE * beyond
        return batch.take(batch.rows[:, STRAIGHT_Y] + batch.rows[:, STRAIGHT_Q] <= longest)

    def curves(self, problem: InterceptProblem, lead_m: float) -> Candidates:
        """Return adjustable curves that begin to turn at once after the lead-in."""
        arcs = _curve_arcs(problem.start.heading_rad, problem.radius_m, problem.slow_factor)
        batch = problem.reach(arcs, lead_m=lead_m)
        return self._candidates(Rule.D2, problem, self._short(batch, lead_m))

    def cut(self, problem: InterceptProblem, lead_m: float) -> Candidates:
        """Return the cut corner, where the lead-in leaves it."""
        arcs = problem.arcs(np.array([-HALF_PI]), np.array([0.0]), -1)
        batch = problem.reach(arcs, straight=STRAIGHT_P, lead_m=lead_m)
        return self._candidates(Rule.D1, problem, batch)

    def loops(
        self, problem: InterceptProblem, leads_m: FloatArray, turns_rad: FloatArray = LOOP_TURNS_RAD
    ) -> Candidates:
        """Return outside loops of all these lead-ins [m] and first turns [rad]."""
        arcs = problem.arcs(turns_rad, np.zeros_like(turns_rad), 1)
        batches = [problem.reach(arcs, lead_m=float(lead)) for lead in leads_m]
        return self._candidates(Rule.D3, problem, PathBatch.join(batches))

    def distances_m(self, batch: PathBatch, *, enough_m: float = 0.0) -> FloatArray:
        """Return least distances [m], certain not to be more than the true ones.

        Those below ``enough_m`` may be more than the least.
        """
        speed = self.parameters.speed_mps
        slack = sampling_slack_m(self.parameters.separation_m, self.parameters.turn_radius_m)
        sampled = least_distances_m(
            batch,
            self._slot_forecast,
            start_s=0.0,
            speeds_mps=speed * self._path_efficiency,
            lead_mps=speed,
            enough_m=enough_m + slack,
        )
        return sampled - slack

    def _keep(self, batch: PathBatch, separation_m: float) -> NDArray[np.bool_]:
        """Return which paths keep a separation, shape (n,)."""
        return self.distances_m(batch, enough_m=separation_m) >= separation_m

    def plan(
        self,
        lag_m: float,
        *,
        lead_m: float = 0.0,
        separation_m: float,
        only: Rule | None = None,
    ) -> CornerPlan:
        """Return the best path for lag L(k) [m], turning no earlier than ``lead_m`` [m].

        ``only``: this rule, whatever the others can. Raises ``NoPathError`` when no path keeps
        ``separation_m``.
        """
        problem = self.problem(lag_m)
        lead_m = max(0.0, lead_m)
        cut = self.cut(problem, lead_m)
        cut_does = only in (None, Rule.D1) and (np.abs(cut.next_lags_m) <= CONVERGED_M).any()
        if only in (None, Rule.D4) and not cut_does:
            weave = self._best_weave(problem, lead_m, separation_m)
            if weave is not None:
                return self._corner_plan(Rule.D4, lag_m, weave)
        if only in (None, Rule.D2) and not cut_does:
            for straights in ((STRAIGHT_P, STRAIGHT_Y), (STRAIGHT_Y, STRAIGHT_Q)):
                exact = self.exact(problem, lead_m, straights)
                best = self._worth_comparing(exact, separation_m)
                if len(best):
                    return self._corner_plan(Rule.D2, lag_m, self._best_covering(best)[0])
        leads = lead_m + self.parameters.turn_radius_m * LOOP_LEADS
        families = [cut, self.curves(problem, lead_m), self.loops(problem, leads)]
        families = [family for family in families if only in (None, family.rule)]
        found = self._smallest_safe(families, separation_m) if families else None
        if found is None:
            raise NoPathError(
                f"L = {lag_m:.1f} m: no path keeps {separation_m:.0f} m of separation"
            )
        rule, path = found
        if rule is Rule.D3:
            path = self._finer_loop(problem, path, lead_m, separation_m)
        return self._corner_plan(rule, lag_m, path)

    def _worth_comparing(self, batch: PathBatch, separation_m: float) -> PathBatch:
        """Return some paths that keep the separation, in order of length.

        The shortest ones, and those that stay on the old slot track the longest: the first settle
        soonest, the others leave the least of the corner out.
        """
        by_lead = np.argsort(-batch.rows[:, STRAIGHT_P], kind="stable")
        by_lead = by_lead[:: math.ceil(len(batch) / CHUNK) or 1]
        found = by_lead[self._keep(batch.take(by_lead), separation_m)][:COMPARED].tolist()
        by_length = np.argsort(batch.lengths_m, kind="stable")
        for begin in range(0, len(by_length), CHUNK):
            chosen = by_length[begin : begin + CHUNK]
            safe = chosen[self._keep(batch.take(chosen), separation_m)]
            found += safe[:COMPARED].tolist()
            if len(safe) or len(found) >= COMPARED:
                break
        unique = np.array(sorted(set(found)), dtype=np.intp)
        return batch.take(unique[np.argsort(batch.lengths_m[unique], kind="stable")])

    def _best_covering(self, batch: PathBatch) -> tuple[PathBatch, float]:
        """Return, of paths in order of length, the one that sees the most, and what it does not."""
        uncovered = self.uncovered_m2(batch)
        best = int(np.argmin(uncovered))
        return batch.take([best]), float(uncovered[best])

    def _finer_loop(
        self,
        problem: InterceptProblem,
        path: PathBatch,
        lead_m: float,
        separation_m: float,
    ) -> PathBatch:
        """Return the outside loop with the best lead-in up to the one found."""
        lead, turn = path.rows[0, STRAIGHT_P], path.rows[0, 1:2]
        step = self.parameters.turn_radius_m * float(LOOP_LEADS[1] - LOOP_LEADS[0])
        loops = self.loops(problem, np.linspace(max(lead_m, lead - step), lead, FINER), turn)
        found = self._smallest_safe([loops], separation_m)
        return path if found is None else found[1]

    def _smallest_safe(
        self, families: list[Candidates], separation_m: float
    ) -> tuple[Rule, PathBatch] | None:
        """Return the path with the L(k+1) nearest to 0 that keeps the separation."""
        lags = np.abs(np.concatenate([family.next_lags_m for family in families]))
        rules = [family.rule for family in families for _ in range(len(family.batch))]
        batch = PathBatch.join([family.batch for family in families])
        order = np.argsort(lags, kind="stable")
        found = self._first_safe(batch, order, separation_m, 1)
        return (rules[found[0]], batch.take(found)) if found else None

    def _corner_plan(self, rule: Rule, lag_m: float, batch: PathBatch) -> CornerPlan:
        path = self._frame.path_to_map(batch.path(0))
        p = self.parameters
        late = (1.0 / self._path_efficiency - 1.0) * (
            path.length_m - float(batch.rows[0, STRAIGHT_P])
        )
        return CornerPlan(rule, lag_m, next_lag_m(path, p) + late, path, p)


def least_lag_m(rules: DeadbeatRules, *, lead_m: float, separation_m: float) -> float:
    """Return the least lag, 0 or more, that one corner takes out; 0 where none is found.

    A UAV that makes good little of its speed cannot take any out from L = 0: it is then on the
    far side of the helicopter's new leg, and has no time to come back across it.
    """
    step = LAG_STEP * rules.parameters.spacing_m
    for count in range(LAG_STEPS):
        try:
            plan = rules.plan(count * step, lead_m=lead_m, separation_m=separation_m)
        except NoPathError:
            continue
        if abs(plan.next_lag_m) <= CONVERGED_M:
            return count * step
    return 0.0
