"""Every state of the deadbeat strategy against everything that can happen next."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import MonitorReport, UavStatus
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.guidance.path_efficiency import PathEfficiency
from sar_planner.guidance.turn_radius import Turns
from sar_planner.guidance.waypoint_lists import HoldListing, PathListing, SlotListing
from sar_planner.mission_planner import MissionPlanner
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.deadbeat.state import MOST_REFUSALS, REFUSED_ROOM_M, Tick
from sar_planner.strategies.deadbeat.strategy import decide

MODES = (Mode.LEG, Mode.CORNER, Mode.REJOIN, Mode.HOLD)


def leg_at(time_s, **changes):
    values = {"foot": Pose(0.0, 0.0, 0.0), "speed_mps": 20.0}
    known = values | changes
    return LegEstimate(time_s, known["foot"], known["speed_mps"], 0.3, 0.001, 0.02)


def corner_at(onset_s, **changes):
    values = {
        "time_s": onset_s + 4.0,
        "stop": Pose(20.0 * (onset_s - 100.0) + 80.0, 0.0, 0.0),
        "stop_time_s": onset_s + 8.0,
        "speed_mps": 20.0,
        "accel_mps2": 2.5,
        "covariance": np.zeros((2, 2)),
        "heading_sigma_rad": 0.0,
        "stop_time_sigma_s": 0.0,
    }
    return CornerEstimate(**(values | changes))


def helicopter_at(plan, now_s, vx=20.0, vy=0.0, x=None):
    plan.situation.set_helicopter(
        Motion(now_s, 20.0 * (now_s - 100.0) if x is None else x, 0.0, vx, vy)
    )


def led(mode):
    """A planner whose deadbeat strategy has come to a mode at t = 104 s by what happened."""
    plan = MissionPlanner(CornerParameters(), MissionParameters())
    plan.set_status(UavStatus("AUTO", armed=True, connected=True))
    beside = -600.0 if mode is Mode.REJOIN else -250.0
    plan.situation.set_uav(Motion(100.0, 0.0, beside, 20.0, 0.0))
    helicopter_at(plan, 100.0)
    plan.situation.set_phase(Phase.CRUISE)
    plan.set_leg(leg_at(100.0))
    assert plan.engage(100.0) == ""
    plan.update(100.0)
    plan.situation.set_uav(Motion(104.0, 80.0, beside, 20.0, 0.0))
    if mode is Mode.CORNER:
        plan.situation.set_phase(Phase.DECELERATING)
        plan.situation.set_corner(corner_at(100.0))
        helicopter_at(plan, 104.0, vx=10.0, x=60.0)
    elif mode is Mode.HOLD:
        plan.set_leg(leg_at(104.0, speed_mps=9.0))
        helicopter_at(plan, 104.0, vx=9.0, x=60.0)
    else:
        helicopter_at(plan, 104.0)
    plan.update(104.0)
    assert plan.mode is mode
    return plan


def goes_on(plan, now_s):
    plan.situation.set_phase(Phase.CRUISE)
    plan.set_leg(leg_at(now_s))
    helicopter_at(plan, now_s)


def predicts(plan, now_s):
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner_at(now_s - 4.0))
    helicopter_at(plan, now_s, vx=10.0, x=20.0 * (now_s - 104.0) + 60.0)


def predicts_what_is_outside_the_rules(plan, now_s):
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner_at(now_s - 4.0, speed_mps=40.0))
    helicopter_at(plan, now_s)


def takes_it_back(plan, now_s):
    predicts(plan, now_s)
    plan.update(now_s)
    goes_on(plan, now_s)


def turns_as_it_slows(plan, now_s):
    predicts(plan, now_s)
    helicopter_at(plan, now_s, vx=4.0, vy=-6.0, x=75.0)


def stands(plan, now_s):
    predicts(plan, now_s)
    plan.situation.set_phase(Phase.STOPPED)
    helicopter_at(plan, now_s, vx=0.0, x=80.0)


def turns_and_leaves(plan, now_s):
    stands(plan, now_s)
    plan.situation.set_phase(Phase.ACCELERATING)
    helicopter_at(plan, now_s, vx=0.0, vy=-15.0, x=80.0)


def turns_the_other_way(plan, now_s):
    stands(plan, now_s)
    plan.situation.set_phase(Phase.ACCELERATING)
    helicopter_at(plan, now_s, vx=0.0, vy=15.0, x=80.0)


def is_lost(plan, _now_s):
    plan.situation.set_phase(Phase.LOST)


def is_too_slow(plan, now_s):
    plan.situation.set_phase(Phase.CRUISE)
    plan.set_leg(leg_at(now_s, speed_mps=9.0))
    helicopter_at(plan, now_s, vx=9.0)


def uav_is_blown_aside(plan, now_s):
    goes_on(plan, now_s)
    plan.situation.set_uav(Motion(now_s, 20.0 * (now_s - 100.0), -700.0, 20.0, 0.0))


def clock_is_set_back(plan, now_s):
    plan.set_clock_back()
    goes_on(plan, now_s)
    plan.situation.set_uav(Motion(now_s, 20.0 * (now_s - 100.0), -250.0, 20.0, 0.0))


def is_disengaged_and_engaged(plan, now_s):
    plan.disengage()
    goes_on(plan, now_s)
    plan.situation.set_uav(Motion(now_s, 20.0 * (now_s - 100.0), -250.0, 20.0, 0.0))
    assert plan.engage(now_s) == ""


def list_is_refused(plan, now_s):
    """The newest one; where there is none, another's."""
    helicopter_at(plan, now_s)
    refused_id = 1 if plan.list is None else plan.list.list_id
    plan.set_monitor(MonitorReport(reason="list refused: near", refused_id=refused_id))


