"""The enclosed paths and helicopter against those that are flown."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flint import arb
from hypothesis import assume, given
from hypothesis import strategies as st

from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.prediction.separation import corner_forecast
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_planner.rules.paper_rules import Rule, build
from sar_sim.trials.enclosure.corner_pieces import (
    FROM_M,
    RULES,
    TO_M,
    Terms,
    convergent_angle,
    convergent_straight_m,
    domain_m,
    gap_m,
    helicopter_at,
    lag_at,
    next_lag_m,
    path_of,
)
from sar_sim.trials.enclosure.jets import Jet

P = CornerParameters()
INNER = st.floats(1e-3, 1.0 - 1e-3)


@st.composite
def corners(draw):
    """Parameters for which the rules hold, not only near the paper's."""
    p = replace(
        P,
        speed_mps=draw(st.floats(15.0, 25.0)),
        turn_radius_m=draw(st.floats(80.0, 120.0)),
        spacing_m=draw(st.floats(200.0, 350.0)),
        convergence=draw(st.floats(0.2, 0.8)),
        accel_mps2=draw(st.floats(2.0, 4.0)),
    )
    try:
        PaperAutomaton(p)
    except ParameterError:
        assume(condition=False)
    return p


def terms(p):
    return Terms(*(Jet(v) for v in (p.stopping_m, p.turn_radius_m, p.spacing_m, p.convergence)))


def plain(jet):
    return float(jet.value.mid())


@pytest.mark.parametrize("rule", RULES)
@given(p=corners(), share=INNER)
def test_paths_are_those_of_the_rules(rule, p, share):
    own = terms(p)
    lag = plain(lag_at(rule, Jet(share), own))
    path, plan = path_of(rule, Jet(share), own), build(rule, lag, p)
    assert PaperAutomaton(p).rule_for(lag) is rule
    assert plain(path.length_m) == pytest.approx(plan.path.length_m, abs=1e-6)
    assert plain(path.end_y_m) == pytest.approx(plan.path.end.y_m, abs=1e-6)
    assert plain(next_lag_m(path, own)) == pytest.approx(plan.next_lag_m, abs=1e-6)


@pytest.mark.parametrize("rule", RULES)
@given(p=corners(), share=INNER, flown=st.floats(0.0, 1.0))
def test_gaps_are_those_of_the_flown_path_and_the_forecast(rule, p, share, flown):
    own = terms(p)
    path = path_of(rule, Jet(share), own)
    plan = build(rule, plain(lag_at(rule, Jet(share), own)), p)
    for part, piece in enumerate(path.pieces):
        way = plain(path.begun_m(part)) + flown * plain(piece.length_m)
        there = corner_forecast(p).positions([way / p.speed_mps])[0]
        x, y = gap_m(path, part, Jet(flown), own)
        wanted = plan.path.points([way])[0] - there
        # The flown path's own root is not solved to the last digit near the end of T3's angle.
        assert (plain(x), plain(y)) == pytest.approx(tuple(wanted), abs=1e-3)


@given(p=corners())
def test_the_helicopter_flies_as_forecast(p):
    for way in np.linspace(0.0, 6.0 * p.stopping_m, 25):
        x, y = helicopter_at(Jet(way), Jet(p.stopping_m))
        wanted = corner_forecast(p).positions([way / p.speed_mps])[0]
        assert (plain(x), plain(y)) == pytest.approx(tuple(wanted), abs=1e-7)


@given(
    middle=st.floats(0.0, 6.0),
    radius=st.floats(0.01, 0.6),
    first=st.floats(-1.0, 1.0),
    second=st.floats(-1.0, 1.0),
)
def test_a_box_of_ways_encloses_the_helicopter(middle, radius, first, second):
    """Also where it begins to turn, to speed up or to cruise; ways in stopping distances."""
    s, slack = P.stopping_m, 1e-9
    found = helicopter_at(Jet(arb(middle * s, radius * s), {0: arb(1)}), Jet(s))
    ways = [(middle + radius * share) * s for share in (first, second)]
    places = corner_forecast(P).positions([way / P.speed_mps for way in ways])
    for axis, jet in enumerate(found):
        low, high = float(jet.value.lower()), float(jet.value.upper())
        assert low - slack <= min(places[:, axis])
        assert max(places[:, axis]) <= high + slack
        if 0 in jet.slopes and abs(ways[1] - ways[0]) > 1e-3:
            slope = (places[1, axis] - places[0, axis]) / (ways[1] - ways[0])
            assert float(jet.slopes[0].lower()) - 1e-6 <= slope
            assert slope <= float(jet.slopes[0].upper()) + 1e-6


def test_domains_meet_at_the_automatons_bounds():
    bounds = {rule: tuple(map(plain, domain_m(rule, terms(P)))) for rule in RULES}
    wanted = PaperAutomaton(P).domains
    assert bounds[Rule.T1] == pytest.approx((wanted[Rule.T1].low_m, TO_M))
    assert bounds[Rule.T2] == pytest.approx((wanted[Rule.T2].low_m, wanted[Rule.T2].high_m))
    assert bounds[Rule.T3] == pytest.approx((wanted[Rule.T3].low_m, wanted[Rule.T3].high_m))
    assert bounds[Rule.T4] == pytest.approx((FROM_M, wanted[Rule.T4].high_m))


@pytest.mark.parametrize(("lag", "y", "theta_deg"), [(0.0, 235.922, 9.81), (-40.0, 242.041, 19.86)])
def test_the_convergent_curve_has_the_worked_values(lag, y, theta_deg):
    theta = convergent_angle(Jet(lag), terms(P))
    assert math.degrees(plain(theta)) == pytest.approx(theta_deg, abs=5e-3)
    assert plain(convergent_straight_m(Jet(lag), theta, terms(P))) == pytest.approx(y, abs=5e-4)
