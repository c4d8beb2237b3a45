"""The paper's results and this project's beside them, as the text of ``docs/results.md``."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.separation import closest_approach
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_planner.rules.paper_rules import Rule
from sar_planner.rules.rule_sets import make_rule_set
from sar_sim.campaign.campaign_table import Estimate, Summary, spread_of

# Ryan & Hedrick (2005): table I, and section IV-C.
PRINTED_COVERAGE = {0.0: "99.65", 0.05: "99.63", 0.1: "99.83"}
PRINTED_EXTRA = "300 to 550"
PRINTED_LAG = "400 to 1000, for ever"
PLANNERS = ("paper", "deadbeat", "follow")
AUTOPILOTS = ("ideal", "piccolo2005", "arduplane")
ERRORS = {"turns wide": "wide_turns", "loses way": "extra_path"}
FIRST_LAGS_M = (650.0, 800.0, 1000.0, 1400.0)
SAFETY_STEP_M = 1.0

Key = tuple[str, str, float]


def keyed(found: Iterable[Summary]) -> dict[Key, Summary]:
    """Return summaries by planner, autopilot and redundancy."""
    return {
        (
            one.combination.labels["planner"],
            one.combination.labels["uav"],
            one.combination.scenario.sensor.redundancy,
        ): one
        for one in found
    }


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = ["| " + " | ".join(row) + " |" for row in (head, *rows)]
    lines.insert(1, "|" + "---|" * len(head))
    return "\n".join(lines)


def comparison(found: Mapping[Key, Summary]) -> str:
    """Return the table of all planners on all autopilots, the paper's print beside them."""
    columns = [(planner, uav) for planner in PLANNERS for uav in AUTOPILOTS]

    def row(title: str, printed: str, of: Callable[[Summary], str], share: float) -> list[str]:
        return [title, printed, *(of(found[planner, uav, share]) for planner, uav in columns)]

    def value(name: str, digits: int) -> Callable[[Summary], str]:
        return lambda one: _short(one.values()[name], digits)

    def late(one: Summary) -> str:
        names = ("median", "p95", "max")
        return " / ".join(f"{one.values()[f'late_lag_{name}_m'].value:.0f}" for name in names)

    rows = [
        row("\\|L(k)\\| from corner 4, median / 95 % / most [m]", PRINTED_LAG, late, 0.0),
        row("missions within 15 m for good [%]", "", value("converged_percent", 0), 0.0),
        row("after how many corners", "", value("corners_to_converge", 1), 0.0),
        row("extra path a corner [m]", PRINTED_EXTRA, value("extra_path_m", 0), 0.0),
        row("closest approach, least [m]", "", value("separation_least_m", 0), 0.0),
        row("closest approach, mean [m]", "", value("separation_m", 0), 0.0),
    ]
    for share, printed in PRINTED_COVERAGE.items():
        title = f"coverage, f = {100.0 * share:.0f} % [%]"
        rows.append(row(title, printed, value("coverage_percent", 2), share))
    for title, name, digits in (
        ("overlap [%]", "overlap_percent", 1),
        ("search rate [km²/h]", "rate_km2_per_h", 1),
    ):
        for share in PRINTED_COVERAGE:
            of = value(name, digits)
            rows.append(row(f"{title}, f = {100.0 * share:.0f} %", "", of, share))
    head = ["", "paper's print", *(f"{planner}, {uav}" for planner, uav in columns)]
    return table(head, rows)


def _short(estimate: Estimate, digits: int) -> str:
    """Return a mean and half its interval; ``–`` where there is none."""
    if math.isnan(estimate.value):
        return "–"
    text = f"{estimate.value:.{digits}f}"
    if math.isnan(estimate.low):
        return text
    return f"{text} ± {0.5 * (estimate.high - estimate.low):.{digits}f}"


@dataclass(frozen=True)
class Nearest:
    """The closest approach [m] of one rule over its domain, at which lag [m] and time [s]."""

    rule: Rule
    distance_m: float
    lag_m: float
    time_s: float


def nearest_by_rule(rules: str, lags_m: Iterable[float]) -> list[Nearest]:
    """Return each rule's closest approach with perfect tracking, in order of the rules."""
    parameters = CornerParameters()
    automaton = make_rule_set(rules, parameters)
    found: dict[Rule, Nearest] = {}
    for lag in lags_m:
        plan = automaton.plan(lag)
        at = closest_approach(plan.path, parameters)
        if plan.rule not in found or at.distance_m < found[plan.rule].distance_m:
            found[plan.rule] = Nearest(plan.rule, at.distance_m, lag, at.time_s)
    return [found[rule] for rule in Rule if rule in found]


def safety(lags_m: Sequence[float]) -> str:
    """Return the closest approaches of both rule sets as a table."""
    rows = [
        [
            f"{one.rule} {one.rule.label}",
            f"{one.distance_m:.1f}",
            f"{one.lag_m:.0f}",
            f"{one.time_s:.1f}",
        ]
        for rules in ("paper", "deadbeat")
        for one in nearest_by_rule(rules, lags_m)
    ]
    return table(["rule", "closest approach [m]", "at L [m]", "after [s]"], rows)