EVENTS = (
    goes_on,
    predicts,
    predicts_what_is_outside_the_rules,
    takes_it_back,
    turns_as_it_slows,
    stands,
    turns_and_leaves,
    turns_the_other_way,
    is_lost,
    is_too_slow,
    uav_is_blown_aside,
    clock_is_set_back,
    is_disengaged_and_engaged,
    list_is_refused,
)


def checked(plan, before):
    """Check what holds for every state, whatever has happened."""
    state = plan._strategy.state
    assert state.corrections >= before.corrections
    assert state.done_corner <= plan.situation.corners_seen
    assert state.lag_setpoint_m >= 0.0
    if state.mode in (Mode.CORNER, Mode.REJOIN):
        assert state.speed_mps is not None
        assert state.path.path.length_m >= 0.0
    if state.corner is not None:
        assert state.corner.k > before.done_corner
    return state


@pytest.mark.parametrize(("mode", "event"), list(itertools.product(MODES, EVENTS)))
def test_every_event_in_every_state(mode, event):
    plan = led(mode)
    before = plan._strategy.state
    event(plan, 108.0)
    listed = plan.update(108.0)
    state = checked(plan, before)
    if listed is not None:
        assert np.isfinite(listed.points).all()
    # A UAV that had left its slot goes on back to it by the path that it is on.
    was_begun = Mode.CORNER if mode is Mode.REJOIN else None
    expected = {
        goes_on: {Mode.LEG, Mode.REJOIN} | {mode} - {Mode.HOLD},
        predicts: {Mode.CORNER},
        predicts_what_is_outside_the_rules: {Mode.LEG, Mode.REJOIN, Mode.HOLD} | {mode},
        takes_it_back: {Mode.LEG, Mode.REJOIN} | {Mode.CORNER} & {was_begun},
        turns_as_it_slows: {Mode.CORNER},
        stands: {Mode.CORNER},
        turns_and_leaves: {Mode.CORNER},
        turns_the_other_way: {Mode.CORNER},
        is_lost: {mode},
        is_too_slow: {Mode.HOLD} | {mode} - {Mode.LEG, Mode.REJOIN},
        uav_is_blown_aside: {Mode.REJOIN} | {mode} - {Mode.LEG, Mode.HOLD},
        clock_is_set_back: {Mode.LEG, Mode.REJOIN},
        is_disengaged_and_engaged: {Mode.LEG, Mode.REJOIN},
        list_is_refused: {mode},
    }[event]
    assert state.mode in expected, plan.problem


@pytest.mark.parametrize(("first", "second"), list(itertools.product(EVENTS, EVENTS)))
def test_every_pair_of_events_leaves_a_whole_state(first, second):
    plan = led(Mode.LEG)
    for event, now_s in ((first, 108.0), (second, 112.0)):
        before = plan._strategy.state
        plan.situation.set_uav(Motion(now_s, 20.0 * (now_s - 100.0), -250.0, 20.0, 0.0))
        event(plan, now_s)
        plan.update(now_s)
        checked(plan, before)


@pytest.mark.parametrize("mode", MODES)
def test_a_mode_without_what_it_needs_is_refused(mode):
    state = led(mode)._strategy.state
    for other in MODES:
        if (other in (Mode.CORNER, Mode.REJOIN)) is not (mode in (Mode.CORNER, Mode.REJOIN)):
            with pytest.raises(ValueError, match=f"{other}: "):
                replace(state, mode=other)
    with pytest.raises(ValueError, match="idle: "):
        replace(state, mode=Mode.IDLE)


def test_on_a_refused_list_the_uav_is_taken_to_fly_the_path_that_it_had():
    plan = led(Mode.CORNER)
    flown = plan._strategy.state
    stands(plan, 107.0)
    plan.situation.set_uav(Motion(107.0, 140.0, -290.0, 20.0, 0.0))
    assert plan.update(107.0) is not None
    given = plan._strategy.state
    assert given.corrections == flown.corrections + 1
    list_is_refused(plan, 107.4)
    plan.situation.set_uav(Motion(107.4, 148.0, -290.0, 20.0, 0.0))
    plan.update(107.4)
    state = plan._strategy.state
    assert state.path.path == flown.path.path != given.path.path
    assert state.path.flown_m > flown.path.flown_m + 60.0
    assert state.speed_up == flown.speed_up
    assert (state.corner, state.before, state.refusals) == (given.corner, None, 1)
    assert state.retry_s == 107.4 + MissionParameters().retry_s
    plan.update(107.8)  # told again of the same list: that changes nothing
    assert plan._strategy.state.retry_s == state.retry_s


