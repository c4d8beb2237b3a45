"""The deadbeat rules: for any lag the path that leaves the least lag and stays apart.

Four named rules, all of the shape S(p) C S(y) C S(q) C C of ``slot_intercept``, in the corner's
frame:

* D1 cut corner: S(p) R(pi/2).
* D2 adjustable curve: S(p) R(alpha) S(y) L(beta) R(gamma), the paper's curve with its lead-in p,
  its straight y, its slope and its first turn alpha all free (the paper has alpha = pi).
* D3 outside loop: S(p) L(pi + psi) S(q) L(pi/2 - psi), lead-in and slope free.
* D4 weave: S(p) R(alpha) S(y) R(beta) S(q) L(gamma) R(delta), the curve with a third heading: it
  crosses the new slot track as early as it can, swings back, and so sees most of both swaths.

They are told for a right angle; in a turn by theta it stands for pi/2.

For a lag L(k) the rule is chosen whose path leaves the smallest |L(k+1)| while the closest approach
over the whole manoeuvre is no less than ``separation_m``; among equals the one with the best
coverage of the corner, then the shortest. L(k+1) = E - x - 3 s, where E is the path's detour, and x
how far its beginning is along the new slot track, d at a right angle.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import FlightPath, FloatArray
from sar_planner.paths.slot_intercept import (
    STRAIGHT_P,
    STRAIGHT_Q,
    STRAIGHT_Y,
    InterceptProblem,
    PathBatch,
    row_of,
)
from sar_planner.prediction.separation import ClosestApproach
from sar_planner.rules.deadbeat_paths import HALF_PI, Candidates, DeadbeatPaths
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule

LOOP_LEADS = np.arange(0.0, 4.1, 0.5)
WEAVES_ABOUT_RAD = np.radians(
    np.stack(np.meshgrid((-5, 0, 5), (-7, 0, 7), (-5, 0, 5), indexing="ij"), axis=-1).reshape(-1, 3)
)
WOVEN = 8
SEEN = 0.04
CONVERGED_M = 0.5
COMPARED = 5
CHUNK = 32
FINER = 16


class DeadbeatRules:
    """The four rules at one corner's parameters.

    ``paths``: what is chosen from.
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
        """Prepare what does not depend on the lag; see ``DeadbeatPaths``."""
        self.parameters = parameters
        self.paths = DeadbeatPaths(
            parameters,
            path_efficiency=path_efficiency,
            turn_rad=turn_rad,
            aim_m=aim_m,
            least_efficiency=least_efficiency,
        )

    def closest(self, path: FlightPath) -> ClosestApproach:
        """Return the closest approach of a path that is flown at V."""
        return self.paths.closest(path)

    def uncovered_m2(self, plan: CornerPlan) -> float:
        """Return the area of the UAV's two swaths that a plan leaves out [m^2]."""
        path = self.paths.frame.path_from_map(plan.path)
        row = row_of(path)
        assert row is not None
        batch = PathBatch(path.start, self.parameters.turn_radius_m, row[None, :])
        return float(self.paths.uncovered_m2(batch)[0])

    def _missed_m(self, family: Candidates) -> FloatArray:
        """Return by how much the paths of a family miss the L(k+1) wanted [m]."""
        return np.abs(family.next_lags_m - self.paths.aim_m)

    def _best_weave(
        self, problem: InterceptProblem, lead_m: float, separation_m: float
    ) -> PathBatch | None:
        """Return the weave that leaves the least uncovered, of a grid, then of one about it."""
        coarse = self.paths.grid_of_weaves(problem, lead_m)
        best, uncovered = self._least_uncovered(coarse, separation_m)
        if best is None or uncovered < SEEN * self.parameters.spacing_m**2:
            return best
        headings = np.abs(best.rows[0, [1, 3, 6]])
        finer = self.paths.weaves(problem, lead_m, np.maximum(headings + WEAVES_ABOUT_RAD, 0.0))
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
            safe = self.paths.keep(batch.take(chosen), separation_m)
            found += chosen[safe].tolist()
            if len(found) >= count:
                break
        return found[:count]

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
        problem = self.paths.problem(lag_m)
        lead_m = max(0.0, lead_m)
        cut = self.paths.cut(problem, lead_m)
        cut_does = only in (None, Rule.D1) and (self._missed_m(cut) <= CONVERGED_M).any()
        if only in (None, Rule.D4) and not cut_does:
            weave = self._best_weave(problem, lead_m, separation_m)
            if weave is not None:
                return self.paths.plan_of(Rule.D4, lag_m, weave)
        if only in (None, Rule.D2) and not cut_does:
            for straights in ((STRAIGHT_P, STRAIGHT_Y), (STRAIGHT_Y, STRAIGHT_Q)):
                exact = self.paths.exact(problem, lead_m, straights)
                best = self._worth_comparing(exact, separation_m)
                if len(best):
                    return self.paths.plan_of(Rule.D2, lag_m, self._best_covering(best)[0])
        leads = lead_m + self.parameters.turn_radius_m * LOOP_LEADS
        families = [cut, self.paths.curves(problem, lead_m), self.paths.loops(problem, leads)]
        families = [family for family in families if only in (None, family.rule)]
        found = self._smallest_safe(families, separation_m) if families else None
        if found is None:
            raise NoPathError(
                f"L = {lag_m:.1f} m: no path keeps {separation_m:.0f} m of separation"
            )
        rule, path = found
        if rule is Rule.D3:
            path = self._finer_loop(problem, path, lead_m, separation_m)
        return self.paths.plan_of(rule, lag_m, path)

    def _worth_comparing(self, batch: PathBatch, separation_m: float) -> PathBatch:
        """Return some paths that keep the separation, in order of length.

        The shortest ones, and those that stay on the old slot track the longest: the first settle
        soonest, the others leave the least of the corner out.
        """
        by_lead = np.argsort(-batch.rows[:, STRAIGHT_P], kind="stable")
        by_lead = by_lead[:: math.ceil(len(batch) / CHUNK) or 1]
        found = by_lead[self.paths.keep(batch.take(by_lead), separation_m)][:COMPARED].tolist()
        by_length = np.argsort(batch.lengths_m, kind="stable")
        for begin in range(0, len(by_length), CHUNK):
            chosen = by_length[begin : begin + CHUNK]
            safe = chosen[self.paths.keep(batch.take(chosen), separation_m)]
            found += safe[:COMPARED].tolist()
            if len(safe) or len(found) >= COMPARED:
                break
        unique = np.array(sorted(set(found)), dtype=np.intp)
        return batch.take(unique[np.argsort(batch.lengths_m[unique], kind="stable")])

    def _best_covering(self, batch: PathBatch) -> tuple[PathBatch, float]:
        """Return, of paths in order of length, the one that sees the most, and what it does not."""
        uncovered = self.paths.uncovered_m2(batch)
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
        loops = self.paths.loops(problem, np.linspace(max(lead_m, lead - step), lead, FINER), turn)
        found = self._smallest_safe([loops], separation_m)
        return path if found is None else found[1]

    def _smallest_safe(
        self, families: list[Candidates], separation_m: float
    ) -> tuple[Rule, PathBatch] | None:
        """Return the path with the L(k+1) nearest to the wanted that keeps the separation."""
        lags = np.concatenate([self._missed_m(family) for family in families])
        rules = [family.rule for family in families for _ in range(len(family.batch))]
        batch = PathBatch.join([family.batch for family in families])
        order = np.argsort(lags, kind="stable")
        found = self._first_safe(batch, order, separation_m, 1)
        return (rules[found[0]], batch.take(found)) if found else None
