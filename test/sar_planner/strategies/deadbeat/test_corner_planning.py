"""A corner is planned, planned anew while it is refined, and committed to."""

from dataclasses import replace

import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_planner.guidance.turn_radius import Turns
from sar_planner.guidance.waypoint_lists import PathListing
from sar_planner.prediction.separation import least_apart_m
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.deadbeat.corner_planning import (
    UNSURE_SHARE,
    commit_when_due,
    path_speed_mps,
    plan_corner,
)


def planned(tick_at, state, corner, now_s=104.0, **where):
    return plan_corner(state, tick_at(now_s, corner=corner, **where))


def test_on_its_slot_the_uav_gets_a_rules_path(tick_at, state, corner):
    decision = planned(tick_at, state, corner)
    found = decision.state
    assert found.mode is Mode.CORNER
    assert found.corner.k == 1
    assert isinstance(decision.listing, PathListing)
    assert decision.listing.mode == str(found.corner.plan.rule) == "D4"
    # It is flown faster than V, and from where the UAV is by now.
    assert found.speed_up == pytest.approx(1.1)
    assert decision.listing.from_m == pytest.approx(80.0)


def test_the_same_estimate_is_planned_once_and_a_small_change_not_at_all(tick_at, state, corner):
    """Far behind its slot the UAV cuts the corner, and turns late."""
    found = planned(tick_at, state, corner, x=-470.0).state
    assert not found.corner.committed
    assert planned(tick_at, found, corner, 104.2, x=-466.0).listing is None
    near = replace(corner, time_s=105.0, stop=Pose(85.0, 0.0, 0.0))
    assert planned(tick_at, found, near, 105.0, x=-450.0).listing is None
    far = replace(corner, time_s=105.0, stop=Pose(100.0, 0.0, 0.0), stop_time_s=109.0)
    again = planned(tick_at, found, far, 105.0, x=-450.0)
    assert again.listing is not None
    assert again.state.corner.first_stop == corner.stop


def test_a_corner_that_rules_are_not_for_is_told_and_left(tick_at, state, corner):
    fast = replace(corner, speed_mps=40.0)
    decision = planned(tick_at, state, fast)
    assert decision.goes_on
    assert decision.state.done_corner == 1
    assert "helicopter's speed 40.00" in decision.state.corner_problem


def test_off_its_slot_track_it_goes_straight_for_the_new_leg(tick_at, state, corner):
    decision = planned(tick_at, state, corner, y=-420.0)
    assert decision.state.mode is Mode.CORNER
    assert decision.listing.mode == "RJ"
    assert decision.state.corner.committed


def test_it_commits_when_the_uav_is_about_to_turn(tick_at, state, corner):
    found = planned(tick_at, state, corner, x=-470.0).state
    turn_s = found.corner.plan.turn_start_m / 20.0 + found.corner.estimate.onset_time_s
    early, late = (tick_at(turn_s + by, corner=corner) for by in (-1.5, -0.9))
    assert not commit_when_due(found, early).corner.committed
    assert commit_when_due(found, late).corner.committed


def test_it_commits_when_the_helicopter_turns_as_it_slows(tick_at, state, corner):
    found = planned(tick_at, state, corner, x=-470.0).state
    tick = tick_at(106.0, corner=corner, x=-430.0)
    assert not commit_when_due(found, tick).corner.committed
    tick.situation.set_helicopter(Motion(106.0, 78.0, -2.0, 3.0, -4.0))
    assert commit_when_due(found, tick).corner.committed


def test_on_its_slot_it_turns_as_soon_as_it_can_and_is_committed_to_that(tick_at, state, corner):
    assert planned(tick_at, state, corner).state.corner.committed


def test_a_lag_is_caught_up_with_only_where_it_is_worth_it(tick_at):
    tick = tick_at()
    values = {"helicopter_mps": 20.0, "planned_share": 1.0, "share": 1.0}
    assert path_speed_mps(tick, 1000.0, 50.0, **values) == 20.0
    assert path_speed_mps(tick, 1000.0, 70.0, **values) == pytest.approx(20.0 / 0.93)
    assert path_speed_mps(tick, 300.0, 200.0, **values) == 22.0


def test_one_that_turns_wide_or_may_flies_a_corner_no_faster_than_planned(tick_at):
    values = {"helicopter_mps": 20.0, "share": 1.0}
    for turns in (Turns(150.0, is_wide=True), Turns(100.0, is_sure=False)):
        tick = replace(tick_at(), turns=turns)
        assert path_speed_mps(tick, 300.0, 200.0, planned_share=0.8, **values) == 16.0
        assert path_speed_mps(tick, 300.0, 200.0, planned_share=None, **values) == 22.0


def test_before_it_was_seen_to_turn_a_corner_is_planned_with_more_room(tick_at, state, corner):
    """At V, with more of a margin, and apart, too, from where it would be were it slow."""
    unsure = replace(tick_at(104.0, corner=corner, x=-470.0), turns=Turns(100.0, is_sure=False))
    found = plan_corner(state, unsure).state
    assert found.corner.unsure
    assert found.speed_up == 1.0
    path, frame = found.corner.plan.path, found.corner.frame
    forecast = unsure.expected.in_frame(frame)
    start_s = corner.onset_time_s
    for share in (1.0, UNSURE_SHARE):
        apart = least_apart_m(path, [forecast], start_s=start_s, speed_mps=20.0 * share)
        assert apart >= unsure.corner.separation_m - 25.0
    known = planned(tick_at, state, corner, x=-470.0).state
    assert not known.corner.unsure
