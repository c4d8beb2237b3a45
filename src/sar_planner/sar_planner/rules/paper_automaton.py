"""The finite automaton of the path rules (Ryan & Hedrick 2005, (3) and fig. 8)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sar_planner.parameters.corner import CornerParameters, check
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule, build


@dataclass(frozen=True, slots=True)
class Interval:
    """Lags from ``low_m`` to ``high_m`` [m]; which ends belong to it is told by the flags."""

    low_m: float
    high_m: float
    low_closed: bool
    high_closed: bool

    def __contains__(self, lag_m: float) -> bool:
        """Whether a lag [m] lies in the interval."""
        above = lag_m >= self.low_m if self.low_closed else lag_m > self.low_m
        below = lag_m <= self.high_m if self.high_closed else lag_m < self.high_m
        return above and below

    def __str__(self) -> str:
        """Mathematical notation, one decimal."""
        left, right = "[" if self.low_closed else "(", "]" if self.high_closed else ")"
        return f"{left}{self.low_m:.1f}, {self.high_m:.1f}{right}"

    def meet(self, other: Interval) -> Interval | None:
        """Return the intersection, None when empty."""
        low, low_closed = max(
            (self.low_m, not self.low_closed), (other.low_m, not other.low_closed)
        )
        high, high_closed = min((self.high_m, self.high_closed), (other.high_m, other.high_closed))
        met = Interval(low, high, not low_closed, high_closed)
        if low > high or (low == high and not (met.low_closed and met.high_closed)):
            return None
        return met


@dataclass(frozen=True, slots=True)
class Transition:
    """From one rule to the next, for the lags L(k) of ``lags`` [m]."""

    source: Rule
    target: Rule
    lags: Interval


class PaperAutomaton:
    """The paper's mode switching: which rule is enabled for a lag, and the plan it makes.

    Raises ``ParameterError`` for parameters outside the paper's conditions, unless ``enforce`` is
    off (for parameters measured in flight).
    """

    name = "paper"

    def __init__(self, parameters: CornerParameters, *, enforce: bool = True) -> None:
        """Check the parameters and fix the domains."""
        if enforce:
            check(parameters)
        self.parameters = parameters
        p, inf = parameters, math.inf
        self.domains = {
            Rule.T1: Interval(p.cut_lag_m, inf, low_closed=True, high_closed=False),
            Rule.T2: Interval(p.fixed_lag_m, p.cut_lag_m, low_closed=True, high_closed=False),
            Rule.T3: Interval(-p.stopping_m, p.fixed_lag_m, low_closed=False, high_closed=False),
            Rule.T4: Interval(-inf, -p.stopping_m, low_closed=False, high_closed=True),
        }

    def rule_for(self, lag_m: float) -> Rule:
        """Return the one rule whose domain holds the lag. Raises ``ValueError`` for NaN."""
        for rule, domain in self.domains.items():
            if lag_m in domain:
                return rule
        raise ValueError(f"lag {lag_m}: expected a finite number of metres")

    def plan(self, lag_m: float, *, lead_m: float = 0.0) -> CornerPlan:
        """Return the enabled rule's plan for lag L [m].

        Should the lead-in leave that rule no path, the next rule that has one is taken: a UAV that
        may turn late is past the reach of a tight curve, never of the outside loop behind it.
        Raises ``NoPathError`` when no rule has a path.
        """
        chosen = self.rule_for(lag_m)
        order = (chosen, *(rule for rule in (Rule.T2, Rule.T3, Rule.T4) if rule is not chosen))
        failures = []
        for rule in order:
            try:
                return build(rule, lag_m, self.parameters, lead_m=lead_m)
            except NoPathError as error:
                failures.append(f"{rule}: {error}")
        raise NoPathError("; ".join(failures))

    def progression_m(self, rule: Rule, lag_m: float) -> float:
        """Return F_i(L) [m] of (4), (5), (6), (10); infinite at an infinite lag."""
        p = self.parameters
        r, s, d, c = p.turn_radius_m, p.stopping_m, p.spacing_m, p.convergence
        if rule is Rule.T1:
            return lag_m - 2.0 * s - 2.0 * d + (math.pi / 2.0 - 2.0) * r
        if rule is Rule.T2:
            return lag_m - (1.0 - c) * p.fixed_lag_m
        if rule is Rule.T3:
            return c * lag_m
        return 1.5 * math.pi * r - 3.0 * s - d + math.hypot(r, lag_m + s - d + r)

    def _inverse_m(self, rule: Rule, next_lag_m: float) -> float:
        """Return the lag [m] of the rule's domain from which F_i leads to ``next_lag_m``."""
        p = self.parameters
        r, s, d = p.turn_radius_m, p.stopping_m, p.spacing_m
        if math.isinf(next_lag_m):
            return -next_lag_m if rule is Rule.T4 else next_lag_m
        if rule is Rule.T3:
            return next_lag_m / p.convergence
        if rule is Rule.T4:
            root = next_lag_m - 1.5 * math.pi * r + 3.0 * s + d
            return d - r - s - math.sqrt(max(0.0, root**2 - r**2))
        return next_lag_m - self.progression_m(rule, 0.0)

    def image(self, rule: Rule) -> Interval:
        """Return the range of L(k+1) [m] over the rule's domain (F_4 falls, the others rise)."""
        domain = self.domains[rule]
        low = self.progression_m(rule, domain.low_m)
        high = self.progression_m(rule, domain.high_m)
        if rule is Rule.T4:
            return Interval(high, low, domain.high_closed, domain.low_closed)
        return Interval(low, high, domain.low_closed, domain.high_closed)

    def transitions(self) -> list[Transition]:
        """Compute every transition of fig. 8, with the lags from which it is taken."""
        found = []
        for source in self.domains:
            for target, domain in self.domains.items():
                reached = self.image(source).meet(domain)
                if reached is None:
                    continue
                ends = [
                    (self._inverse_m(source, reached.low_m), reached.low_closed),
                    (self._inverse_m(source, reached.high_m), reached.high_closed),
                ]
                (low, low_closed), (high, high_closed) = sorted(ends)
                found.append(
                    Transition(source, target, Interval(low, high, low_closed, high_closed))
                )
        return found

    def step_bounds(self, first_lag_m: float) -> tuple[int, int]:
        """Return (N_1, N_2) of (14): the most corners spent in T1 and in T2 from L(1) [m]."""
        p = self.parameters
        drop_1 = -self.progression_m(Rule.T1, 0.0)
        drop_2 = -self.progression_m(Rule.T2, 0.0)
        over = max(0.0, first_lag_m - p.cut_lag_m)
        return (
            math.floor(over / drop_1) + (1 if first_lag_m >= p.cut_lag_m else 0),
            math.ceil((p.cut_lag_m - p.fixed_lag_m) / drop_2),
        )

    def describe(self) -> str:
        """Return the automaton of fig. 8 as text: domains, ranges, transitions."""
        lines = [f"{self.name} rules: domains of L(k), ranges of L(k+1), transitions (metres)"]
        for rule, domain in self.domains.items():
            lines.append(f"{rule} {rule.label:<13} L in {domain!s:<18} -> {self.image(rule)}")
        lines += [f"  {t.source} -> {t.target}  for L in {t.lags}" for t in self.transitions()]
        return "\n".join(lines)
