"""The deadbeat rules: at the paper's values for every lag, and over the ranges of parameters."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.prediction.separation import closest_approach, corner_forecast, least_apart_m
from sar_planner.rules.deadbeat_automaton import DeadbeatAutomaton
from sar_planner.rules.deadbeat_rules import DeadbeatRules
from sar_planner.rules.paper_rules import NoPathError

P = CornerParameters()
AUTOMATON = DeadbeatAutomaton(P)


@pytest.fixture(scope="module")
def every_metre():
    """L(k+1) and the closest approach for every L from -800 to 1400 m."""
    lags = np.arange(-800.0, 1400.5, 1.0)
    plans = [AUTOMATON.plan(lag) for lag in lags]
    nexts = np.array([plan.next_lag_m for plan in plans])
    apart = np.array([closest_approach(plan.path, P).distance_m for plan in plans])
    return lags, nexts, apart


def test_closest_approach_is_kept_for_every_lag(every_metre):
    _, _, apart = every_metre
    assert apart.min() >= 200.0


@pytest.mark.parametrize(
    ("low", "high", "bound"), [(-150, 470, 0.5), (470, 625, 150.0), (-800, -150, 280.0)]
)
def test_lag_left_after_one_corner(every_metre, low, high, bound):
    lags, nexts, _ = every_metre
    assert np.abs(nexts[(lags >= low) & (lags <= high)]).max() <= bound


def test_corners_needed(every_metre):
    lags, nexts, _ = every_metre
    second = np.array([AUTOMATON.plan(lag).next_lag_m for lag in nexts])
    third = np.array([AUTOMATON.plan(lag).next_lag_m for lag in second])
    assert np.abs(second[lags <= 1150.0]).max() <= 0.5
    assert np.abs(third).max() <= 0.5


@settings(max_examples=80, deadline=None)
@given(
    st.floats(-400.0, 1400.0),
    st.floats(0.0, 140.0),
    st.floats(0.6, 1.0),
    st.just(90.0) | st.floats(60.0, 135.0),
)
def test_every_plan_is_what_it_says(lag, lead, path_efficiency, turn_deg):
    """It turns after the lead-in, ends on the new slot track, and leaves the lag it says."""
    turn = math.radians(turn_deg)
    rules = DeadbeatRules(P, path_efficiency=path_efficiency, turn_rad=turn)
    try:
        plan = rules.plan(lag, lead_m=lead, separation_m=200.0)
    except NoPathError:
        return
    path = plan.path
    assert (path.start.x_m, path.start.y_m) == pytest.approx((-80.0 - lag, -250.0))
    assert plan.turn_start_m >= lead - 1e-6
    new_leg = Pose(0.0, 0.0, -turn)
    assert new_leg.across(path.end.x_m, path.end.y_m) == pytest.approx(-250.0, abs=1e-6)
    assert math.cos(path.end.heading_rad + turn) == pytest.approx(1.0)
    slow = path.length_m - plan.turn_start_m
    flown_s = (plan.turn_start_m + slow / path_efficiency) / 20.0
    slot_m = 20.0 * flown_s - 3.0 * P.stopping_m
    ended_m = new_leg.along(path.end.x_m, path.end.y_m)
    assert plan.next_lag_m == pytest.approx(slot_m - ended_m, abs=1e-6)
    if path_efficiency == 1.0:
        assert rules.closest(path).distance_m >= 200.0


@pytest.mark.parametrize(("turn_deg", "low", "high"), [(60, -200, 500), (120, 25, 700)])
def test_lags_that_one_corner_of_another_angle_takes_out(turn_deg, low, high):
    """With what detection and upload cost, 4 s."""
    rules = DeadbeatRules(P, turn_rad=math.radians(turn_deg))
    plans = [rules.plan(lag, lead_m=80.0, separation_m=200.0) for lag in range(low, high, 25)]
    assert max(abs(plan.next_lag_m) for plan in plans) <= 0.5
    assert min(rules.closest(plan.path).distance_m for plan in plans) >= 200.0


@pytest.mark.parametrize("turn_deg", [50.0, 140.0])
def test_a_turn_that_the_rules_are_not_for_is_refused(turn_deg):
    with pytest.raises(NoPathError, match=f"turn of {turn_deg:.0f} degrees: expected 60 to 135"):
        DeadbeatRules(P, turn_rad=math.radians(turn_deg))


@settings(max_examples=25, deadline=None)
@given(st.floats(15, 30), st.floats(60, 150), st.floats(1, 4), st.floats(150, 400))
def test_guarantees_or_a_refusal_that_names_its_bound(speed, radius, accel, spacing):
    parameters = CornerParameters(
        speed_mps=speed, turn_radius_m=radius, accel_mps2=accel, spacing_m=spacing
    )
    try:
        automaton = DeadbeatAutomaton(parameters)
    except ParameterError as error:
        text = str(error)
        assert any(
            text.startswith(name)
            for name in ("turn_radius_m", "min_separation_m", "accel_mps2", "spacing_m")
        )
        assert "expected at " in text
        return
    for share in np.linspace(-3.2, 5.6, 12):
        lag, allowed = share * spacing, 2 if share <= 4.6 else 3
        for _ in range(allowed):
            plan = automaton.plan(lag)
            apart = closest_approach(plan.path, parameters).distance_m
            assert apart >= parameters.separation_m - 1e-6
            lag = plan.next_lag_m
        assert abs(lag) <= 0.5 or share not in np.linspace(-3.2, 5.6, 221)


@pytest.mark.parametrize("lag", [150.0, 245.0, 300.0])
def test_a_path_stays_apart_from_where_a_slow_uav_would_be_too(lag):
    """At L = 245 m one that makes 65 % good comes within some 130 m where that is not asked for."""
    plans = [
        DeadbeatRules(P, least_efficiency=least).plan(lag, lead_m=80.0, separation_m=200.0)
        for least in (None, 0.65)
    ]
    apart = [
        least_apart_m(plan.path, [corner_forecast(P)], start_s=0.0, speed_mps=0.65 * 20.0)
        for plan in plans
    ]
    assert apart[1] > apart[0]
    assert closest_approach(plans[1].path, P).distance_m >= 200.0 - 1e-6


def test_what_a_plan_leaves_out_is_told():
    rules = DeadbeatRules(P)
    plan = rules.plan(0.0, lead_m=100.0, separation_m=200.0)
    assert 0.0 <= rules.uncovered_m2(plan) < 0.1 * 250.0**2
