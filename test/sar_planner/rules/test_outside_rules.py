"""The outside rules: closed forms at the paper's values, and what every plan promises."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.separation import closest_approach
from sar_planner.rules.outside_rules import OutsideRules
from sar_planner.rules.paper_rules import NoPathError, Rule
from sar_sim.report.coverage import IdealSlot, ideal_tracks, swath

P = CornerParameters()
RIGHT = 0.5 * math.pi
LAGS = st.floats(-200.0, 600.0)
TURNS = st.floats(math.radians(50.0), math.radians(130.0))


@pytest.mark.parametrize("lag", [-150.0, 0.0, 150.0, 400.0])
def test_an_outer_corner_costs_what_the_closed_form_says(lag):
    """L(k+1) = L + 2 d - (2 - pi / 2) R - 2 s."""
    rules = OutsideRules(P, RIGHT)
    expected = lag + 500.0 - (2.0 - RIGHT) * 100.0 - 160.0
    assert rules.next_lag_m(rules.path(lag)) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("lag", "cut"), [(0.0, 189.0), (150.0, 339.0)])
def test_a_cut_corner_costs_what_the_closed_form_says(lag, cut):
    """L(k+1) = L + 2 d - 2 s - (2 - sqrt 2) q - (4 tan(pi / 8) - pi / 2) R."""
    rules = OutsideRules(P, RIGHT)
    bend = 4.0 * math.tan(math.pi / 8.0) - RIGHT
    expected = lag + 500.0 - 160.0 - (2.0 - math.sqrt(2.0)) * cut - bend * 100.0
    assert rules.next_lag_m(rules.path(lag, cut)) == pytest.approx(expected, abs=1e-6)


def test_a_u_turn_costs_what_the_closed_form_says():
    """Over to the outside beyond the cross leg, about its end: L - 4 s - (4 - pi) R + 2 p."""
    beyond = 250.0
    over = OutsideRules(P, RIGHT, from_m=-250.0, to_m=beyond)
    about = OutsideRules(P, RIGHT, from_m=beyond, to_m=250.0)
    lag = over.next_lag_m(over.path(0.0))
    after = about.next_lag_m(about.path(lag))
    expected = -4.0 * P.stopping_m - (4.0 - math.pi) * 100.0 + 2.0 * beyond
    assert after == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("lag", "apart"), [(-150.0, 250.0), (0.0, 250.0), (150.0, 256.0)])
def test_about_the_outside_the_aircraft_stay_apart(lag, apart):
    path = OutsideRules(P, RIGHT).path(lag)
    assert closest_approach(path, P).distance_m >= apart - 0.5


def test_the_outer_corner_leaves_nothing_unseen_but_the_rounding():
    path = OutsideRules(P, RIGHT).path(0.0).sample(5.0)
    helicopter = np.array([(-2000.0, 0.0), (0.0, 0.0), (0.0, -2000.0)])
    _, strip = ideal_tracks(helicopter, [IdealSlot([-250.0] * 2)])
    flown = np.vstack(((-2000.0, 250.0), path, (250.0, -2000.0)))
    unseen = swath(strip, 125.0).difference(swath(flown, 125.0)).area
    assert unseen < (1.0 - math.pi / 4.0) * 225.0**2  # outside of an arc of R + d / 2


@pytest.mark.parametrize("cut", [120.0, 200.0, 300.0])
def test_a_cut_corner_leaves_no_more_unseen_than_its_triangle(cut):
    """The outlines of the swaths are cut by q + (2 - sqrt 2) d / 2."""
    rules = OutsideRules(P, RIGHT)
    seen = [
        swath(np.vstack(((-2000.0, 250.0), path.sample(5.0), (250.0, -2000.0))), 125.0)
        for path in (rules.path(100.0), rules.path(100.0, cut))
    ]
    lost = seen[0].difference(seen[1])
    triangle = 0.5 * (cut + (2.0 - math.sqrt(2.0)) * 125.0) ** 2
    assert 0.5 * triangle < lost.area <= triangle


@settings(max_examples=150, deadline=None)
@given(
    LAGS,
    TURNS,
    st.floats(0.7, 1.3),
    st.sampled_from(((250.0, 250.0), (-250.0, 350.0), (350.0, 250.0), (500.0, 500.0))),
    st.floats(0.0, 120.0),
)
def test_every_plan_is_what_it_says(lag, turn, share, places, lead):
    """On the old slot track until it turns, on the new one in the end, apart, and in time."""
    from_m, to_m = places
    try:
        rules = OutsideRules(P, turn, speed_mps=share * 20.0, from_m=from_m, to_m=to_m)
        plan = rules.plan(lag, lead_m=lead, separation_m=200.0)
    except NoPathError:
        return
    path, out = plan.path, -turn
    assert (path.start.x_m, path.start.y_m) == pytest.approx((-P.stopping_m - lag, from_m))
    assert plan.turn_start_m >= lead
    left = (-math.sin(out), math.cos(out))
    assert path.end.x_m * left[0] + path.end.y_m * left[1] == pytest.approx(to_m, abs=1e-6)
    assert math.cos(path.end.heading_rad - out) == pytest.approx(1.0)
    assert rules.closest_m(path) >= 200.0
    flown_s = path.length_m / (share * 20.0)
    along = path.end.x_m * math.cos(out) + path.end.y_m * math.sin(out)
    assert plan.next_lag_m == pytest.approx(20.0 * flown_s - 3.0 * P.stopping_m - along, abs=1e-6)
    assert plan.rule is (Rule.O3 if from_m < 0.0 else plan.rule)


@given(st.floats(0.0, 400.0), st.floats(150.0, 600.0))
def test_it_is_cut_no_more_than_the_leg_needs(lag, most_left):
    rules = OutsideRules(P, RIGHT)
    try:
        plan = rules.plan(lag, separation_m=200.0, most_left_m=most_left)
    except NoPathError:
        return
    whole = rules.next_lag_m(rules.path(lag))
    assert (plan.rule is Rule.O1) == (whole <= most_left or plan.next_lag_m >= whole)
    assert plan.next_lag_m <= whole + 1e-9


@given(st.floats(-150.0, 400.0), TURNS, st.floats(0.0, 100.0), st.sampled_from((0.0, 20.0, 40.0)))
def test_farther_out_and_wider_it_ends_on_its_track_all_the_same(lag, turn, over, out):
    """It passes the corner so much farther out, the nose so much farther before, and comes back."""
    rules = OutsideRules(P, turn)
    path = rules.wide_path(lag, over, out_m=out, lead_m=20.0)
    if path is None:
        assert rules.turn_start_m(lag) + over < (0.0 if out == 0.0 else 400.0)
        return
    assert path.start.heading_rad == 0.0
    left = math.sin(turn), math.cos(turn)
    assert path.end.x_m * left[0] + path.end.y_m * left[1] == pytest.approx(250.0, abs=1e-6)
    assert math.cos(path.end.heading_rad + turn) == pytest.approx(1.0)
    points = path.sample(0.5)
    across = points @ np.array(left)
    assert across.max() == pytest.approx(250.0 + over * math.sin(turn), abs=0.5)
    if out > 0.0:
        assert points[:, 1].max() == pytest.approx(250.0 + out, abs=0.5)
    elif over == 0.0:
        assert path.length_m == pytest.approx(rules.path(lag).length_m)


@given(st.floats(0.0, 300.0), TURNS, st.floats(1.0, 100.0))
def test_the_most_that_is_cut_is_begun_at_the_lead(lag, turn, lead):
    rules = OutsideRules(P, turn)
    most = rules.most_cut_m(lag, lead)
    path = rules.path(lag, most) if most > 0.0 else None
    if path is not None:
        assert path.segments[0].length_m == pytest.approx(lead, abs=1e-6)


def test_no_turn_and_a_turn_back_have_no_outside():
    for turn in (0.0, math.radians(150.0)):
        with pytest.raises(NoPathError, match="turn of"):
            OutsideRules(P, turn)


def test_too_late_for_the_corner_is_told():
    with pytest.raises(NoPathError, match="no path outside"):
        OutsideRules(P, RIGHT).plan(-300.0, lead_m=200.0, separation_m=200.0)


def test_a_chord_is_apart_from_one_that_stands_on_or_stops_farther_on():
    """However much the leg asks for it, it is cut no more than that."""
    rules = OutsideRules(P, RIGHT)
    plan = rules.plan(0.0, separation_m=200.0, most_left_m=-math.inf)
    points = plan.path.sample(1.0)
    assert plan.rule is Rule.O2
    assert np.hypot(*points.T).min() >= 200.0
    farther = points - np.array((P.stopping_m, 0.0))
    assert np.hypot(*farther.T).min() >= 0.7 * 200.0 - 0.5
