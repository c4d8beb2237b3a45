"""From anywhere onto the slot, with the widest separation that there is a way for."""

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sar_planner.guidance.turn_radius import Turns
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.deadbeat.rejoining import rejoin_plan, start_rejoining, take
from sar_planner.strategies.deadbeat.state import MOST_REFUSALS, REFUSED_ROOM_M


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.floats(-900.0, 900.0), st.floats(-1200.0, -320.0))
def test_a_way_back_begins_at_the_uav_and_ends_on_the_slot(tick_at, state, x, y):
    tick = tick_at(x=x, y=y)
    decision = start_rejoining(state, tick)
    found = decision.state
    assert found.mode is Mode.REJOIN
    start, end = found.path.path.start, found.path.path.end
    ahead = tick.uav_in(tick.slot_frame, tick.mission.reaction_s)
    assert (start.x_m, start.y_m) == pytest.approx((ahead.x_m, ahead.y_m), abs=0.5)
    assert (end.y_m, end.heading_rad) == pytest.approx((0.0, 0.0), abs=1e-3)
    slowest, fastest = tick.path_speeds_mps(None, 20.0)
    assert slowest - 1e-9 <= found.speed_mps <= fastest + 1e-9


def test_the_whole_margin_is_kept_where_it_can_be(tick_at, state):
    tick = tick_at(x=-700.0, y=-700.0)
    plan = rejoin_plan(state, tick)
    assert plan.kept
    assert plan.closest_m >= tick.separations_m[0] - 1e-6


@pytest.mark.parametrize(("x", "y"), [(300.0, 0.0), (300.0, 300.0)])
def test_who_was_refused_is_led_back_with_more_room(tick_at, state, x, y):
    tick = tick_at(x=x, y=y)
    for refusals in range(MOST_REFUSALS):
        plan = rejoin_plan(replace(state, refusals=refusals), tick)
        wanted_m = tick.separations_m[0] + refusals * REFUSED_ROOM_M
        assert wanted_m - 1e-6 <= plan.closest_m < wanted_m + 3.0
    # More than there is in the slot: what keeps the least and its room is a way for all that.
    plan = rejoin_plan(replace(state, refusals=MOST_REFUSALS), tick)
    assert plan.kept
    assert tick.separations_m[2] + MOST_REFUSALS * REFUSED_ROOM_M <= plan.closest_m
    assert plan.closest_m < tick.separations_m[0] + MOST_REFUSALS * REFUSED_ROOM_M


def test_one_that_begins_too_near_is_told_with_what_it_keeps(tick_at, state):
    decision = start_rejoining(state, tick_at(x=30.0, y=-60.0))
    assert decision.state.mode is Mode.REJOIN
    assert decision.state.path_problem.startswith("rejoining comes within ")


def test_what_is_learnt_of_a_corner_goes_on_on_the_way_back(tick_at, state):
    tick = tick_at(y=-400.0)
    begun = state.efficiency.begun(20.0).watched(99.0, 500.0, 20.0)

    decision = take(rejoin_plan(state, tick), replace(state, efficiency=begun), tick)
    assert decision.state.efficiency == begun.moved()


def test_one_that_makes_little_good_is_asked_to_fly_as_fast_as_others(tick_at, state):
    tick = tick_at(x=200.0, y=-600.0)
    slowest, fastest = tick.path_speeds_mps(None, 20.0)
    plan = rejoin_plan(state, tick, 0.95)
    assert slowest - 1e-9 <= plan.speed_mps <= fastest + 1e-9
    assert plan.duration_s >= plan.path.length_m / (0.95 * fastest) - 1e-6


def test_one_that_turns_wide_is_led_by_wider_turns(tick_at, state):
    wide = replace(tick_at(y=-700.0), turns=Turns(150.0, is_wide=True))
    widest = start_rejoining(state, wide).state.path.path.widest_m
    assert widest == pytest.approx(150.0 * 1.1**2)


@pytest.mark.parametrize("x", [-1200.0, -600.0])
def test_one_that_would_take_minutes_is_led_onto_the_track_first(tick_at, state, x):
    """With 22 m/s behind 20 the slot is met after 120 s for every 240 m; the leg makes up."""
    tick = tick_at(x=x, y=-700.0)
    plan = rejoin_plan(state, tick)
    assert plan.kept
    assert plan.duration_s < 90.0
    end = plan.path.end
    assert (end.y_m, end.heading_rad) == pytest.approx((0.0, 0.0), abs=1e-3)
    slot_x_m = tick.forecasts_in(tick.slot_frame)[0].slot_x_m(100.0 + plan.duration_s)
    assert end.x_m < slot_x_m - 100.0
