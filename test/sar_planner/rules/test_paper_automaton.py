import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.rules.paper_automaton import Interval, PaperAutomaton
from sar_planner.rules.paper_rules import Rule

AUTOMATON = PaperAutomaton(CornerParameters())
parameter_sets = st.builds(
    CornerParameters,
    speed_mps=st.floats(15.0, 30.0),
    turn_radius_m=st.floats(60.0, 150.0),
    accel_mps2=st.floats(1.0, 4.0),
    spacing_m=st.floats(150.0, 400.0),
    convergence=st.floats(0.1, 0.9),
)


def admissible(parameters):
    try:
        return PaperAutomaton(parameters)
    except ParameterError:
        assume(False)


@given(parameter_sets, st.floats(-2000.0, 4000.0))
def test_exactly_one_rule_is_enabled(parameters, lag):
    automaton = admissible(parameters)
    enabled = [rule for rule, domain in automaton.domains.items() if lag in domain]
    assert enabled == [automaton.rule_for(lag)]


@given(parameter_sets)
def test_domain_ends_belong_to_exactly_one_rule(parameters):
    automaton = admissible(parameters)
    p = automaton.parameters
    for lag in (-p.stopping_m, p.fixed_lag_m, p.cut_lag_m):
        assert sum(lag in domain for domain in automaton.domains.values()) == 1


@given(parameter_sets, st.floats(-1500.0, 3000.0))
def test_every_admitted_parameter_set_has_a_path_with_the_closed_progression(parameters, lag):
    automaton = admissible(parameters)
    plan = automaton.plan(lag)
    assert plan.rule is automaton.rule_for(lag)
    assert plan.next_lag_m == pytest.approx(automaton.progression_m(plan.rule, lag), abs=1e-5)


@given(st.floats(-2000.0, 4000.0))
def test_each_state_and_lag_takes_exactly_one_computed_transition(lag):
    source = AUTOMATON.rule_for(lag)
    target = AUTOMATON.rule_for(AUTOMATON.progression_m(source, lag))
    taken = [t for t in AUTOMATON.transitions() if t.source is source and lag in t.lags]
    near_an_end = any(
        abs(lag - end) < 1e-6
        for t in AUTOMATON.transitions()
        for end in (t.lags.low_m, t.lags.high_m)
    )
    assert near_an_end or [t.target for t in taken] == [target]


def test_transitions_of_figure_8():
    pairs = {(t.source, t.target) for t in AUTOMATON.transitions()}
    assert pairs == {
        (Rule.T1, Rule.T1),
        (Rule.T1, Rule.T2),
        (Rule.T1, Rule.T3),
        (Rule.T1, Rule.T4),  # only L at the very edge of T1's domain
        (Rule.T2, Rule.T2),
        (Rule.T2, Rule.T3),
        (Rule.T3, Rule.T3),
        (Rule.T4, Rule.T1),
        (Rule.T4, Rule.T2),
    }


@given(st.floats(-800.0, 3000.0))
def test_converges_within_the_bound_of_14(first):
    n_1, n_2 = AUTOMATON.step_bounds(
        max(first, AUTOMATON.progression_m(Rule.T4, min(first, -80.0)))
    )
    lag, steps = first, 0
    while AUTOMATON.rule_for(lag) is not Rule.T3:
        lag = AUTOMATON.progression_m(AUTOMATON.rule_for(lag), lag)
        steps += 1
        assert steps < 3 + n_1 + n_2
    assert abs(AUTOMATON.progression_m(Rule.T3, lag)) <= abs(lag) * 0.5 + 1e-12


def test_describe_prints_what_is_computed():
    text = AUTOMATON.describe()
    for transition in AUTOMATON.transitions():
        assert f"{transition.source} -> {transition.target}  for L in {transition.lags}" in text


def test_no_rule_for_nan():
    with pytest.raises(ValueError, match="expected a finite number"):
        AUTOMATON.rule_for(math.nan)


def test_a_uav_too_late_for_its_rule_gets_the_next_one():
    plan = AUTOMATON.plan(0.0, lead_m=300.0)
    assert plan.rule is Rule.T4
    assert plan.turn_start_m == pytest.approx(300.0)


def test_interval_meet():
    a = Interval(0.0, 1.0, low_closed=True, high_closed=False)
    b = Interval(1.0, 2.0, low_closed=True, high_closed=True)
    assert a.meet(b) is None
    assert str(a.meet(a)) == "[0.0, 1.0)"
    c = Interval(0.5, 3.0, low_closed=False, high_closed=True)
    assert str(c.meet(b)) == "[1.0, 2.0]"
