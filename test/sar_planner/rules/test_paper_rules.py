"""The worked values of the paper's parameters, and the closed forms the paths must reproduce."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import Arc
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_planner.rules.paper_rules import (
    NoPathError,
    Rule,
    build,
    convergent_progression_m,
    convergent_slope,
    convergent_theta_rad,
    exact_straight_m,
    taylor_straight_m,
)

P = CornerParameters()
AUTOMATON = PaperAutomaton(P)


def straight_lengths(plan):
    return [part.length_m for part in plan.path.segments if not isinstance(part, Arc)]


def test_worked_values():
    assert P.fixed_lag_m == pytest.approx(43.5988, abs=1e-4)
    assert P.cut_lag_m == pytest.approx(622.9204, abs=1e-4)
    assert AUTOMATON.plan(900.0).next_lag_m == pytest.approx(197.0796, abs=1e-4)
    assert AUTOMATON.plan(400.0).next_lag_m == pytest.approx(378.2006, abs=1e-4)
    assert AUTOMATON.plan(-200.0).next_lag_m == pytest.approx(269.1625, abs=1e-4)


@pytest.mark.parametrize(("lag", "y", "theta_deg"), [(0.0, 235.922, 9.81), (-40.0, 242.041, 19.86)])
def test_worked_convergent_curves(lag, y, theta_deg):
    exact = exact_straight_m(lag, P.convergence * lag, P)
    assert exact == pytest.approx(y, abs=1e-3)
    assert math.degrees(convergent_theta_rad(exact, lag, P)) == pytest.approx(theta_deg, abs=0.005)


@given(st.floats(-1500.0, 3000.0))
def test_path_length_gives_the_closed_progression(lag):
    plan = AUTOMATON.plan(lag)
    assert plan.next_lag_m == pytest.approx(AUTOMATON.progression_m(plan.rule, lag), abs=1e-6)


@given(st.floats(-1500.0, 3000.0))
def test_path_starts_abeam_and_ends_on_the_new_slot_track(lag):
    path = AUTOMATON.plan(lag).path
    assert path.start.x_m == pytest.approx(-(P.stopping_m + lag))
    assert path.start.y_m == -P.spacing_m
    assert path.end.x_m == pytest.approx(-P.spacing_m, abs=1e-6)
    assert math.cos(path.end.heading_rad) == pytest.approx(0.0, abs=1e-9)
    assert math.sin(path.end.heading_rad) == pytest.approx(-1.0)


@given(st.floats(-30.0, 43.5), st.floats(0.0, 90.0))
def test_late_convergent_curve_still_reaches_its_target(lag, lead):
    plan = build(Rule.T3, lag, P, lead_m=lead)
    assert plan.next_lag_m == pytest.approx(P.convergence * lag, abs=1e-6)
    assert plan.turn_start_m == pytest.approx(lead, abs=1e-6)


def test_lead_in_shorter_than_the_rules_own_straight_changes_nothing():
    assert build(Rule.T2, 400.0, P, lead_m=100.0).path == build(Rule.T2, 400.0, P).path


def test_late_fixed_curve_keeps_its_progression():
    late = build(Rule.T2, 60.0, P, lead_m=90.0)
    assert late.next_lag_m == pytest.approx(build(Rule.T2, 60.0, P).next_lag_m, abs=1e-6)


def test_cut_corner_refuses_a_lead_in_beyond_its_straight():
    with pytest.raises(NoPathError, match=r"lead-in 600\.0 m"):
        build(Rule.T1, 640.0, P, lead_m=600.0)


def test_convergent_refuses_what_it_cannot_reach():
    with pytest.raises(NoPathError, match="the curve reaches"):
        exact_straight_m(0.0, 500.0, P)
    with pytest.raises(NoPathError, match="too early"):
        exact_straight_m(400.0, 0.0, P)


@given(st.floats(-79.0, 43.0), st.floats(160.0, 220.0))
def test_slope_is_the_derivative_of_the_progression(lag, y):
    h = 1e-4
    high = convergent_progression_m(y + h, lag, P)
    low = convergent_progression_m(y - h, lag, P)
    assert convergent_slope(y, lag, P) == pytest.approx((high - low) / (2 * h), rel=1e-5)


@pytest.mark.parametrize(("y_o", "worst"), [(200.0, 4.7), (150.0, 45.05)])
def test_error_of_the_papers_taylor_step(y_o, worst):
    lags = np.linspace(-79.0, 43.5, 400)  # at y_o = 150 the error grows without end towards -80
    errors = [
        convergent_progression_m(taylor_straight_m(lag, 0.5 * lag, y_o, P), lag, P) - 0.5 * lag
        for lag in lags
    ]
    assert max(map(abs, errors)) == pytest.approx(worst, rel=0.03)


def test_taylor_step_is_selected_by_its_parameter():
    taylor = CornerParameters(taylor_y_m=200.0)
    plan = PaperAutomaton(taylor).plan(0.0)
    assert straight_lengths(plan)[-1] == pytest.approx(taylor_straight_m(0.0, 0.0, 200.0, P))
    assert plan.next_lag_m != pytest.approx(0.0, abs=1e-3)
