"""The deadbeat rules: for any lag the path that leaves the least lag and stays apart.

Three named rules, all of the shape S(p) C S(y) C S(q) C of ``captures``, in the corner's frame:

* D1 cut corner: S(p) R(pi/2).
* D2 adjustable curve: S(p) R(alpha) S(y) L(beta) R(gamma), the paper's curve with its lead-in p,
  its straight y, its slope and its first turn alpha all free (the paper has alpha = pi).
* D3 outside loop: S(p) L(pi + psi) S(q) L(pi/2 - psi), lead-in and slope free.

For a lag L(k) the rule is chosen whose path leaves the smallest |L(k+1)| while the closest approach
over the whole manoeuvre is no less than ``separation_m``; among equals the one with the best
coverage of the corner, then the shortest. L(k+1) = E - d - 3 s, where E is the path's detour.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sar_estimator.plane import Pose
from sar_planner.captures import STRAIGHT_P, STRAIGHT_Q, STRAIGHT_Y, CaptureProblem, PathBatch
from sar_planner.geometry import CornerFrame, FloatArray
from sar_planner.parameters import CornerParameters
from sar_planner.rules import CornerPlan, NoPathError, Rule, next_lag_m
from sar_planner.separation import corner_forecast, least_distances_m, sampling_slack_m

HALF_PI = math.pi / 2.0
FIRST_TURNS_RAD = np.radians(np.r_[99.0:150.0:3.0, 150.0:241.0:10.0])
SLOPES_RAD = np.radians(np.arange(0.0, 181.0, 6.0))
LOOP_TURNS_RAD = np.radians(np.arange(120.0, 251.0, 10.0))
LOOP_LEADS = np.arange(0.0, 4.1, 0.5)
CONVERGED_M = 0.5
MAX_STRAIGHT_SPACINGS = 2.4
MAX_STRAIGHT_SHARE = 2.6
COVERED_SPACINGS = 2.5
COMPARED = 5
CHUNK = 32
FINER = 16


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
    """The three rules at one corner's parameters."""

    def __init__(self, parameters: CornerParameters, *, made_good: float = 1.0) -> None:
        """Prepare what does not depend on the lag.

        ``made_good``: share of its speed that the UAV makes good along its path after the lead-in.
        """
        self.parameters = parameters
        self._made_good = made_good
        self._frame = slot_frame(parameters)
        self._slot_forecast = corner_forecast(parameters).in_frame(self._frame)
        turn_1, slope = np.meshgrid(-FIRST_TURNS_RAD, SLOPES_RAD, indexing="ij")
        first = HALF_PI + turn_1.ravel()
        self._turn_1 = turn_1.ravel()
        self._turn_2 = slope.ravel() - first
        forward = self._turn_2 >= 0.0
        self._turn_1, self._turn_2 = self._turn_1[forward], self._turn_2[forward]

    @cached_property
    def _cells(self) -> FloatArray:
        """Points of the UAV's two strips about the corner, in the slot's frame, shape (n, 2)."""
        d = self.parameters.spacing_m
        steps = np.arange(0.0, COVERED_SPACINGS * d, 0.2 * d)
        lanes = (-d / 3.0, 0.0, d / 3.0)
        old = [np.column_stack((np.full_like(steps, d + lane), -steps)) for lane in lanes]
        new = [np.column_stack((d + steps, np.full_like(steps, lane))) for lane in lanes]
        return np.vstack(old + new)

    def problem(self, lag_m: float) -> CaptureProblem:
        """Return the problem in the slot's frame: the UAV at (-(s + L), -d) in the corner's."""
        p = self.parameters
        start = Pose(-(p.stopping_m + lag_m), -p.spacing_m, 0.0)
        return CaptureProblem(
            self._frame.to_frame(start), p.turn_radius_m, 1.0 / self._made_good, lead_factor=1.0
        )

    @property
    def _offset_m(self) -> float:
        return self.parameters.spacing_m + 3.0 * self.parameters.stopping_m

    def _candidates(self, rule: Rule, problem: CaptureProblem, batch: PathBatch) -> Candidates:
        return Candidates(rule, batch, problem.detours_m(batch) - self._offset_m)

    def exact(
        self, problem: CaptureProblem, lead_m: float, straights: tuple[int, int]
    ) -> PathBatch:
        """Return the adjustable curves with L(k+1) = 0, by these two straights."""
        batch = problem.solve(
            self._turn_1,
            self._turn_2,
            -1,
            self._offset_m,
            straights=straights,
            lead_m=lead_m,
        )
        return self._short(batch, lead_m)

    def _short(self, batch: PathBatch, lead_m: float) -> PathBatch:
        p = self.parameters
        beyond = max(0.0, batch.start.y_m + lead_m - p.spacing_m)
        longest = MAX_STRAIGHT_SPACINGS * p.spacing_m + MAX_STRAIGHT_SHARE * beyond
        return batch.take(batch.rows[:, STRAIGHT_Y] + batch.rows[:, STRAIGHT_Q] <= longest)

    def curves(self, problem: CaptureProblem, lead_m: float) -> Candidates:
        """Return adjustable curves that begin to turn at once after the lead-in."""
        batch = problem.reach(self._turn_1, self._turn_2, -1, lead_m=lead_m)
        return self._candidates(Rule.D2, problem, self._short(batch, lead_m))

    def cut(self, problem: CaptureProblem, lead_m: float) -> Candidates:
        """Return the cut corner, where the lead-in leaves it."""
        batch = problem.reach(
            np.array([-HALF_PI]), np.array([0.0]), -1, straight=STRAIGHT_P, lead_m=lead_m
        )
        return self._candidates(Rule.D1, problem, batch)

    def loops(
        self, problem: CaptureProblem, leads_m: FloatArray, turns_rad: FloatArray = LOOP_TURNS_RAD
    ) -> Candidates:
        """Return outside loops of all these lead-ins [m] and first turns [rad]."""
        still = np.zeros_like(turns_rad)
        batches = [problem.reach(turns_rad, still, 1, lead_m=float(lead)) for lead in leads_m]
        return self._candidates(Rule.D3, problem, PathBatch.join(batches))

    def distances_m(self, batch: PathBatch) -> FloatArray:
        """Return least distances [m], certain not to be more than the true ones."""
        speed = self.parameters.speed_mps
        sampled = least_distances_m(
            batch,
            self._slot_forecast,
            start_s=0.0,
            speeds_mps=speed * self._made_good,
            lead_mps=speed,
        )
        slack = sampling_slack_m(self.parameters.separation_m, self.parameters.turn_radius_m)
        return sampled - slack

    def coverage(self, batch: PathBatch) -> FloatArray:
        """Return the share of the UAV's strips about the corner that every path covers."""
        d = self.parameters.spacing_m
        cells = self._cells
        distances = np.arange(0.0, float(batch.lengths_m.max()) + 0.16 * d, 0.16 * d)
        points = batch.points(distances).reshape(-1, 2)
        square = (
            np.square(points).sum(axis=1)[:, None]
            + np.square(cells).sum(axis=1)[None, :]
            - 2.0 * np.multiply.outer(points[:, 0], cells[:, 0])
            - 2.0 * np.multiply.outer(points[:, 1], cells[:, 1])
        )
        near = (square <= (0.5 * d) ** 2).reshape(len(batch), len(distances), -1).any(axis=1)
        on_old = np.arange(len(cells)) < len(cells) // 2
        before = on_old & (cells[:, 1] <= batch.start.y_m)
        after = ~on_old[None, :] & (cells[None, :, 0] >= batch.ends[:, :1])
        covered: FloatArray = (near | before[None, :] | after).mean(axis=1)
        return covered

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
        if only in (None, Rule.D2) and not cut_does:
            for straights in ((STRAIGHT_P, STRAIGHT_Y), (STRAIGHT_Y, STRAIGHT_Q)):
                exact = self.exact(problem, lead_m, straights)
                best = self._worth_comparing(exact, separation_m)
                if len(best):
                    return self._corner_plan(Rule.D2, lag_m, self._best_covering(best))
        leads = lead_m + self.parameters.turn_radius_m * LOOP_LEADS
        families = [cut, self.curves(problem, lead_m), self.loops(problem, leads)]
        families = [family for family in families if only in (None, family.rule)]
        found = self._smallest_safe(families, separation_m)
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
        found = by_lead[self.distances_m(batch.take(by_lead)) >= separation_m][:COMPARED].tolist()
        by_length = np.argsort(batch.lengths_m, kind="stable")
        for begin in range(0, len(by_length), CHUNK):
            chosen = by_length[begin : begin + CHUNK]
            safe = chosen[self.distances_m(batch.take(chosen)) >= separation_m]
            found += safe[:COMPARED].tolist()
            if len(safe) or len(found) >= COMPARED:
                break
        unique = np.array(sorted(set(found)), dtype=np.intp)
        return batch.take(unique[np.argsort(batch.lengths_m[unique], kind="stable")])

    def _best_covering(self, batch: PathBatch) -> PathBatch:
        """Return the path, of some in order of length, with the best coverage."""
        return batch.take([int(np.argmax(self.coverage(batch)))])

    def _finer_loop(
        self,
        problem: CaptureProblem,
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
        for begin in range(0, len(order), CHUNK):
            chosen = order[begin : begin + CHUNK]
            part = batch.take(chosen)
            safe = np.flatnonzero(self.distances_m(part) >= separation_m)
            if safe.size:
                best = int(safe[0])
                return rules[chosen[best]], part.take([best])
        return None

    def _corner_plan(self, rule: Rule, lag_m: float, batch: PathBatch) -> CornerPlan:
        path = self._frame.path_to_map(batch.path(0))
        p = self.parameters
        late = (1.0 / self._made_good - 1.0) * (path.length_m - float(batch.rows[0, STRAIGHT_P]))
        return CornerPlan(rule, lag_m, next_lag_m(path, p) + late, path, p)