def test_a_uav_on_its_leg_whose_path_is_refused_flies_on_along_it_and_is_given_another():
    plan = led(Mode.CORNER)
    given = plan._strategy.state
    assert given.before.path is None
    given = replace(given, before=replace(given.before, speed_mps=19.0))
    plan._strategy.state = given
    list_is_refused(plan, 105.0)
    stands(plan, 105.0)
    assert plan.update(105.0) is None
    state = plan._strategy.state
    assert (state.path.path, state.is_lost) == (given.path.path, True)
    assert (state.speed_mps, state.speed_up) == (19.0, 1.0)
    assert state.retry_s == 105.0 + MissionParameters().retry_s
    assert (state.refusals, state.room_m, state.corner.sure) == (1, REFUSED_ROOM_M, None)
    again, now_s = None, 106.0
    while again is None and now_s < 116.0:
        now_s += 1.0
        plan.situation.set_uav(Motion(now_s, 20.0 * (now_s - 100.0), -250.0, 20.0, 0.0))
        helicopter_at(plan, now_s, vx=0.0, x=80.0)
        again = plan.update(now_s)
    assert again is not None
    assert math.dist(again.points[0], (20.0 * (now_s - 100.0), -250.0)) < 60.0


def test_who_is_refused_again_and_again_asks_for_more_room_up_to_a_limit():
    state = led(Mode.CORNER)._strategy.state
    rooms = []
    for _ in range(MOST_REFUSALS + 2):
        state = state.listed(state).refused(106.0)
        rooms.append(state.room_m)
    assert rooms == [15.0, 30.0, 45.0, 45.0, 45.0]
    assert state.without_path(Mode.LEG).room_m == 0.0


def test_a_refusal_means_nothing_to_a_state_without_a_path():
    for mode in (Mode.LEG, Mode.HOLD):
        state = led(mode)._strategy.state
        assert state.refused(106.0) is state


def test_a_decision_changes_neither_its_state_nor_what_it_is_taken_from():
    for mode in MODES:
        plan = led(mode)
        goes_on(plan, 108.0)
        strategy = plan._strategy
        state, situation = strategy.state, plan.situation
        tick = Tick(
            108.0,
            situation,
            situation.forecasts(108.0),
            CornerParameters(),
            MissionParameters(),
            strategy.lists.air,
            Turns(100.0),
        )
        known = vars(situation).copy()
        one, other = decide(state, tick), decide(state, tick)
        assert strategy.state is state
        assert vars(situation) == known
        assert one.state.mode is other.state.mode
        assert one.state.speed_mps == other.state.speed_mps
        assert isinstance(one.listing, type(other.listing))


def test_what_is_listed_fits_the_mode():
    kinds = {}
    for mode, event in itertools.product(MODES, EVENTS):
        plan = led(mode)
        event(plan, 108.0)
        strategy = plan._strategy
        tick = Tick(
            108.0,
            plan.situation,
            plan.situation.forecasts(108.0),
            CornerParameters(),
            MissionParameters(),
            strategy.lists.air,
            Turns(100.0),
        )
        found = decide(strategy.state, tick)
        if found.listing is not None:
            kinds.setdefault(found.state.mode, set()).add(type(found.listing))
    assert kinds == {
        Mode.LEG: {SlotListing},
        Mode.CORNER: {PathListing},
        Mode.REJOIN: {PathListing},
        Mode.HOLD: {HoldListing},
    }


def test_a_path_that_was_flown_to_its_end_teaches_its_efficiency():
    plan = led(Mode.CORNER)
    strategy = plan._strategy
    tick = Tick(
        104.0,
        plan.situation,
        plan.situation.forecasts(104.0),
        CornerParameters(),
        MissionParameters(),
        strategy.lists.air,
        Turns(100.0),
    )
    poor = PathEfficiency(1.0).begun(20.0)
    for second in range(60):
        poor = poor.watched(float(second), 12.0 * second, 20.0)
    corner = replace(strategy.state.corner, committed=True)
    left = replace(strategy.state, corner=corner, efficiency=poor).left(tick)
    assert left.efficiency.share == pytest.approx(0.6)
    assert left.lag_setpoint_m > 0.0
    corner = replace(corner, committed=False)
    uncommitted = replace(strategy.state, corner=corner, efficiency=poor).left(tick)
    assert uncommitted.efficiency.share == 1.0
    assert math.isclose(uncommitted.lag_setpoint_m, 0.0)
