"""The finite automaton of the deadbeat rules: everything in it is computed from the parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise

from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.prediction.separation import closest_approach
from sar_planner.rules.deadbeat_rules import CONVERGED_M, DeadbeatRules
from sar_planner.rules.paper_automaton import Interval, Transition
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule

LOW, MIDDLE, HIGH = -3.2, 4.6, 5.6
FEW_CORNERS, MORE_CORNERS = 2, 3
GRID = 0.04
COARSE_GRID = 0.16
EDGE_M = 0.1
BISECTIONS = 5


@dataclass(frozen=True, slots=True)
class Step:
    """What the rules do with one lag: the rule, L(k+1) [m] and the closest approach [m]."""

    lag_m: float
    rule: Rule
    next_lag_m: float
    closest_m: float


def _lags(parameters: CornerParameters, grid: float) -> Iterator[float]:
    count = round((HIGH - LOW) / grid)
    for i in range(count + 1):
        yield parameters.spacing_m * (LOW + (HIGH - LOW) * i / count)


def first_failure(parameters: CornerParameters, grid: float) -> str:
    """Return which guarantee does not hold, empty when all do on a grid of lags (in units of d).

    From -3.2 d to 5.6 d every lag has a path that keeps the separation, and |L| is no more than
    ``CONVERGED_M`` after 2 corners, from above 4.6 d after 3.
    """
    rules = DeadbeatRules(parameters)
    for lag in _lags(parameters, grid):
        allowed = FEW_CORNERS if lag <= MIDDLE * parameters.spacing_m else MORE_CORNERS
        at = lag
        for _ in range(allowed):
            try:
                at = rules.plan(at, separation_m=parameters.separation_m).next_lag_m
            except NoPathError as error:
                return str(error)
            if abs(at) <= CONVERGED_M:
                break
        else:
            return f"L = {lag:.0f} m: after {allowed} corners still {at:.0f} m"
    return ""


def _bound(parameters: CornerParameters, name: str, given: float, far: float) -> tuple[float, bool]:
    """Return the value nearest to ``given`` with which the rules hold, and whether there is one."""

    def holds(value: float) -> bool:
        return not first_failure(replace(parameters, **{name: value}), COARSE_GRID)

    if not holds(far):
        return far, False
    bad, good = given, far
    for _ in range(BISECTIONS):
        middle = 0.5 * (bad + good)
        bad, good = (bad, middle) if holds(middle) else (middle, good)
    return good, True


@lru_cache(maxsize=64)
def check_deadbeat(parameters: CornerParameters) -> None:
    """Refuse parameters for which the rules cannot give their guarantees.

    Raises ``ParameterError`` naming the parameter, its value and the bound found by bisection.
    """
    p = parameters
    if p.separation_m >= p.spacing_m:
        raise ParameterError(
            f"min_separation_m = {p.separation_m}: expected less than spacing_m = {p.spacing_m}"
        )
    failure = first_failure(p, GRID)
    if not failure:
        return
    for name, given, far, relation in (
        ("turn_radius_m", p.turn_radius_m, 0.2 * p.turn_radius_m, "at most"),
        ("min_separation_m", p.separation_m, 0.3 * p.spacing_m, "at most"),
        ("accel_mps2", p.accel_mps2, 8.0 * p.accel_mps2, "at least"),
        ("spacing_m", p.spacing_m, 4.0 * p.spacing_m, "at least"),
    ):
        bound, found = _bound(p, name, given, far)
        if found:
            raise ParameterError(
                f"{name} = {given:g}: expected {relation} {bound:.4g}, for deadbeat rules with "
                f"these other parameters ({failure})"
            )
    raise ParameterError(f"deadbeat rules: no guarantee with these parameters ({failure})")


class DeadbeatAutomaton:
    """Which rule is taken for a lag, and the plan it makes.

    Raises ``ParameterError`` for parameters without the guarantees, unless ``enforce`` is off (for
    parameters measured in flight).
    """

    name = "deadbeat"

    def __init__(self, parameters: CornerParameters, *, enforce: bool = True) -> None:
        """Check the parameters."""
        if enforce:
            check_deadbeat(parameters)
        self.parameters = parameters
        self._rules = DeadbeatRules(parameters)

    def rule_for(self, lag_m: float) -> Rule:
        """Return the rule taken for a lag [m]. Raises ``ValueError`` for NaN."""
        return self.plan(lag_m).rule

    def plan(
        self,
        lag_m: float,
        *,
        lead_m: float = 0.0,
        separation_m: float | None = None,
        only: Rule | None = None,
    ) -> CornerPlan:
        """Return the plan for lag L [m], the UAV turning no earlier than ``lead_m`` [m].

        ``separation_m``: in the place of the parameters'. ``only``: this rule. Raises
        ``NoPathError`` when no path keeps it, ``ValueError`` for a lag that is no number.
        """
        if not math.isfinite(lag_m):
            raise ValueError(f"lag {lag_m}: expected a finite number of metres")
        least = self.parameters.separation_m if separation_m is None else separation_m
        return self._rules.plan(lag_m, lead_m=lead_m, separation_m=least, only=only)

    def step(self, lag_m: float) -> Step:
        """Return what happens at one corner begun with lag L [m]."""
        plan = self.plan(lag_m)
        nearest = closest_approach(plan.path, self.parameters)
        return Step(lag_m, plan.rule, plan.next_lag_m, nearest.distance_m)

    @cached_property
    def steps(self) -> list[Step]:
        """One step for every lag of the grid from -3.2 d to 5.6 d."""
        return [self.step(lag) for lag in _lags(self.parameters, GRID)]

    def _stretches(self, kind: Callable[[Step], object]) -> list[tuple[object, list[Step]]]:
        """Cut the grid where ``kind`` changes; the cuts are found to ``EDGE_M``."""
        found: list[tuple[object, list[Step]]] = [(kind(self.steps[0]), [self.steps[0]])]
        for before, after in pairwise(self.steps):
            if kind(after) == found[-1][0]:
                found[-1][1].append(after)
                continue
            low, high = before, after
            while high.lag_m - low.lag_m > EDGE_M:
                middle = self.step(0.5 * (low.lag_m + high.lag_m))
                low, high = (middle, high) if kind(middle) == found[-1][0] else (low, middle)
            found[-1][1].append(low)
            found.append((kind(high), [high, after]))
        return found

    @cached_property
    def domains(self) -> list[tuple[Rule, Interval]]:
        """The domains of L in order; together they are the whole line."""
        pieces = self._stretches(lambda step: step.rule)
        edges = [-math.inf, *(steps[0].lag_m for _, steps in pieces[1:]), math.inf]
        return [
            (steps[0].rule, Interval(low, high, low > -math.inf, high_closed=False))
            for (_, steps), low, high in zip(pieces, edges, edges[1:], strict=False)
        ]

    @cached_property
    def deadbeat(self) -> Interval:
        """The lags around 0 from which one corner leaves no more than ``CONVERGED_M``."""
        for kind, steps in self._stretches(lambda step: abs(step.next_lag_m) <= CONVERGED_M):
            if kind and steps[0].lag_m <= 0.0 <= steps[-1].lag_m:
                return Interval(steps[0].lag_m, steps[-1].lag_m, low_closed=True, high_closed=True)
        raise NoPathError("deadbeat rules: L = 0 is not kept")

    def transitions(self) -> list[Transition]:
        """Compute every transition, with the lags from which it is taken."""
        return [
            Transition(
                steps[0].rule,
                self.rule_for(steps[len(steps) // 2].next_lag_m),
                Interval(steps[0].lag_m, steps[-1].lag_m, low_closed=True, high_closed=True),
            )
            for _, steps in self._stretches(
                lambda step: (step.rule, self._domain_of(step.next_lag_m))
            )
        ]

    def _domain_of(self, lag_m: float) -> int:
        return next(i for i, (_, domain) in enumerate(self.domains) if lag_m in domain)

    def describe(self) -> str:
        """Return domains, ranges, bounds and transitions as text."""
        p = self.parameters
        lines = [
            f"{self.name} rules: domains of L(k), ranges of L(k+1), closest approach (metres)",
            (
                f"computed for L from {LOW * p.spacing_m:.0f} to {HIGH * p.spacing_m:.0f}, "
                f"separation {p.separation_m:.0f} or more"
            ),
        ]
        pieces = self._stretches(lambda step: step.rule)
        for (rule, domain), (_, steps) in zip(self.domains, pieces, strict=True):
            nexts = [step.next_lag_m for step in steps]
            nearest = min(step.closest_m for step in steps)
            lines.append(
                f"{rule} {rule.label:<16} L in {domain!s:<18} -> "
                f"[{min(nexts):.1f}, {max(nexts):.1f}], apart {nearest:.1f} or more"
            )
        lines.append(f"one corner leaves {CONVERGED_M} or less for L in {self.deadbeat}")
        lines += [f"  {t.source} -> {t.target}  for L in {t.lags}" for t in self.transitions()]
        return "\n".join(lines)
