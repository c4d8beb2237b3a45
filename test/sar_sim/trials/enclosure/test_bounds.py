"""What is proved of the paper's rules against corners that are computed one by one."""

import math
import random
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.prediction.separation import closest_approach
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_planner.rules.paper_rules import Rule
from sar_sim.trials.enclosure.bounds import AXES, RuleBoxes, enclose, lag_m, spans_about
from sar_sim.trials.enclosure.branch_and_bound import Box
from sar_sim.trials.enclosure.corner_pieces import FROM_M, RULES, TO_M

P = CornerParameters()
STEPS = 2**20
SHARES = st.integers(1, STEPS - 2).map(lambda i: i / STEPS)
BOXES = {}


def proved(rule, percent):
    if (rule, percent) not in BOXES:
        BOXES[rule, percent] = enclose(rule, spans_about(P, percent), tolerance_m=0.5)
    return BOXES[rule, percent]


def at_random(draw, percent):
    """Return parameters of the box, often of its edges, and a lag."""
    shares = [draw.choice((-1.0, 1.0, draw.uniform(-1.0, 1.0))) for _ in range(5)]
    factors = [1.0 + 0.01 * percent * share for share in shares]
    names = ("speed_mps", "turn_radius_m", "accel_mps2", "spacing_m", "convergence")
    changed = {name: getattr(P, name) * by for name, by in zip(names, factors, strict=True)}
    return replace(P, **changed), draw.uniform(FROM_M, TO_M)


@pytest.mark.parametrize("percent", [0.0, 1.0])
def test_every_corner_is_within_what_is_proved(percent):
    draw = random.Random(7)
    for _ in range(300):
        p, lag = at_random(draw, percent)
        plan = PaperAutomaton(p).plan(lag)
        found = proved(plan.rule, percent)
        low, high = found.next_lags_m
        assert low - 1e-6 <= plan.next_lag_m <= high + 1e-6
        assert found.lag_sizes_m[0] <= abs(plan.next_lag_m) <= found.lag_sizes_m[1]
        assert closest_approach(plan.path, p).distance_m >= found.separation.low - 1e-6


@pytest.mark.parametrize("rule", RULES)
@settings(max_examples=15)
@given(lag=SHARES, others=st.tuples(SHARES, SHARES, SHARES, SHARES))
def test_a_corner_is_enclosed_closely(rule, lag, others):
    """A box of 1 / 2^20 of the domain, at one set of parameters, against the flown path."""
    spans = spans_about(P, 1.0)
    low = (0.0, lag, *others)
    box = Box(0, low, (0.0, lag + 1.0 / STEPS, *others))
    found = enclose(rule, spans, tolerance_m=1e-3, within=box)
    s, r, d, c = (float(span.low + u * span.width) for span, u in zip(spans, others, strict=True))
    p = replace(
        P,
        accel_mps2=P.speed_mps**2 / (2.0 * s),
        turn_radius_m=r,
        spacing_m=d,
        convergence=c,
    )
    plan = PaperAutomaton(p).plan(lag_m(found, spans))
    assert plan.rule is rule
    distance = closest_approach(plan.path, p).distance_m
    assert found.separation.low - 1e-6 <= distance <= found.separation.high + 1e-2
    assert found.separation.high - found.separation.low <= 1e-3
    assert found.next_lags_m == pytest.approx((plan.next_lag_m,) * 2, abs=1e-2)


@pytest.mark.parametrize(
    ("rule", "lag", "least"), [(Rule.T2, 477.0, 23.6), (Rule.T4, -80.0, 17.25)]
)
def test_the_papers_rules_come_as_close_as_is_documented(rule, lag, least):
    found = enclose(rule, spans_about(P, 0.0), tolerance_m=0.01)
    assert found.separation.low <= least + 0.01
    assert found.separation.high >= least - 0.01
    assert found.separation.high - found.separation.low <= 0.01
    flown = PaperAutomaton(P).plan(lag)
    assert flown.rule is rule
    assert closest_approach(flown.path, P).distance_m <= found.separation.high + 0.01


@pytest.mark.parametrize("rule", RULES)
def test_a_larger_box_encloses_a_smaller_one(rule):
    small, large = proved(rule, 0.0), proved(rule, 1.0)
    assert large.separation.low <= small.separation.high
    assert large.next_lags_m[0] <= small.next_lags_m[0] + 0.5
    assert large.next_lags_m[1] >= small.next_lags_m[1] - 0.5


def test_a_wide_box_has_sound_bounds_when_few_boxes_are_looked_at():
    found = enclose(Rule.T4, spans_about(P, 1.0), tolerance_m=0.01, most_boxes=5)
    assert 0.0 <= found.separation.low <= proved(Rule.T4, 1.0).separation.low + 0.5
    assert found.separation.high - found.separation.low > 0.01


@pytest.mark.parametrize(
    ("changed", "percent", "what"),
    [
        ({"turn_radius_m": 260.0}, 0.0, "outside loop"),
        ({"accel_mps2": 1.5}, 0.0, "12"),
        ({}, 7.0, "12"),
        ({"convergence": 0.999}, 1.0, "convergence"),
        ({"taylor_y_m": 200.0}, 0.0, "taylor_y_m"),
        ({}, -1.0, "box"),
        ({}, math.nan, "box"),
    ],
)
def test_parameters_for_which_the_rules_do_not_hold_are_refused(changed, percent, what):
    with pytest.raises(ParameterError, match=what):
        spans_about(replace(P, **changed), percent)


def test_axes_without_width_are_not_divided():
    assert RuleBoxes(Rule.T3, spans_about(P, 0.0)).whole.high == (0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    assert RuleBoxes(Rule.T3, spans_about(P, 1.0)).whole.high == (0.0,) + (1.0,) * (AXES - 1)
