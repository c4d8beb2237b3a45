"""Which deadbeat rule is taken for a lag, what comes of it, and what is refused."""

import itertools
import math

import numpy as np
import pytest

from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.rules.deadbeat_automaton import DeadbeatAutomaton, check_deadbeat
from sar_planner.rules.paper_rules import NoPathError, Rule

AUTOMATON = DeadbeatAutomaton(CornerParameters())


def test_refusal_names_parameter_value_and_bound():
    with pytest.raises(ParameterError, match=r"turn_radius_m = 300: expected at most \d+"):
        check_deadbeat(CornerParameters(turn_radius_m=300.0))
    with pytest.raises(ParameterError, match=r"min_separation_m = 250.0: expected less than"):
        check_deadbeat(CornerParameters(min_separation_m=250.0))


def test_domains_partition_the_line_and_transitions_follow():
    edges = [domain for _, domain in AUTOMATON.domains]
    assert edges[0].low_m == -math.inf
    assert edges[-1].high_m == math.inf
    for one, other in itertools.pairwise(edges):
        assert one.high_m == other.low_m
        assert (one.high_m in one) != (one.high_m in other)
    for rule, domain in AUTOMATON.domains:
        middle = np.clip((max(domain.low_m, -799.0) + min(domain.high_m, 1399.0)) / 2, -799, 1399)
        assert AUTOMATON.rule_for(float(middle)) is rule
    for transition in AUTOMATON.transitions():
        middle = 0.5 * (transition.lags.low_m + transition.lags.high_m)
        plan = AUTOMATON.plan(middle)
        assert plan.rule is transition.source
        assert AUTOMATON.rule_for(plan.next_lag_m) is transition.target


def test_graph_is_printed():
    text = AUTOMATON.describe()
    for word in (
        "D1 cut corner",
        "D2 adjustable curve",
        "D4 weave",
        "D1 -> D4",
        "one corner leaves",
    ):
        assert word in text


@pytest.mark.parametrize(
    ("rule", "lag"), [(Rule.D1, 300.0), (Rule.D2, 0.0), (Rule.D3, -200.0), (Rule.D4, 0.0)]
)
def test_a_rule_can_be_forced(rule, lag):
    assert AUTOMATON.plan(lag, only=rule).rule is rule


def test_no_path_and_no_number():
    with pytest.raises(NoPathError, match="no path keeps 2000 m"):
        AUTOMATON.plan(0.0, separation_m=2000.0)
    with pytest.raises(ValueError, match="expected a finite number"):
        AUTOMATON.plan(math.nan)
