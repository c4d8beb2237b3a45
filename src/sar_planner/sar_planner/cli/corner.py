"""``corner``: what a rule set does at one corner, offline."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from sar_estimator.common.checked import read
from sar_planner.parameters.corner import RULE_SETS, CornerParameters, ParameterError
from sar_planner.prediction.separation import closest_approach
from sar_planner.rules.deadbeat_automaton import DeadbeatAutomaton
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule, build
from sar_planner.rules.rule_sets import make_rule_set

FIELDS = {
    "speed": "speed_mps",
    "radius": "turn_radius_m",
    "accel": "accel_mps2",
    "spacing": "spacing_m",
    "convergence": "convergence",
    "taylor-y": "taylor_y_m",
    "separation": "min_separation_m",
}
FORCED = tuple(str(rule) for rule in Rule if rule is not Rule.RJ)
PAPER_RULES = (Rule.T1, Rule.T2, Rule.T3, Rule.T4)


def _arguments(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="corner", description=__doc__)
    parser.add_argument("--lag", type=float, help="L(k), the UAV's lag in metres")
    parser.add_argument("--rules", choices=RULE_SETS, default="deadbeat")
    parser.add_argument("--rule", choices=FORCED, help="this rule, whatever its domain")
    parser.add_argument("--lead", type=float, default=0.0, help="metres flown straight on first")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--graph", action="store_true", help="print the automaton (fig. 8)")
    parser.add_argument("--params", type=Path, help="YAML file of corner parameters")
    for option, field in FIELDS.items():
        parser.add_argument(f"--{option}", type=float, help=f"{field}, instead of the default")
    args = parser.parse_args(argv)
    if args.lag is None and not args.graph:
        parser.error("--lag or --graph: expected at least one")
    return args


def _parameters(args: argparse.Namespace) -> CornerParameters:
    values: dict[str, Any] = {}
    if args.params is not None:
        loaded = yaml.safe_load(args.params.read_text(encoding="utf-8"))
        try:
            values = asdict(read(CornerParameters, loaded))
        except ValueError as error:
            raise ParameterError(f"{args.params}: {error}") from error
    for option, field in FIELDS.items():
        given = getattr(args, option.replace("-", "_"))
        if given is not None:
            values[field] = given
    return read(CornerParameters, values)


def summary(plan: CornerPlan) -> dict[str, object]:
    """Return the plan as the JSON object that ``corner --json`` prints."""
    nearest = closest_approach(plan.path, plan.parameters)
    return {
        "rule": str(plan.rule),
        "lag_m": plan.lag_m,
        "next_lag_m": plan.next_lag_m,
        "length_m": plan.path.length_m,
        "closest_approach_m": nearest.distance_m,
        "closest_approach_s": nearest.time_s,
        "segments": [
            {"kind": type(part).__name__.lower(), "length_m": part.length_m}
            | ({"turn_rad": part.turn_rad} if hasattr(part, "turn_rad") else {})
            for part in plan.path.segments
        ],
        "path": [[float(x), float(y)] for x, y in plan.path.sample(5.0)],
    }


def _print_plan(plan: CornerPlan, *, as_json: bool) -> None:
    values = summary(plan)
    if as_json:
        sys.stdout.write(json.dumps(values) + "\n")
        return
    sys.stdout.write(
        f"rule              {plan.rule} ({plan.rule.label})\n"
        f"L(k)              {plan.lag_m:.4f} m\n"
        f"L(k+1)            {plan.next_lag_m:.4f} m\n"
        f"path length       {plan.path.length_m:.3f} m\n"
        f"closest approach  {values['closest_approach_m']:.2f} m"
        f" at {values['closest_approach_s']:.2f} s\n"
        "path, m (x along the old leg, y to its left, origin at the corner):\n"
    )
    for x, y in plan.path.sample(5.0):
        sys.stdout.write(f"{x:10.2f} {y:10.2f}\n")


def _plan(
    automaton: PaperAutomaton | DeadbeatAutomaton, lag_m: float, rule: str | None, lead_m: float
) -> CornerPlan:
    if rule is None:
        return automaton.plan(lag_m, lead_m=lead_m)
    if isinstance(automaton, DeadbeatAutomaton):
        return automaton.plan(lag_m, lead_m=lead_m, only=Rule(rule))
    return build(Rule(rule), lag_m, automaton.parameters, lead_m=lead_m)


def main(argv: list[str] | None = None) -> int:
    """Run the command; 2 on bad input."""
    args = _arguments(argv)
    try:
        rules = args.rules
        if args.rule is not None:
            rules = "paper" if args.rule in PAPER_RULES else "deadbeat"
        automaton = make_rule_set(rules, _parameters(args))
        if args.graph:
            sys.stdout.write(automaton.describe() + "\n")
        if args.lag is not None:
            plan = _plan(automaton, args.lag, args.rule, args.lead)
            _print_plan(plan, as_json=args.json)
    except (ParameterError, NoPathError, ValueError, OSError) as error:
        sys.stderr.write(f"corner: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
