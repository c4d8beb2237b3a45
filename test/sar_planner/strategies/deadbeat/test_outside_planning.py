"""About the outside of a corner: slowly where it may, fast where it must, far enough out."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.rules.outside_rules import OutsideRules
from sar_planner.rules.paper_rules import Rule
from sar_planner.strategies.active_corner import measured
from sar_planner.strategies.deadbeat.outside_planning import (
    ASTRAY_SHARES,
    MADE_UP_SHARE,
    OutsideCorner,
    outside_plan,
    shares_of,
)

NOW_S = 104.0
AGAINST, WITH, CALM = (0.0, 10.0), (0.0, -10.0), (0.0, 0.0)
"""What blows where on the new leg, which leads to the right of the old one, southwards [m/s]."""


@pytest.fixture
def outside_tick(tick_at, corner):
    """Return what makes a tick with a UAV outside of the corner, some way behind its slot."""

    def make(lag_m, wind_mps, **mission):
        known = {"first_leg_m": 2000.0, "slot_side": "outside", **mission}
        tick = tick_at(NOW_S, corner=corner, x=80.0 - lag_m, y=250.0, **known)
        return replace(tick, air=AirEnvelope(10.0, 30.0, wind_mps))

    return make


def planned(tick, corner, lead_s=5.0):
    frame = CornerFrame(corner.stop, 1)
    parameters, lag_m = measured(corner, frame, tick.situation.uav, tick.corner)
    return outside_plan(
        OutsideRules(parameters, 1.5707963), frame, corner, lag_m, 20.0 * lead_s, tick
    )


def test_in_calm_air_it_passes_slowly_and_cuts_nothing(outside_tick, corner):
    plan, share = planned(outside_tick(0.0, CALM), corner)
    assert plan.rule is Rule.O1
    assert share == pytest.approx(0.7)
    assert plan.path.segments == OutsideRules(plan.parameters, 1.5707963).path(0.0).segments


def test_before_a_leg_against_the_wind_it_is_fast(outside_tick, corner):
    """There nothing is made up: every second in the corner is 20 m of lag on the leg."""
    plan, share = planned(outside_tick(0.0, AGAINST), corner)
    assert plan.rule is Rule.O1
    assert share > 1.0
    slowly, slow_share = planned(outside_tick(0.0, WITH), corner)
    assert slow_share < 1.0
    assert plan.next_lag_m < slowly.next_lag_m


@pytest.mark.parametrize("wind_mps", [AGAINST, WITH, CALM, (10.0, 0.0), (-10.0, 0.0)])
@pytest.mark.parametrize("lag_m", [-60.0, 0.0, 60.0, 120.0, 180.0, 240.0, 300.0])
def test_it_keeps_apart_from_one_that_goes_astray(outside_tick, corner, wind_mps, lag_m):
    """Beside the corner and before the nose: farther out where it is not there at another time."""
    tick = outside_tick(lag_m, wind_mps)
    plan, share = planned(tick, corner)
    rules, frame = OutsideRules(plan.parameters, 1.5707963), CornerFrame(corner.stop, 1)
    looked = OutsideCorner(rules, frame, corner, plan.lag_m, 100.0, (share,), 0.0)
    flown = looked._flown(plan.rule, plan.path, share, tick)
    assert flown is not None
    assert flown.astray_m >= ASTRAY_SHARES[0] * 200.0
    assert plan.turn_start_m >= 100.0 - 1e-6


def test_one_that_is_late_passes_farther_out_beside_one_that_stands(outside_tick, corner):
    plan, _ = planned(outside_tick(400.0, CALM), corner)
    across = plan.path.sample(1.0)[:, 1].max()
    assert 265.0 < across < 295.0


def test_too_far_ahead_to_turn_on_its_track_it_turns_beyond(outside_tick, corner):
    plan, _ = planned(outside_tick(-150.0, CALM), corner)
    assert plan.turn_start_m >= 100.0
    assert plan.path.sample(1.0)[:, 0].max() > 260.0
    assert plan.path.end.x_m == pytest.approx(250.0)


def test_a_lag_that_a_leg_cannot_make_up_is_cut(outside_tick, corner):
    """From far behind, before a leg on which nothing is made up."""
    plan, _ = planned(outside_tick(900.0, AGAINST), corner)
    assert plan.rule is Rule.O2
    assert plan.next_lag_m < 900.0 + 250.0 * MADE_UP_SHARE


@given(st.floats(0.3, 2.0), st.floats(0.3, 1.5), st.floats(1.0, 1.4))
def test_speeds_are_within_limits_and_the_slowest_comes_first(slow, as_slow, fastest):
    shares = shares_of(slow, as_slow, fastest)
    assert shares[0] == min(slow, fastest)
    assert max(shares) <= fastest
    assert min(shares) >= min(slow, as_slow, fastest)
    assert fastest in shares
