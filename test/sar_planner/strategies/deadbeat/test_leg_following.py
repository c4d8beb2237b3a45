"""On a leg: speed for a lag, back to the slot, and out of the way."""

import math
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sar_planner.guidance.turn_radius import Turns
from sar_planner.guidance.waypoint_lists import HoldListing, PathListing, SlotListing
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.deadbeat.leg_following import follow_leg, hold, unfit_speed


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.floats(-50.0, 300.0))
def test_the_speed_takes_the_lag_out_within_the_trim(tick_at, state, lag):
    decision = follow_leg(state, tick_at(x=-lag))
    assert isinstance(decision.listing, SlotListing)
    asked = decision.state.speed_mps
    assert asked == pytest.approx(min(max(20.0 + 0.15 * lag, 18.0), 22.0))
    assert decision.state.mode is Mode.LEG


def test_a_lag_that_is_aimed_at_is_kept(tick_at, state):
    tick = tick_at(x=-100.0)
    expected, *others = tick.forecasts
    late = replace(tick, forecasts=(expected.behind(100.0), *others), aim_m=100.0)
    assert follow_leg(state, late).state.speed_mps == pytest.approx(20.0)
    assert follow_leg(state, tick).state.speed_mps == pytest.approx(22.0)


@pytest.mark.parametrize(("lag", "kept"), [(0.0, 0.0), (30.0, 0.0), (50.0, 225.0), (300.0, 225.0)])
def test_one_that_is_behind_stays_there_until_it_was_seen_to_turn(tick_at, state, lag, kept):
    tick = replace(tick_at(x=-lag), turns=Turns(100.0, is_sure=False))
    asked = follow_leg(state, tick).state.speed_mps
    assert asked == pytest.approx(min(max(20.0 + 0.15 * (lag - kept), 18.0), 22.0))
    straight_on = replace(tick, mission=replace(tick.mission, pattern="track_line"))
    assert follow_leg(state, straight_on).state.speed_mps == min(20.0 + 0.15 * lag, 22.0)


def test_nobody_is_led_back_for_what_a_first_corner_would_leave(tick_at, state):
    tick = tick_at()
    expected, *others = tick.forecasts
    behind = (expected.behind(125.0), *others)
    wary = replace(tick, forecasts=behind, aim_m=125.0, wary_m=125.0)
    assert follow_leg(state, wary).state.mode is Mode.LEG
    assert follow_leg(state, replace(wary, wary_m=0.0)).state.mode is Mode.REJOIN


@pytest.mark.parametrize("where", [{"y": -330.0}, {"x": 90.0}, {"vy": 15.0}])
def test_off_its_slot_or_far_ahead_it_is_led_back(tick_at, state, where):
    decision = follow_leg(state, tick_at(**where))
    assert decision.state.mode is Mode.REJOIN
    assert isinstance(decision.listing, PathListing)
    assert decision.state.retry_s == 102.0


def test_no_way_back_is_looked_for_before_its_time(tick_at, state):

    waiting = replace(state, retry_s=101.0)
    decision = follow_leg(waiting, tick_at(y=-330.0))
    assert decision.listing is None
    assert decision.state == waiting


@pytest.mark.parametrize(
    ("speed", "reason"),
    [
        (14.9, "helicopter's speed 14.9 m/s: expected 15.0 to 25.0"),
        (20.0, ""),
        (26.0, "helicopter's speed 26.0 m/s: expected 15.0 to 25.0"),
    ],
)
def test_speeds_that_it_cannot_be_followed_at(tick_at, speed, reason):
    found = unfit_speed(tick_at(leg_mps=speed))
    assert found == reason


def test_held_it_circles_once_and_says_why(tick_at, state):
    first = hold(state, tick_at(), "too slow")
    assert isinstance(first.listing, HoldListing)
    assert first.state.mode is Mode.HOLD
    assert first.state.problem == "holding: too slow"
    again = hold(first.state, tick_at(101.0), "too slow")
    assert again.listing is None
    assert not math.isfinite(again.state.retry_s)


def test_outside_of_a_turn_that_is_near_it_is_not_led_back(tick_at):
    """Nor while it is behind the helicopter still, however far ahead of what the wind asks for."""

    def most_ahead_m(first_leg_m, aim_m=0.0, **slot):
        tick = tick_at(first_leg_m=first_leg_m, **slot)
        tick.situation.progress.terms = tick.mission.terms
        return replace(tick, aim_m=aim_m).most_ahead_m

    outside = {"y": 250.0, "slot_side": "outside"}
    assert most_ahead_m(2000.0, **outside) == 60.0
    assert most_ahead_m(2000.0, 120.0, **outside) == 120.0
    assert most_ahead_m(600.0, **outside) == 250.0
    assert most_ahead_m(600.0, 120.0) == 60.0
