"""The planner: every mode is driven by every event, and by whole corners."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common import topics
from sar_estimator.common.checked import read
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import MonitorReport, UavStatus
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_estimator.common.wires import WIRES
from sar_planner.component import PlannerComponent, corner_outputs
from sar_planner.mission_planner import MissionPlanner
from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.parameters.mission import MissionParameters
from sar_planner.patterns.slot import Slot
from sar_planner.strategies.active_corner import Mode

FLYING = UavStatus("AUTO", armed=True, connected=True)


def planner(**changes):
    return MissionPlanner(CornerParameters(), MissionParameters(**({"rules": "paper"} | changes)))


def leg(time_s=0.0, x=0.0, heading=0.0):
    return LegEstimate(time_s, Pose(x, 0.0, heading), 20.0, 1.0, 0.001, 0.1)


def corner(onset_s, *, time_s=None, stop_x=80.0, accel=2.5, speed=20.0):
    return CornerEstimate(
        time_s=onset_s if time_s is None else time_s,
        stop=Pose(stop_x, 0.0, 0.0),
        stop_time_s=onset_s + speed / accel,
        speed_mps=speed,
        accel_mps2=accel,
        covariance=np.zeros((2, 2)),
        heading_sigma_rad=0.0,
        stop_time_sigma_s=0.0,
    )


def on_leg(lag, time_s=100.0, **changes):
    """A planner engaged on a leg along +x, the helicopter at x = 0 at ``time_s``."""
    plan = planner(**changes)
    plan.set_status(FLYING)
    plan.situation.set_helicopter(Motion(time_s, 0.0, 0.0, 20.0, 0.0))
    side = changes.get("turn_side", 1)
    plan.situation.set_uav(Motion(time_s, -lag, -side * 250.0, 20.0, 0.0))
    plan.situation.set_phase(Phase.CRUISE)
    plan.set_leg(leg(time_s))
    assert plan.engage(time_s) == ""
    return plan


def test_engage_says_what_is_missing():
    plan = planner()
    assert plan.engage(0.0) == "no heartbeat from the autopilot"
    plan.set_status(UavStatus("AUTO", armed=False, connected=True))
    assert "not armed" in plan.engage(0.0)
    plan.set_status(UavStatus("MANUAL", armed=True, connected=True))
    assert "mode MANUAL: expected AUTO or GUIDED" in plan.engage(0.0)
    plan.set_status(FLYING)
    assert plan.engage(0.0) == "no UAV position"
    plan.situation.set_uav(Motion(0.0, 0.0, -250.0, 20.0, 0.0))
    assert plan.engage(0.0) == "no helicopter position"
    plan.situation.set_helicopter(Motion(0.0, 0.0, 0.0, 20.0, 0.0))
    assert plan.engage(0.0) == "helicopter GPS lost"
    plan.situation.set_phase(Phase.CRUISE)
    assert plan.engage(0.0) == "helicopter's leg not known yet"
    plan.set_leg(leg())
    assert "UAV position 20.0 s old" in plan.engage(20.0)
    assert plan.engage(0.0) == ""
    assert plan.mode is Mode.LEG


@pytest.mark.parametrize("side", [1, -1])
def test_leg_list_is_the_slot_track_on_the_inside(side):
    plan = on_leg(800.0, turn_side=side)
    waypoints = plan.update(100.0)
    assert waypoints.mode == "leg"
    # The track, then the place of the loiter beside it.
    assert waypoints.points[:, 1] == pytest.approx([-side * 250.0] * 2 + [-side * 315.0])
    assert waypoints.points[0, 0] > -800.0
    assert plan.update(100.1) is None
    assert plan.lag_m() == pytest.approx(800.0)
    assert plan.situation.separation_m() == pytest.approx(math.hypot(800.0, 250.0))


def test_shifted_slot_track_is_listed_again():
    plan = on_leg(0.0)
    assert plan.update(100.0) is not None
    plan.set_leg(replace(leg(101.0), foot=Pose(20.0, 8.0, 0.0)))
    assert plan.update(101.0) is None
    plan.set_leg(replace(leg(102.0), foot=Pose(40.0, 12.0, 0.0)))
    assert plan.update(102.0).points[0, 1] == pytest.approx(-238.0)


def test_a_small_shift_of_the_slot_track_is_listed_later():
    plan = on_leg(0.0)
    assert plan.update(100.0) is not None
    listed = []
    for second in range(1, 60):
        now = 100.0 + second
        plan.situation.set_uav(Motion(now, 20.0 * second, -250.0, 20.0, 0.0))
        plan.situation.set_helicopter(Motion(now, 20.0 * second, 0.0, 20.0, 0.0))
        plan.set_leg(replace(leg(now), foot=Pose(20.0 * second, 5.0, 0.0)))
        if plan.update(now) is not None:
            listed.append(second)
    # 5 m of 10 m are tolerated until 550 m are flown.
    assert listed == [28]


@pytest.mark.parametrize(
    ("lag", "rule"), [(800.0, "T1"), (300.0, "T2"), (0.0, "T3"), (-200.0, "T4")]
)
def test_corner_measures_lag_and_picks_the_rule(lag, rule):
    plan = on_leg(lag)
    plan.update(100.0)
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner(100.0))
    waypoints = plan.update(100.0)
    assert waypoints.mode == rule == plan.rule
    assert plan.active.plan.lag_m == pytest.approx(lag, abs=1e-6)
    (_, record), (_, curve) = corner_outputs(plan.active, waypoints)
    assert (record.k, record.rule) == (1, rule)
    assert curve.list_id == record.list_id == waypoints.list_id
    assert np.hypot(*np.diff(curve.points, axis=0).T).max() < 10.1


def test_lag_is_that_of_the_onset_however_late_it_is_detected():
    plan = on_leg(100.0)
    plan.update(100.0)
    plan.situation.set_uav(Motion(104.0, -20.0, -250.0, 20.0, 0.0))
    plan.situation.set_helicopter(Motion(104.0, 60.0, 0.0, 10.0, 0.0))
    plan.situation.set_corner(corner(100.0, time_s=104.0))
    plan.update(104.0)
    assert plan.active.plan.lag_m == pytest.approx(100.0, abs=1e-6)
    assert plan.active.plan.turn_start_m >= 80.0


def test_corner_is_moved_until_the_uav_turns_and_then_left_alone():
    plan = on_leg(300.0)
    plan.update(100.0)
    plan.situation.set_corner(corner(100.0))
    first = plan.update(100.0)
    moved = None
    for step in range(1, 400):
        now = 100.0 + 0.1 * step
        plan.situation.set_uav(Motion(now, -300.0 + 2.0 * step, -250.0, 20.0, 0.0))
        plan.situation.set_helicopter(Motion(now, min(80.0, 2.0 * step), 0.0, 0.0, 0.0))
        plan.situation.set_corner(corner(100.0, time_s=now, stop_x=80.0 + 0.05 * step))
        listed = plan.update(now)
        if plan.active.committed:
            assert listed is None
            break
        moved = listed or moved
    assert plan.active.committed
    assert moved.number > first.number
    # It commits 1 s before the first arc.
    assert plan.active.plan.turn_start_m - plan.active.flown_m(now) == pytest.approx(20.0, abs=3.0)


def test_corner_ends_on_the_new_slot_track():
    plan = on_leg(0.0)
    plan.update(100.0)
    plan.situation.set_corner(corner(100.0))
    plan.update(100.0)
    end = plan.active.frame.pose_to_map(plan.active.plan.path.end)
    for now in (100.5, 101.0):
        plan.situation.set_uav(Motion(now, 0.0, -250.0, 20.0, 0.0))
        plan.situation.set_helicopter(Motion(now, 10.0, 0.0, 20.0, 0.0))
        plan.update(now)
    assert plan.active.committed
    plan.situation.set_uav(Motion(150.0, end.x_m, end.y_m - 5.0, 0.0, -20.0))
    plan.situation.set_helicopter(Motion(150.0, 80.0, -700.0, 0.0, -20.0))
    plan.set_leg(leg(149.0, x=80.0, heading=-math.pi / 2))
    listed = plan.update(150.0)
    assert plan.mode is Mode.LEG
    assert listed.points[:2, 0] == pytest.approx([80.0 - 250.0] * 2, abs=1e-6)


def test_withdrawn_corner_goes_back_to_the_leg():
    plan = on_leg(600.0)
    plan.update(100.0)
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner(100.0))
    plan.update(100.0)
    assert plan.mode is Mode.CORNER
    plan.situation.set_phase(Phase.ACCELERATING)
    plan.situation.set_helicopter(Motion(102.0, 40.0, 0.0, 18.0, 0.0))
    plan.situation.set_uav(Motion(102.0, -560.0, -250.0, 20.0, 0.0))
    assert plan.update(102.0).mode == "leg"
    assert plan.mode is Mode.LEG


@pytest.mark.parametrize("changes", [{"speed": 55.0}, {"accel": 0.5}])
def test_motion_outside_the_rules_is_told_and_not_planned(changes):
    plan = on_leg(300.0)
    plan.update(100.0)
    plan.situation.set_corner(corner(100.0, **changes))
    assert plan.update(100.0) is None
    assert "the rules expect" in plan.problem
    assert plan.mode is Mode.LEG


def test_a_human_taking_the_mode_ends_the_engagement():
    plan = on_leg(0.0)
    plan.update(100.0)
    plan.set_status(UavStatus("LOITER", armed=True, connected=True))
    assert plan.mode is Mode.IDLE
    assert plan.problem == "released: the UAV was taken to mode LOITER"
    assert plan.update(101.0) is None


def test_engaging_from_guided_survives_the_change_to_auto():
    plan = planner()
    plan.set_status(UavStatus("GUIDED", armed=True, connected=True))
    plan.situation.set_helicopter(Motion(1.0, 0.0, 0.0, 20.0, 0.0))
    plan.situation.set_uav(Motion(1.0, 0.0, -250.0, 20.0, 0.0))
    plan.situation.set_phase(Phase.CRUISE)
    plan.set_leg(leg())
    assert plan.engage(1.0) == ""
    plan.set_status(UavStatus("GUIDED", armed=True, connected=True))
    plan.set_status(FLYING)
    assert plan.mode is Mode.LEG
    plan.set_status(UavStatus("GUIDED", armed=True, connected=True))
    assert plan.mode is Mode.IDLE


def test_stale_positions_stop_decisions():
    plan = on_leg(0.0)
    assert plan.update(120.0) is None
    assert "UAV position 20.0 s old" in plan.problem


@pytest.mark.parametrize("rules", ["paper", "deadbeat"])
def test_a_helicopter_at_the_other_end_of_the_world_is_not_flown_to(rules):
    """A receiver may say anything; a path that long would take for ever to plan."""
    plan = on_leg(0.0, rules=rules)
    assert plan.update(100.0) is not None
    plan.situation.set_helicopter(Motion(101.0, 5e6, -3e6, 20.0, 0.0))
    plan.set_leg(LegEstimate(101.0, Pose(5e6, -3e6, 0.0), 20.0, 1.0, 0.001, 0.1))
    assert plan.update(101.0) is None
    assert plan.problem == "helicopter 5831 km from the UAV: expected within 20 km"


def test_bad_mission_parameters_are_named():
    for changes, named in (
        ({"turn_side": 2}, "turn_side = 2"),
        ({"reaction_s": -1.0}, r"reaction_s = -1\.0: expected 0 or more"),
        ({"arc_spacing_m": -1.0}, "arc_spacing_m"),
        ({"horizon_m": 0.0}, "horizon_m"),
        ({"speed_range": (0.75,)}, "speed_range"),
        ({"accel_range": (2.0, 1.0)}, r"accel_range = 2\.0, 1\.0: expected low <= high"),
        ({"corner_speed_up": 0.2}, r"corner_speed_up = 0\.2: expected at most speed_trim = 0\.1"),
        ({"speed_trim": 0.5}, r"speed_trim = 0\.5: expected more than 0, less than 0\.5"),
    ):
        with pytest.raises(ValueError, match=named):
            read(MissionParameters, changes)
    with pytest.raises(ParameterError, match="rules = best: expected one of"):
        MissionPlanner(CornerParameters(), MissionParameters(rules="best"))


def past_corner(plan, *, engage_at=160.0):
    """The helicopter has flown corner 1 while nobody was engaged; the UAV is on the new slot."""
    plan.disengage()
    plan.situation.set_corner(corner(100.0))
    plan.situation.set_phase(Phase.CRUISE)
    plan.situation.set_helicopter(Motion(engage_at, 80.0, -900.0, 0.0, -20.0))
    plan.situation.set_uav(Motion(engage_at, -170.0, -900.0, 0.0, -20.0))
    plan.set_leg(leg(engage_at, x=80.0, heading=-math.pi / 2))
    assert plan.engage(engage_at) == ""
    return plan.update(engage_at)


def test_engaging_after_a_corner_does_not_plan_it_again():
    listed = past_corner(on_leg(0.0))
    assert listed.mode == "leg"
    assert listed.points[0] == pytest.approx((-170.0, -1050.0))


def advance(plan, now):
    plan.situation.set_helicopter(Motion(now, 20.0 * (now - 100.0), 0.0, 20.0, 0.0))
    plan.set_leg(leg(now, 20.0 * (now - 100.0)))


@pytest.mark.parametrize("rules", ["paper", "deadbeat"])
def test_nothing_is_planned_while_the_monitor_leads_the_uav_away(rules):
    plan = on_leg(0.0, rules=rules)
    assert plan.update(100.0) is not None
    plan.set_monitor(MonitorReport("escape", reason="sent away: 80 m"))
    assert plan.update(100.5) is None
    assert plan.problem == "monitor: sent away: 80 m"
    assert plan.engaged
    plan.situation.set_uav(Motion(110.0, 100.0, -900.0, 0.0, -20.0))
    advance(plan, 110.0)
    assert plan.update(110.0) is None
    plan.set_monitor(MonitorReport())
    listed = plan.update(110.1)
    assert listed is not None  # from where the UAV is now
    assert np.hypot(*(listed.points[0] - (100.0, -900.0))) < 2000.0
    assert plan.problem == ""


def test_a_refused_leg_is_listed_again_after_a_while():
    plan = on_leg(0.0, rules="deadbeat")
    first = plan.update(100.0)
    refused = MonitorReport(reason="list refused: 80 m", refused_id=first.list_id)
    plan.set_monitor(refused)
    again = plan.update(100.1)
    assert again is not None
    assert plan.problem == "list refused: 80 m"
    plan.set_monitor(replace(refused, refused_id=again.list_id))
    assert plan.update(100.2) is None
    assert plan.update(102.0) is None
    assert plan.update(102.2) is not None
    plan.set_monitor(MonitorReport())
    assert plan.update(102.3) is None
    assert plan.problem == ""


def test_disengaging_in_a_corner_and_engaging_again_does_not_plan_it_again():
    plan = on_leg(600.0)
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner(100.0))
    plan.update(100.0)
    assert past_corner(plan).mode == "leg"


@pytest.mark.parametrize(
    "uav", [(-500.0, 1500.0, -20.0), (-100.0, -250.0, -20.0), (0.0, -400.0, 20.0)]
)
def test_a_uav_that_is_not_on_its_slot_gets_no_corner_path(uav):
    plan = on_leg(100.0)
    plan.update(100.0)
    plan.situation.set_uav(Motion(100.0, uav[0], uav[1], uav[2], 0.0))
    plan.situation.set_phase(Phase.DECELERATING)
    plan.situation.set_corner(corner(100.0))
    listed = plan.update(100.0)
    assert listed is None or listed.mode == "leg"
    assert "not planned" in plan.problem
    plan.update(100.1)
    assert "not planned" in plan.problem  # told until the next corner


def test_old_leg_heard_while_the_helicopter_hovers_is_not_flown():
    plan = on_leg(0.0)
    plan.update(100.0)
    plan.situation.set_corner(corner(100.0))
    plan.update(100.0)
    end = plan.active.frame.pose_to_map(plan.active.plan.path.end)
    plan.situation.set_uav(Motion(101.0, 0.0, -250.0, 20.0, 0.0))
    plan.situation.set_helicopter(Motion(101.0, 10.0, 0.0, 20.0, 0.0))
    plan.update(101.0)
    plan.situation.set_helicopter(Motion(150.0, 80.0, 0.0, 0.0, 0.0))
    plan.situation.set_uav(Motion(150.0, end.x_m, end.y_m - 5.0, 0.0, -20.0))
    assert plan.update(150.0).points[:2, 0] == pytest.approx([-170.0] * 2, abs=1e-6)
    plan.set_leg(leg(95.0))
    assert plan.update(150.1) is None


def test_a_second_corner_waits_for_the_first():
    plan = on_leg(1200.0)
    plan.update(100.0)
    plan.situation.set_corner(corner(100.0))
    plan.update(100.0)
    first = plan.active
    plan.situation.set_helicopter(Motion(136.0, 80.0, -400.0, 0.0, -20.0))
    plan.situation.set_uav(Motion(136.0, -480.0, -250.0, 20.0, 0.0))
    second = replace(corner(134.0, time_s=136.0), stop=Pose(80.0, -500.0, -math.pi / 2))
    plan.situation.set_corner(second)
    assert plan.update(136.0) is None
    assert plan.active.k == 1
    assert plan.active.path == first.path
    assert plan.situation.corners_seen == 2


def test_release_from_guided_to_anything_but_auto():
    plan = on_leg(0.0)
    plan.status = UavStatus("GUIDED", armed=True, connected=True)
    plan._in_auto = False
    plan.set_status(UavStatus("RTL", armed=True, connected=True))
    assert plan.mode is Mode.IDLE


def test_clock_set_back_forgets_the_future():
    plan = on_leg(300.0, time_s=5000.0)
    plan.update(5000.0)
    plan.situation.set_corner(corner(5000.0))
    plan.update(5000.0)
    plan.set_clock_back()
    assert plan.active is None
    seen = plan.situation.corners_seen
    plan.situation.set_corner(corner(100.0))
    assert plan.situation.corners_seen == seen + 1


def test_nonsense_in_flight_is_told_and_survived():
    plan = on_leg(300.0)
    plan.update(100.0)
    plan.set_leg(replace(leg(101.0), foot=Pose(math.nan, 0.0, 0.0)))
    assert plan.update(100.1) is None
    tight = MissionPlanner(CornerParameters(spacing_m=105.0), MissionParameters(rules="paper"))
    tight.set_status(FLYING)
    tight.situation.set_helicopter(Motion(100.0, 0.0, 0.0, 20.0, 0.0))
    tight.situation.set_uav(Motion(100.0, -250.0, -105.0, 20.0, 0.0))
    tight.situation.set_phase(Phase.CRUISE)
    tight.set_leg(leg(100.0))
    assert tight.engage(100.0) == ""
    tight.situation.set_corner(corner(100.0, accel=5.0, speed=17.5))
    tight.update(100.0)


EVENTS = ("leg", "corner", "refine", "phase", "uav", "engage", "disengage", "human", "back", "wait")


def can_be_told(component, now):
    for topic, value in [*component.report(now), (topics.DIAGNOSTICS, component.health(now))]:
        WIRES[topic].to_message(value, now)


@pytest.mark.parametrize("rules", ["paper", "deadbeat"])
@settings(max_examples=60, deadline=None)
@given(events=st.lists(st.tuples(st.sampled_from(EVENTS), st.integers(0, 1000)), max_size=60))
def test_any_order_of_events_keeps_the_planner_sound(rules, events):  # noqa: C901, PLR0912
    """Every mode meets every event: nothing raises, and lists are finite, numbered, and ahead."""
    plan = on_leg(200.0, rules=rules)
    told = PlannerComponent(CornerParameters(), MissionParameters())
    told.planner = plan
    now, number = 100.0, 0
    for event, value in events:
        now += 0.3
        share = value / 1000.0
        if event == "leg":
            plan.set_leg(leg(now, heading=math.pi * (share - 0.5)))
        elif event == "corner":
            plan.situation.set_corner(corner(now - 3.0, time_s=now, stop_x=1000.0 * share))
        elif event == "refine" and plan.active is not None:
            plan.situation.set_corner(replace(plan.active.estimate, time_s=now))
        elif event == "phase":
            plan.situation.set_phase(list(Phase)[value % len(Phase)])
        elif event == "uav":
            plan.situation.set_uav(Motion(now, 900.0 * share, -250.0 * share, 20.0 * share, -15.0))
        elif event == "engage":
            plan.engage(now)
        elif event == "disengage":
            plan.disengage()
        elif event == "human":
            plan.set_status(UavStatus("MANUAL", armed=True, connected=True))
        elif event == "back":
            plan.set_status(FLYING)
        plan.situation.set_helicopter(Motion(now, 6.0, 0.0, 20.0, 0.0))
        listed = plan.update(now)
        if listed is not None and plan.active is not None:
            (_, record), _ = corner_outputs(plan.active, listed)
            assert record.k == plan.active.k
        can_be_told(told, now)
        if plan.engaged:
            assert (plan.mode is Mode.CORNER) == (plan.active is not None)
        assert plan.speed_mps is None or 10.0 < plan.speed_mps < 30.0
        if listed is not None:
            assert plan.mode is not Mode.IDLE
            assert listed.number == number + 1
            assert len(listed.points) >= 1
            assert np.isfinite(listed.points).all()
            number = listed.number


def test_another_slot_is_taken_and_led_to():
    plan = on_leg(0.0, rules="deadbeat")
    assert plan.update(100.0).mode == "leg"
    assert plan.change_slot(Slot("inside", 2)) == ""
    changed = plan.update(101.0)
    assert changed.mode == "rejoin"
    assert changed.points[-2, 1] == pytest.approx(-500.0, abs=1.0)
    assert plan.parameters.slot == Slot("inside", 2)


def test_a_slot_that_cannot_be_is_refused_and_nothing_changes():
    plan = on_leg(0.0, rules="deadbeat")
    before = plan.parameters
    assert "slot_tracks" in plan.change_slot(Slot("inside", 7))
    assert "slot_side" in plan.change_slot(Slot("above"))
    assert plan.parameters is before
    paper = on_leg(0.0, rules="paper")
    assert "expected inside, with rules paper" in paper.change_slot(Slot("outside"))
