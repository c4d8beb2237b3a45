"""What is left of a path is solved again: joined to what is flown, no nearer, no worse."""

import math
from dataclasses import replace

import pytest

from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.deadbeat.corner_planning import plan_corner
from sar_planner.strategies.deadbeat.correction import correct


def in_corner(tick_at, state, corner):
    """A corner's path, flown for some seconds, as planned."""
    return plan_corner(state, tick_at(104.0, corner=corner)).state


def at(tick_at, found, now_s, corner, *, late_m=0.0, aside_m=0.0):
    """The UAV on its path at a time, or late, or aside."""
    path = found.corner.path
    flown = 20.0 * (now_s - 100.0) - late_m
    pose = path.pose_at(flown).offset(0.0, aside_m)
    tick = tick_at(now_s, x=pose.x_m, y=pose.y_m, corner=corner)
    tracked = found.path.followed(tick.uav_in(found.path.frame), flown + 20.0)

    return replace(found, path=tracked), tick


@pytest.mark.parametrize("late_m", [0.0, 40.0])
def test_a_corrected_path_goes_on_from_the_old_one(tick_at, state, corner, late_m):
    found = in_corner(tick_at, state, corner)
    begun, tick = at(tick_at, found, 106.0, corner, late_m=late_m)
    decision = correct(begun, tick, 0.0, math.inf)
    new = decision.state
    assert new.mode is Mode.CORNER
    assert new.corrections == begun.corrections + 1
    assert new.retry_s == pytest.approx(106.0 + tick.mission.correction_s)
    old = begun.path.frame.path_to_map(begun.path.path)
    start = decision.listing.path.start
    where = old.pose_at(begun.path.flown_m)
    assert math.hypot(start.x_m - where.x_m, start.y_m - where.y_m) < 1.0
    end = tick.slot_frame.path_from_map(decision.listing.path).end
    assert (end.y_m, end.heading_rad) == pytest.approx((0.0, 0.0), abs=1e-3)


def test_off_its_path_it_begins_where_the_uav_is(tick_at, state, corner):
    found = in_corner(tick_at, state, corner)
    begun, tick = at(tick_at, found, 106.0, corner, aside_m=-30.0)
    decision = correct(begun, tick, 30.0, math.inf)
    start = decision.listing.path.start
    uav = tick.situation.uav
    assert math.hypot(start.x_m - uav.x_m, start.y_m - uav.y_m) < 35.0
    assert abs(start.y_m - uav.y_m) < 5.0


def test_a_new_path_that_is_much_worse_is_not_taken(tick_at, state, corner):
    """The old one leaves nothing; a UAV that is 600 m late is left on it."""
    found = in_corner(tick_at, state, corner)
    begun, tick = at(tick_at, found, 106.0, corner)
    late = tick_at(106.0, x=tick.situation.uav.x_m - 600.0, corner=corner)
    decision = correct(begun, late, 0.0, -250.0)
    assert decision.listing is None
    assert decision.state.corrections == begun.corrections


@pytest.mark.parametrize("gone_m", [600.0, 1500.0, 4000.0])
def test_a_uav_that_flew_on_as_its_list_was_refused_is_led_back(tick_at, state, corner, gone_m):
    """What is left of a path that it does not fly says nothing of it, however short or safe."""
    found = replace(in_corner(tick_at, state, corner), is_lost=True)
    begun, tick = at(tick_at, found, 106.0, corner)
    away = tick_at(106.0, x=tick.situation.uav.x_m + gone_m, corner=corner)
    decision = correct(begun, away, gone_m, math.inf)
    path = decision.listing.path
    assert math.dist((path.start.x_m, path.start.y_m), (away.situation.uav.x_m, -250.0)) < 60.0
    end = away.slot_frame.path_from_map(path).end
    assert (end.y_m, end.heading_rad) == pytest.approx((0.0, 0.0), abs=1e-3)
    assert not decision.state.is_lost
