"""``corner``: what a rule set does at one corner, offline."""

from __future__ import annotations

import argparse
import json
import math
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from sar_estimator.common.checked import read
from sar_planner.cli.corner_wind import CornerWind, described, planned_in_wind
from sar_planner.cli.envelope import pair
from sar_planner.cli.pattern_corners import corners_of, line_of
from sar_planner.parameters.corner import RULE_SETS, CornerParameters, ParameterError
from sar_planner.parameters.mission import MissionParameters
from sar_planner.patterns.legs import CORNERS, PatternTerms
from sar_planner.patterns.slot import Slot
from sar_planner.prediction.separation import ClosestApproach, closest_approach, corner_forecast
from sar_planner.prediction.tube import SureApart, sure_apart, tube_about
from sar_planner.rules.deadbeat_automaton import DeadbeatAutomaton
from sar_planner.rules.deadbeat_rules import DeadbeatRules
from sar_planner.rules.outside_rules import OutsideRules
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_planner.rules.paper_rules import OUTSIDE, CornerPlan, NoPathError, Rule, build
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
FORCED = tuple(str(rule) for rule in Rule if rule not in (*OUTSIDE, Rule.RJ))
SIDES = {
    "inside": "on the inside of the turn",
    "outside": "about the outside of the turn",
    "over": "over from its inside to its outside",
}
RIGHT_ANGLE_DEG = 90.0
PATTERN_CORNERS = 6
PATTERNS = ("expanding_square", "sector", "parallel_track", "creeping_line", "track_line_return")
GRAPH_M, GRAPH_STEP_M = (-200, 600), 25
PAPER_RULES = (Rule.T1, Rule.T2, Rule.T3, Rule.T4)


def _arguments(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="corner", description=__doc__)
    parser.add_argument("--lag", type=float, help="L(k), the UAV's lag in metres")
    parser.add_argument("--rules", choices=RULE_SETS, default="deadbeat")
    parser.add_argument("--rule", choices=FORCED, help="this rule, whatever its domain")
    parser.add_argument("--lead", type=float, default=0.0, help="metres flown straight on first")
    parser.add_argument("--side", choices=(*SIDES, "right", "left"), default="inside")
    parser.add_argument("--turn", type=float, default=RIGHT_ANGLE_DEG, help="degrees")
    parser.add_argument("--pattern", choices=PATTERNS, help="its corners, for a slot on --side")
    parser.add_argument("--tracks", type=int, choices=(1, 2, 3), default=1, help="of that slot")
    parser.add_argument("--wind", type=pair, metavar="MPS,FROM", help="flown in it; from [deg]")
    parser.add_argument("--course", type=float, default=0.0, help="of the old leg, with --wind")
    parser.add_argument("--airspeed", type=pair, default=(10.0, 30.0), metavar="MIN,MAX")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--graph", action="store_true", help="print the automaton (fig. 8)")
    parser.add_argument("--params", type=Path, help="YAML file of corner parameters")
    for option, field in FIELDS.items():
        parser.add_argument(f"--{option}", type=float, help=f"{field}, instead of the default")
    args = parser.parse_args(argv)
    if args.lag is None and not args.graph and args.pattern is None:
        parser.error("--lag, --graph or --pattern: expected at least one")
    if args.pattern is None and args.side not in SIDES:
        parser.error(f"--side {args.side}: expected with --pattern")
    if args.pattern is not None and args.side == "over":
        parser.error("--side over: expected without --pattern, which says where the UAV goes over")
    plain = args.side == "inside" and args.turn == RIGHT_ANGLE_DEG and args.rule is None
    if args.wind is not None and not (plain and args.rules == "deadbeat" and not args.json):
        parser.error("--wind: expected with the deadbeat rules at a right angle, inside, no --json")
    if not args.airspeed[0] < args.airspeed[1]:
        parser.error(f"--airspeed {args.airspeed}: expected MIN less than MAX")
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


def sure_of(plan: CornerPlan, turn_rad: float) -> SureApart:
    """Return what a path keeps from all of the tube about its corner, flown at V from the onset."""
    tube = tube_about(corner_forecast(plan.parameters, turn_rad), 0.0, 0.0)
    assert tube is not None
    sure = sure_apart(
        plan.path,
        tube,
        start_s=0.0,
        speed_mps=plan.parameters.speed_mps,
        reaction_s=MissionParameters().reaction_s,
    )
    assert sure is not None
    return sure


