"""The deadbeat rules: at the paper's values for every lag, and over the ranges of parameters."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.paths.slot_intercept import STRAIGHT_Q, STRAIGHT_Y, PathBatch
from sar_planner.prediction.separation import closest_approach
from sar_planner.rejoin.recapture import row_of
from sar_planner.rules.deadbeat_automaton import DeadbeatAutomaton, check_deadbeat
from sar_planner.rules.deadbeat_rules import DeadbeatRules, least_lag_m
from sar_planner.rules.paper_rules import NoPathError, Rule
from sar_sim.report.coverage import ideal_tracks, swath

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
@given(st.floats(-400.0, 1400.0), st.floats(0.0, 140.0), st.floats(0.6, 1.0))
def test_every_plan_is_what_it_says(lag, lead, path_efficiency):
    """It turns after the lead-in, ends on the new slot track, and leaves the lag it says."""
    rules = DeadbeatRules(P, path_efficiency=path_efficiency)
    try:
        plan = rules.plan(lag, lead_m=lead, separation_m=200.0)
    except NoPathError:
        return
    path = plan.path
    assert (path.start.x_m, path.start.y_m) == pytest.approx((-80.0 - lag, -250.0))
    assert plan.turn_start_m >= lead - 1e-6
    assert path.end.x_m == pytest.approx(-250.0, abs=1e-6)
    assert math.cos(path.end.heading_rad + math.pi / 2) == pytest.approx(1.0)
    slow = path.length_m - plan.turn_start_m
    flown_s = (plan.turn_start_m + slow / path_efficiency) / 20.0
    slot_m = 20.0 * flown_s - 3.0 * P.stopping_m
    assert plan.next_lag_m == pytest.approx(slot_m + path.end.y_m, abs=1e-6)
    if path_efficiency == 1.0:
        assert closest_approach(path, P).distance_m >= 200.0


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


def test_a_weave_sees_what_a_late_curve_leaves_out():
    """A curve that joins the new slot track far down it leaves the swath before uncovered."""
    rules = DeadbeatRules(CornerParameters())
    problem = rules.problem(0.0)
    curves = rules.exact(problem, 110.0, (STRAIGHT_Y, STRAIGHT_Q))
    late = curves.take(np.flatnonzero(curves.ends[:, 0] > 1000.0))
    assert len(late) > 0
    weave = rules.plan(0.0, lead_m=110.0, separation_m=200.0)
    assert weave.rule is Rule.D4
    headings = np.radians([[160.0, 23.0, 46.0]])
    woven = rules.weaves(problem, 110.0, headings)
    assert rules.uncovered_m2(woven).min() < 0.3 * rules.uncovered_m2(late).min()


@pytest.mark.parametrize(
    ("lead", "separation", "most_m2"), [(110, 200, 9e3), (110, 230, 27e3), (90, 230, 9e3)]
)
def test_what_a_corner_leaves_unseen(lead, separation, most_m2):
    """Against an area by shapely, of both aircraft and the ideal swaths."""
    plan = DeadbeatRules(P).plan(0.0, lead_m=float(lead), separation_m=float(separation))
    reach = 2500.0
    helicopter = np.array([(-reach, 0.0), (0.0, 0.0), (0.0, -reach)])
    _, strip = ideal_tracks(helicopter, spacing_m=250.0, turn_side=1)
    path = plan.path.sample(5.0)
    flown = np.vstack(((-reach, -250.0), path, (-250.0, -reach)))
    seen = swath(flown, 125.0).union(swath(helicopter, 125.0))
    uncovered = swath(strip, 125.0).difference(seen).area
    assert 0.0 < uncovered < most_m2
    rules = DeadbeatRules(P)
    row = row_of(rules._frame.path_from_map(plan.path))
    batch = PathBatch(rules.problem(0.0).start, P.turn_radius_m, row[None, :])
    assert rules.uncovered_m2(batch)[0] == pytest.approx(uncovered, rel=0.15, abs=1500.0)


def test_a_uav_that_makes_little_good_needs_a_lag_to_take_out():
    sloppy = DeadbeatRules(P, path_efficiency=0.7)
    least = least_lag_m(sloppy, lead_m=100.0, separation_m=200.0)
    assert 100.0 < least < 300.0
    assert abs(sloppy.plan(least, lead_m=100.0, separation_m=200.0).next_lag_m) <= 0.5
    assert sloppy.plan(0.0, lead_m=100.0, separation_m=200.0).next_lag_m > 500.0
    assert least_lag_m(DeadbeatRules(P), lead_m=100.0, separation_m=200.0) == 0.0
