"""The closed loop's decisions: corner, correction, rejoin, hold, trim."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import UavStatus
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.guidance.vehicle import Vehicle
from sar_planner.mission_planner import MissionPlanner
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.strategies.active_corner import Mode

FLYING = UavStatus("AUTO", armed=True, connected=True)


def leg(time_s, x=0.0, y=0.0, heading=0.0, speed=20.0):
    return LegEstimate(time_s, Pose(x, y, heading), speed, 0.3, 0.001, 0.02)


def corner(onset_s, **changes):
    values = {
        "time_s": onset_s + 4.0,
        "stop": Pose(80.0, 0.0, 0.0),
        "stop_time_s": onset_s + 8.0,
        "speed_mps": 20.0,
        "accel_mps2": 2.5,
        "covariance": np.zeros((2, 2)),
        "heading_sigma_rad": 0.0,
        "stop_time_sigma_s": 0.0,
    }
    return CornerEstimate(**(values | changes))


def on_leg(lag, *, beside=0.0, course=0.0, speed=20.0):
    plan = MissionPlanner(CornerParameters(), MissionParameters())
    plan.set_status(FLYING)
    plan.situation.set_helicopter(Motion(100.0, 0.0, 0.0, speed, 0.0))
    plan.situation.set_uav(
        Motion(100.0, -lag, -250.0 + beside, 20.0 * math.cos(course), 20.0 * math.sin(course))
    )
    plan.situation.set_phase(Phase.CRUISE)
    plan.set_leg(leg(100.0, speed=speed))
    assert plan.engage(100.0) == ""
    return plan


@pytest.mark.parametrize(("lag", "speed"), [(0.0, 20.0), (10.0, 21.5), (300.0, 22.0), (-30, 18.0)])
def test_lag_on_a_leg_is_trimmed_by_speed(lag, speed):
    plan = on_leg(lag)
    assert plan.update(100.0).mode == "leg"
    assert plan.speed_mps == pytest.approx(speed, abs=0.05)


@pytest.mark.parametrize(
    "where",
    [{"lag": -200.0}, {"lag": 0.0, "beside": -300.0}, {"lag": 100.0, "course": 2.0}],
)
def test_off_the_slot_it_is_led_back(where):
    plan = on_leg(**where)
    listed = plan.update(100.0)
    assert plan.mode is Mode.REJOIN
    assert listed.mode == "rejoin"
    assert listed.points[-2][1] == pytest.approx(-250.0)
    assert listed.points[-1][1] == pytest.approx(-315.0)  # the loiter: apart, radius and all
    assert 18.0 - 1e-9 <= plan.speed_mps <= 22.0 + 1e-9


def at_a_corner():
    """A planner whose helicopter has been slowing for a corner since t = 100 s."""
    plan = on_leg(0.0)
    plan.update(100.0)
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_uav(Motion(104.0, 80.0, -250.0, 20.0, 0.0))
    plan.situation.set_helicopter(Motion(104.0, 60.0, 0.0, 10.0, 0.0))
    plan.situation.set_corner(corner(100.0))
    return plan


def test_corner_is_planned_committed_corrected_and_left():
    plan = at_a_corner()
    listed = plan.update(104.0)
    assert listed.mode == "D4"
    assert plan.active.plan.lag_m == pytest.approx(0.0, abs=1e-6)
    assert plan.active.plan.turn_start_m >= 100.0
    path = plan.active.path
    # The UAV follows, 1.5 s late, into the first turn; the helicopter turns as predicted.
    corrected = None
    for tenth in range(1, 120):
        now = 104.0 + 0.1 * tenth
        flown = path.pose_at(20.0 * (now - 100.0 - (1.5 if tenth > 40 else 0.0375 * tenth)))
        plan.situation.set_uav(
            Motion(
                now,
                flown.x_m,
                flown.y_m,
                20.0 * math.cos(flown.heading_rad),
                20.0 * math.sin(flown.heading_rad),
            )
        )
        plan.situation.set_helicopter(Motion(now, 80.0, 0.0, 0.0, 0.0))
        corrected = plan.update(now) or corrected
    assert plan.active.committed
    assert plan.report.corrections > 0
    assert corrected.mode == "D4"


def corrected_plan():
    """Return a planner that has just corrected its path, and when."""
    plan = at_a_corner()
    plan.update(104.0)
    path = plan.active.path
    for tenth in range(1, 200):
        now = 104.0 + 0.1 * tenth
        fly(plan, path.pose_at(20.0 * (now - 100.0 - min(1.5, 0.0375 * tenth))), now)
        if plan.report.corrections > 0:
            return plan, now
    raise AssertionError("never corrected")


def fly(plan, pose, now):
    vx, vy = 20.0 * math.cos(pose.heading_rad), 20.0 * math.sin(pose.heading_rad)
    plan.situation.set_uav(Motion(now, pose.x_m, pose.y_m, vx, vy))
    plan.situation.set_helicopter(Motion(now, 80.0, 0.0, 0.0, 0.0))
    return plan.update(now)


def test_on_its_way_over_to_a_corrected_path_the_uav_may_be_beside_it():
    plan, begun = corrected_plan()
    tracked = plan._strategy.state.path
    corrected = []
    for tenth in range(1, 60):
        now = begun + 0.1 * tenth
        there = tracked.path.pose_at(tracked.flown_m + 2.0 * tenth).offset(0.0, 25.0)
        fly(plan, tracked.frame.pose_to_map(there), now)
        if plan.report.corrections > 1:
            corrected.append(now - begun)
            break
    assert corrected == pytest.approx([MissionParameters().settling_s], abs=0.15)


def test_a_speed_is_for_the_course_on_which_the_uav_will_really_be():
    """One that stands in the wind would never get to where less is needed."""
    plan = at_a_corner()
    plan.update(104.0)
    path = plan.active.path
    turn_m = plan.active.plan.turn_start_m
    for speed, ahead_m in ((20.0, 70.0), (0.5, 1.75)):
        pose = path.pose_at(turn_m)
        vx, vy = speed * math.cos(pose.heading_rad), speed * math.sin(pose.heading_rad)
        plan.situation.set_uav(Motion(104.5, pose.x_m, pose.y_m, vx, vy))
        state = plan._strategy.state
        plan._strategy.state = replace(state, path=replace(state.path, flown_m=turn_m))
        there = plan._strategy.state.path.path.pose_at(turn_m + ahead_m)
        expected = plan._strategy.state.path.frame.pose_to_map(there).heading_rad
        assert plan.report.course_rad == pytest.approx(expected, abs=0.05)


def test_a_clock_set_back_ends_the_settling():
    plan, _ = corrected_plan()
    plan.set_clock_back()
    assert plan._strategy.state.corrected_s == -math.inf


def test_new_leg_another_way_is_approached_too():
    """The pilot turned left instead of right: the slot is on the other side."""
    plan = on_leg(0.0)
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner(100.0))
    plan.situation.set_uav(Motion(104.0, 80.0, -250.0, 20.0, 0.0))
    plan.situation.set_helicopter(Motion(104.0, 60.0, 0.0, 10.0, 0.0))
    plan.update(104.0)
    plan.situation.set_uav(Motion(118.0, 200.0, -380.0, 0.0, -20.0))
    plan.situation.set_phase(Phase.STOPPED)
    plan.situation.set_phase(Phase.ACCELERATING)
    plan.situation.set_helicopter(Motion(118.0, 80.0, 70.0, 0.0, 18.0))
    plan.update(118.0)
    assert plan.report.slot.x_m == pytest.approx(330.0)
    assert math.degrees(plan.report.slot.heading_rad) == pytest.approx(90.0)


def test_withdrawn_corner_goes_back_to_the_leg():
    plan = on_leg(300.0)
    plan.update(100.0)
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner(100.0))
    assert plan.update(104.0) is not None
    assert plan.mode is Mode.CORNER
    plan.situation.set_phase(Phase.ACCELERATING)
    plan.situation.set_helicopter(Motion(105.0, 70.0, 0.0, 15.0, 0.0))
    plan.situation.set_uav(Motion(105.0, -200.0, -250.0, 20.0, 0.0))
    assert plan.update(105.0).mode == "leg"
    assert plan.mode is Mode.LEG


def test_helicopter_that_flies_away_is_not_followed():
    plan = on_leg(0.0, speed=32.0)
    listed = plan.update(100.0)
    assert plan.mode is Mode.HOLD
    assert listed.mode == "hold"
    assert "helicopter's speed 3" in plan.problem
    assert plan.update(100.1) is None
    assert "holding" in plan.problem
    plan.set_leg(leg(130.0, x=600.0))
    plan.situation.set_helicopter(Motion(102.0, 40.0, 0.0, 20.0, 0.0))
    plan.situation.set_uav(Motion(102.0, 40.0, -250.0, 20.0, 0.0))
    assert plan.update(102.0) is not None
    assert plan.mode is not Mode.HOLD


def test_unknown_leg_keeps_the_list():
    plan = on_leg(0.0)
    plan.update(100.0)
    plan.situation.set_phase(Phase.STOPPED)
    assert plan.update(100.2) is None
    assert "leg not known" in plan.problem


def test_deceleration_outside_the_rules_is_told():
    plan = on_leg(0.0)
    plan.update(100.0)
    plan.situation.set_corner(corner(100.0, accel_mps2=0.9))
    plan.situation.set_phase(Phase.DECELERATING)
    listed = plan.update(100.5)
    assert listed.mode == "rejoin"  # the slot of the new leg is still the place to be
    assert "deceleration 0.90: the rules expect" in plan.problem
    plan.update(100.6)
    assert "deceleration 0.90" in plan.problem  # told until the next corner


def test_a_path_that_is_not_safe_is_told_as_long_as_it_is_flown():
    plan = on_leg(150.0, beside=250.0)  # right behind the helicopter
    plan.update(100.0)
    assert "comes within" in plan.problem
    plan.update(100.1)
    assert "comes within" in plan.problem


def test_old_legs_are_not_believed_after_a_stop():
    plan = on_leg(0.0)
    plan.situation.set_corner(corner(100.0))
    plan.set_leg(replace(leg(101.0), foot=Pose(999.0, 0.0, 0.0)))
    assert plan.situation.leg.foot.x_m == 0.0
    plan.set_leg(replace(leg(130.0), foot=Pose(80.0, -100.0, -math.pi / 2)))
    assert plan.situation.leg.foot.x_m == 80.0


def test_wind_and_the_autopilots_parameters_are_heeded():
    plan = on_leg(0.0)
    plan.set_vehicle(Vehicle({"NAVL1_PERIOD": 15.0, "AIRSPEED_MIN": 12.0, "AIRSPEED_MAX": 25.0}))
    plan.set_wind((-3.0, 0.0), 99.0)
    plan.update(100.0)
    assert plan.airspeed_mps == pytest.approx(23.0, abs=0.5)
    assert plan.problem == ""
    plan.set_wind((-8.0, 0.0), 100.0)
    plan.update(100.1)
    assert plan.airspeed_mps == 25.0
    assert "expected 12 to 25" in plan.problem
    plan.set_wind((math.nan, 0.0), 100.1)
    assert plan.wind_mps == (-8.0, 0.0)
    plan.disengage()
    plan.set_vehicle(Vehicle({"AIRSPEED_MAX": 18.0}))
    assert "AIRSPEED_MAX = 18" in plan.engage(100.2)


def test_the_autopilot_is_told_an_indicated_airspeed():
    plan = on_leg(0.0)
    plan.set_vehicle(Vehicle({"NAVL1_PERIOD": 15.0, "AIRSPEED_MIN": 12.0, "AIRSPEED_MAX": 25.0}))
    plan.update(100.0)
    told = plan.airspeed_mps
    plan.set_status(replace(FLYING, airspeed_ratio=1.1))
    assert plan.airspeed_mps == pytest.approx(told / 1.1)
    plan.set_wind((-7.0, 0.0), 100.0)
    plan.update(100.1)
    assert plan.airspeed_mps == pytest.approx(27.0 / 1.1)
    assert plan.problem == ""


def test_a_path_that_ends_beside_the_slot_is_left_when_it_has_been_flown():
    """The helicopter was believed to go on; meanwhile it has turned, and is far away."""
    plan = on_leg(0.0, beside=-300.0)
    assert plan.update(100.0).mode == "rejoin"
    state = plan._strategy.state
    path = state.path
    end = path.frame.pose_to_map(path.path.end)
    plan._strategy.state = replace(state, path=replace(path, flown_m=path.path.length_m))
    done_s = 100.0 + path.path.length_m / path.speed_mps
    plan.situation.set_uav(Motion(done_s, end.x_m, end.y_m, 20.0, 0.0))
    plan.set_leg(leg(done_s, x=80.0, y=-3000.0, heading=-math.pi / 2.0))
    plan.situation.set_helicopter(Motion(done_s, 80.0, -3000.0, 0.0, -20.0))
    listed = plan.update(done_s)
    assert listed is not None
    assert listed.mode == "rejoin"
    assert listed.points[-2][0] == pytest.approx(80.0 - 250.0, abs=1.0)


@pytest.mark.parametrize("accel", [2.5, 0.9], ids=["planned by a rule", "gone for straight"])
def test_a_corner_that_is_withdrawn_at_once_leaves_the_uav_on_its_leg(accel):
    plan = on_leg(0.0)
    plan.update(100.0)
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner(99.0, accel_mps2=accel, time_s=100.0))
    plan.update(100.0)
    assert plan.mode in (Mode.CORNER, Mode.REJOIN)
    now = 101.0
    plan.situation.set_uav(Motion(now, 20.0, -250.0, 20.0, 0.0))
    plan.situation.set_helicopter(Motion(now, 20.0, 0.0, 20.0, 0.0))
    plan.situation.set_phase(Phase.CRUISE)
    plan.set_leg(leg(now, x=20.0))
    assert plan.update(now).mode == "leg"
    assert plan.mode is Mode.LEG