def summary(plan: CornerPlan, nearest: ClosestApproach, sure: SureApart) -> dict[str, object]:
    """Return the plan as the JSON object that ``corner --json`` prints."""
    return {
        "rule": str(plan.rule),
        "lag_m": plan.lag_m,
        "next_lag_m": plan.next_lag_m,
        "length_m": plan.path.length_m,
        "closest_approach_m": nearest.distance_m,
        "closest_approach_s": nearest.time_s,
        "sure_m": sure.distance_m,
        "sure_until_s": sure.until_s,
        "segments": [
            {"kind": type(part).__name__.lower(), "length_m": part.length_m}
            | ({"turn_rad": part.turn_rad} if hasattr(part, "turn_rad") else {})
            for part in plan.path.segments
        ],
        "path": [[float(x), float(y)] for x, y in plan.path.sample(5.0)],
    }


def _print_plan(
    plan: CornerPlan, nearest: ClosestApproach, turn_rad: float, *, as_json: bool
) -> None:
    sure = sure_of(plan, turn_rad)
    values = summary(plan, nearest, sure)
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
        f"sure in its tube  {values['sure_m']:.1f} m until {values['sure_until_s']:.1f} s\n"
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


def _one_rule_set(args: argparse.Namespace, parameters: CornerParameters) -> None:
    """Print what the rules of one side, or of another turn than a right angle, do."""
    turn_rad = math.radians(args.turn)
    from_m = {"outside": parameters.spacing_m, "over": -parameters.spacing_m}.get(args.side)
    rules = (
        DeadbeatRules(parameters, turn_rad=turn_rad)
        if from_m is None
        else OutsideRules(parameters, turn_rad, from_m=from_m)
    )
    if args.graph:
        _graph(f"{SIDES[args.side]}, {args.turn:g} degrees", rules, args.lead)
    if args.lag is not None:
        plan = rules.plan(args.lag, lead_m=args.lead, separation_m=parameters.separation_m)
        _print_plan(plan, rules.closest(plan.path), turn_rad, as_json=args.json)


def _graph(name: str, rules: DeadbeatRules | OutsideRules, lead_m: float) -> None:
    sys.stdout.write(f"{name}: L(k), rule, L(k+1), closest (metres)\n")
    for lag in range(GRAPH_M[0], GRAPH_M[1] + 1, GRAPH_STEP_M):
        line = line_of(rules, lag, lead_m, rules.parameters.separation_m)
        sys.stdout.write(f"{lag:6d}  {line}\n")


def _pattern(args: argparse.Namespace, parameters: CornerParameters) -> None:
    """Print what a slot does at the corners of a pattern."""
    slot = Slot(args.side, args.tracks)
    count = min(CORNERS.get(args.pattern, PATTERN_CORNERS), PATTERN_CORNERS)
    corners = list(corners_of(PatternTerms(args.pattern), slot, parameters.spacing_m, count))
    own, lag_m = parameters.beside(slot.tracks), args.lag or 0.0
    sys.stdout.write(
        f"{args.pattern}, slot {slot}, L(k) = {lag_m:g}: corner, turn, places, rule, L(k+1),"
        " closest (metres)\n"
    )
    kinds: dict[object, tuple[str, DeadbeatRules | OutsideRules]] = {}
    for corner in corners:
        try:
            rules = corner.rules(own)
        except NoPathError as error:
            line = str(error)
        else:
            line = line_of(rules, lag_m, args.lead, own.separation_m)
            kinds.setdefault(corner.kind, (str(corner), rules))
        sys.stdout.write(f"{corner.number:3d}  {corner}: {line}\n")
    for name, rules in kinds.values() if args.graph else ():
        _graph(name, rules, args.lead)


def main(argv: list[str] | None = None) -> int:
    """Run the command; 2 on bad input."""
    args = _arguments(argv)
    try:
        if args.pattern is not None:
            _pattern(args, _parameters(args))
            return 0
        if args.side != "inside" or args.turn != RIGHT_ANGLE_DEG:
            _one_rule_set(args, _parameters(args))
            return 0
        rules = args.rules
        if args.rule is not None:
            rules = "paper" if args.rule in PAPER_RULES else "deadbeat"
        automaton = make_rule_set(rules, _parameters(args))
        if args.graph:
            sys.stdout.write(automaton.describe() + "\n")
        if args.lag is not None and args.wind is not None:
            mps, from_deg = args.wind
            wind = CornerWind(mps, from_deg, args.course, args.airspeed)
            plan, found = planned_in_wind(automaton.parameters, args.lag, args.lead, wind)
            sys.stdout.write(described(plan, found, wind))
            nearest = closest_approach(plan.path, plan.parameters)
            _print_plan(plan, nearest, math.radians(RIGHT_ANGLE_DEG), as_json=False)
        elif args.lag is not None:
            plan = _plan(automaton, args.lag, args.rule, args.lead)
            nearest = closest_approach(plan.path, plan.parameters)
            turn_rad = math.radians(RIGHT_ANGLE_DEG)
            _print_plan(plan, nearest, turn_rad, as_json=args.json)
    except (ParameterError, NoPathError, ValueError, OSError) as error:
        sys.stderr.write(f"corner: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