def corners_in(automaton: PaperAutomaton, lag_m: float) -> tuple[int, int]:
    """Return how many corners are flown in T1 and in T2, perfectly tracked, until T3 is reached."""
    counts = {Rule.T1: 0, Rule.T2: 0, Rule.T4: 0}
    while (rule := automaton.rule_for(lag_m)) is not Rule.T3:
        counts[rule] += 1
        lag_m = automaton.progression_m(rule, lag_m)
    return counts[Rule.T1], counts[Rule.T2]


def bounds(found: Mapping[Key, Summary]) -> str:
    """Return the bounds of (14) beside what is counted from some first lags, and what was flown."""
    automaton = PaperAutomaton(CornerParameters())
    rows = []
    for lag in FIRST_LAGS_M:
        most, counted = automaton.step_bounds(lag), corners_in(automaton, lag)
        rows.append([f"{lag:.0f}", *(str(n) for n in (most[0], counted[0], most[1], counted[1]))])
    flown = table(["L(1) [m]", "N1 bound", "T1 counted", "N2 bound", "T2 counted"], rows)
    lines = [flown, ""]
    for uav in AUTOPILOTS:
        flown_by = found["paper", uav, 0.0].missions
        counts = Counter(rule for one in flown_by for rule in one.rules)
        corners = max(1, counts.total())
        rules = ("T1", "T2", "T3", "T4")
        told = ", ".join(f"{rule} {100.0 * counts[rule] / corners:.0f} %" for rule in rules)
        lines.append(f"* Flown by `{uav}`: {told} of the corners.")
    return "\n".join(lines)


def failure(found: Mapping[str, Sequence[Summary]]) -> str:
    """Return what the errors of the paper's hardware-in-the-loop runs do, rules by rules."""
    rows = []
    for error, one in ((error, one) for error, flown in found.items() for one in flown):
        begun = one.combination.from_corner - 1
        late = sorted(abs(lag) for m in one.missions for lag in m.lags_m[begun:])
        low, high = late[int(0.05 * len(late))], late[int(0.95 * (len(late) - 1))]
        values, curves = one.values(), one.extra_by_rule_m().get("T2")
        rows.append(
            [
                error,
                one.combination.name,
                f"{low:.0f} to {high:.0f}",
                _short(values["extra_path_m"], 0),
                "-" if curves is None else spread_of(curves),
                f"{values['separation_least_m'].value:.0f}",
                f"{values['escapes'].value:.0f}",
            ]
        )
    head = [
        *("error", "rules", "\\|L(k)\\|, 90 % of them [m]", "extra path a corner [m]"),
        *("of curves (T2), 90 % of them [m]", "closest approach, least [m]"),
        "sent away by the monitor",
    ]
    return table(head, rows)


PAGE = """# The paper's results, and what is flown here

Written by `ros2 run sar_sim results --out docs{options}`; nothing on this page is typed in.
{missions} missions of expanding squares of twelve corners, first leg 1,500 m, L(1) from -300 to
1000 m, 1 Hz GPS of 3 m standard deviation, calm; disc footprint, coverage from the third corner
on. What follows ± is half the 95 % interval. "paper" are the rules of Ryan & Hedrick (2005),
"follow" a UAV that chases its slot point as ArduPlane's follow script does; the monitor only
watches these two, and is in the loop of "deadbeat". `ideal` is the paper's kinematic autopilot,
`piccolo2005` one that believes in a smaller turn radius than it has and gets arc ends only,
`arduplane` ArduPlane's guidance.

## All of it

{comparison}

![L(k) of every mission](results_lags.png)

## Table I: coverage against redundancy

The row "coverage" above; the printed figures are of single runs.

## Fig. 8: the transitions, computed

```
{transitions}
```

```
{deadbeat}
```

![L(k+1) and closest approach against L(k)](results_rules.png)

## Figs. 9 and 10: a flight of the paper's rules by `piccolo2005`

![both tracks](results_fig9.png)

![one corner](results_fig10.png)

## (14): how many corners T1 and T2 take

{bounds}

## How near the rules bring the two aircraft with perfect tracking

For every L from {low:.0f} to {high:.0f} m, {step:g} m apart; d = 250 m.

{safety}

## 300 to 550 m of extra path at every corner

L(k) from the third corner on. "turns wide": the cause that the paper names, a UAV that turns with
132 to 150 m at the tightest where 100 m is believed, drawn anew at every corner. "loses way": one
that makes good 60 % of its speed from the first turn on, until 300 to 550 m are lost.

{failure}
"""


def page(
    found: Sequence[Summary],
    failed: Mapping[str, Sequence[Summary]],
    lags_m: Sequence[float],
    options: str,
) -> str:
    """Return the whole page.

    ``found``: of the campaign ``planners``, ``failed``: of those of ``ERRORS``, by what is wrong.
    ``lags_m``: at which the rules' closest approaches are looked for.
    """
    parameters = CornerParameters()
    by_key = keyed(found)
    return PAGE.format(
        options=options,
        missions=sum(len(one.missions) for one in found),
        comparison=comparison(by_key),
        transitions=PaperAutomaton(parameters).describe(),
        deadbeat=make_rule_set("deadbeat", parameters).describe(),
        bounds=bounds(by_key),
        low=lags_m[0],
        high=lags_m[-1],
        step=SAFETY_STEP_M,
        safety=safety(lags_m),
        failure=failure(failed),
    )
