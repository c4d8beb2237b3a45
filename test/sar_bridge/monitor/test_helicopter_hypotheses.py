"""The monitor's hypotheses about the helicopter."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.monitor.helicopter_hypotheses import FASTER, Helicopter
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_sim.scenario.scenario import Pattern, Pilot
from sar_sim.world.helicopter import PatternHelicopter

TIMES = np.arange(0.0, 40.0, 0.5)
HABITS = HelicopterModel(20.0, 2.0, 1)


def pattern(side=1, kind="expanding_square"):
    return PatternHelicopter(
        Pattern(kind=kind, first_leg_m=800.0, corners=2, turn_side=side), Pilot(), 20.0, 2.0
    )


def corner_of(truth, told_s):
    return CornerEstimate(
        told_s, truth.stop, truth.stop_time_s, 20.0, 2.0, np.zeros((2, 2)), 0.0, 0.0
    )


def told(truth, now_s, phase, corner=None, model=HABITS):
    helicopter = Helicopter(model)
    helicopter.phase, helicopter.corner = phase, corner
    helicopter.set_motion(truth.motion(now_s))
    return {future.name: future for future in helicopter.futures(now_s, TIMES)}


def positions(truth, now_s):
    motions = [truth.motion(now_s + t) for t in TIMES]
    return np.array([(motion.x_m, motion.y_m) for motion in motions])


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("kind", "turn_deg"), [("expanding_square", 90.0), ("sector", 120.0)])
@pytest.mark.parametrize(
    ("after_onset_s", "phase", "name"),
    [
        (4.0, Phase.DECELERATING, "turns inside"),
        (11.0, Phase.STOPPED, "leaves inside"),
        (14.0, Phase.ACCELERATING, "speeds up"),
        (19.0, Phase.ACCELERATING, "speeds up"),
    ],
)
def test_the_likely_one_is_what_a_helicopter_on_the_pattern_does(
    side, after_onset_s, phase, name, kind, turn_deg
):
    truth = pattern(side, kind)
    first = truth.corners[0]
    now = first.onset_time_s + after_onset_s
    model = HelicopterModel(20.0, 2.0, side, turn_deg)
    found = told(truth, now, phase, corner_of(first, now), model)
    assert found[name].likely
    ahead = TIMES < 25.0
    assert found[name].positions[ahead] == pytest.approx(positions(truth, now)[ahead], abs=1.0)


def test_on_a_leg_it_goes_on_or_stops():
    found = told(pattern(), 10.0, Phase.CRUISE)
    assert [name for name, future in found.items() if future.likely] == ["goes on", "stops"]
    assert found["goes on"].positions[20] == pytest.approx((0.0, 400.0), abs=1e-6)
    assert found["stops"].positions[-1] == pytest.approx((0.0, 300.0), abs=1e-6)
    assert found["stops and turns inside"].positions[-1][0] > 200.0
    assert found["stops and turns outside"].positions[-1][0] < -200.0


def test_a_leg_that_is_known_better_than_the_odometry_is_believed():
    helicopter = Helicopter(HABITS)
    helicopter.phase = Phase.CRUISE
    helicopter.set_motion(Motion(50.0, 0.0, 0.0, 19.0, 5.0), 3.0, 3.0)
    helicopter.set_leg(LegEstimate(45.0, Pose(0.0, 0.0, 0.0), 20.0, 1.0, 0.005, 0.1))
    (onward, *_) = helicopter.futures(50.0, TIMES)
    assert onward.positions[40] == pytest.approx((400.0, 0.0), abs=1e-6)
    assert onward.sigma_m[40] < 5.0
    helicopter.set_leg(LegEstimate(30.0, Pose(0.0, 0.0, 0.0), 20.0, 1.0, 0.005, 0.1))
    (onward, *_) = helicopter.futures(50.0, TIMES)
    assert onward.positions[40] == pytest.approx((380.0, 100.0), abs=1e-6)


def test_a_noisy_course_after_a_corner_is_weighed_against_the_right_angle():
    truth = pattern()
    helicopter = Helicopter(HABITS)
    helicopter.phase, helicopter.corner = Phase.CRUISE, corner_of(truth.corners[0], 60.0)
    helicopter.set_motion(Motion(70.0, 200.0, 800.0, 19.0, 6.0), 3.0, 3.0)
    (onward, *_) = helicopter.futures(70.0, TIMES)
    course = math.atan2(*(onward.positions[40] - onward.positions[0])[::-1])
    assert abs(course) < math.radians(4.0)
    helicopter.set_motion(Motion(70.0, 200.0, 800.0, 10.0, 17.0), 2.0, 0.5)  # 60 deg, and sure
    (onward, *_) = helicopter.futures(70.0, TIMES)
    assert (onward.positions[2] - onward.positions[0]) == pytest.approx((10.0, 17.0), abs=1e-6)


def test_a_helicopter_that_leaves_another_way_is_followed():
    truth = pattern()
    stop = truth.corners[0].stop
    helicopter = Helicopter(HABITS)
    helicopter.phase, helicopter.corner = Phase.ACCELERATING, corner_of(truth.corners[0], 60.0)
    west = Motion(70.0, stop.x_m - 60.0, stop.y_m, -15.0, 0.0)
    helicopter.set_motion(west, 3.0, 1.0)
    (onward, *_) = helicopter.futures(70.0, TIMES)
    assert onward.positions[-1][0] < stop.x_m - 600.0


def test_one_that_departs_faster_than_it_flew_before_may_go_on_so():
    truth = pattern()
    stop = truth.corners[0].stop
    for speed, faster in ((20.0, False), (22.0, False), (24.0, True)):
        helicopter = Helicopter(HABITS)
        helicopter.phase, helicopter.corner = Phase.ACCELERATING, corner_of(truth.corners[0], 60.0)
        helicopter.set_motion(Motion(70.0, stop.x_m + 150.0, stop.y_m, speed, 0.0), 3.0, 3.0)
        found = {future.name: future for future in helicopter.futures(70.0, TIMES)}
        assert ("departs faster" in found) is faster
    assert not found["departs faster"].likely
    assert found["departs faster"].positions[-1, 0] > found["speeds up"].positions[-1, 0] + 100.0


@pytest.mark.parametrize(("away_m", "leaves"), [(5.0, False), (60.0, True)])
def test_one_that_is_said_to_stand_and_is_away_from_its_stop_is_leaving(away_m, leaves):
    first = pattern().corners[0]
    now = first.stop_time_s + 4.0
    helicopter = Helicopter(HABITS)
    helicopter.phase = Phase.STOPPED
    helicopter.corner = corner_of(first, first.stop_time_s + 1.0)
    speed = math.sqrt(2.0 * 3.4 * away_m)
    west = Motion(now, first.stop.x_m - away_m, first.stop.y_m, -speed, 0.0)
    helicopter.set_motion(west, 3.0, 1.0)
    found = {future.name: future for future in helicopter.futures(now, TIMES)}
    assert {"stands", "leaves inside", "leaves outside"} <= set(found)
    assert "leaves straight on" not in found  # it is seen to go elsewhere
    assert ("speeds up" in found) is leaves
    if leaves:
        assert found["speeds up"].positions[20, 0] < west.x_m - 190.0


def test_a_helicopter_that_should_have_stopped_already_leaves_from_where_it_should():
    """Its own course means nothing by then, and the phase is told a little late."""
    first = pattern().corners[0]
    helicopter = Helicopter(HABITS)
    helicopter.phase = Phase.DECELERATING
    helicopter.corner = corner_of(first, first.stop_time_s + 1.0)
    helicopter.set_motion(Motion(80.0, first.stop.x_m + 4.0, first.stop.y_m, -5.0, -4.0), 3.0, 3.0)
    (turning, *_) = helicopter.futures(first.stop_time_s + 2.0, TIMES)
    assert turning.name == "turns inside"
    assert turning.positions[0] == pytest.approx((first.stop.x_m, first.stop.y_m), abs=1e-6)
    assert turning.positions[40] == pytest.approx(
        (first.stop.x_m + 300.0, first.stop.y_m), abs=1e-6
    )


def test_the_corner_before_is_not_taken_for_this_one():
    first = pattern().corners[0]
    helicopter = Helicopter(HABITS)
    helicopter.phase, helicopter.corner = Phase.DECELERATING, corner_of(first, first.stop_time_s)
    helicopter.set_motion(Motion(200.0, 900.0, 800.0, 20.0, 0.0))
    (turning, *_) = helicopter.futures(200.0, TIMES)
    assert turning.positions[20] == pytest.approx((1000.0, 800.0), abs=1e-6)
    assert turning.positions[60] == pytest.approx((1000.0, 500.0), abs=1e-6)


def test_nothing_is_known_of_a_helicopter_never_seen():
    assert Helicopter(HABITS).futures(0.0, TIMES) == []
    helicopter = Helicopter(HABITS)
    helicopter.set_motion(Motion(0.0, math.nan, 0.0, 0.0, 0.0))
    assert helicopter.motion is None


@given(
    st.sampled_from(list(Phase)),
    st.floats(-40.0, 40.0),
    st.floats(-40.0, 40.0),
    st.floats(0.0, 10.0),
    st.booleans(),
)
def test_any_state_gives_finite_futures_one_of_them_likely(phase, vx, vy, sigma, cornering):
    helicopter = Helicopter(HABITS)
    helicopter.phase = phase
    if cornering:
        helicopter.corner = corner_of(pattern().corners[0], 60.0)
    helicopter.set_motion(Motion(60.0, 50.0, 700.0, vx, vy), sigma, sigma)
    futures = helicopter.futures(62.0, TIMES)
    assert any(future.likely for future in futures)
    for future in futures:
        assert future.positions.shape == (len(TIMES), 2)
        assert np.isfinite(future.positions).all()
        assert (np.isfinite(future.sigma_m) & (future.sigma_m >= 0.0)).all()
        cruise = 20.0 * (FASTER if future.name == "departs faster" else 1.0)
        fastest = max(np.hypot(vx, vy), cruise)
        assert np.hypot(*np.diff(future.positions, axis=0).T).max() <= 0.5 * fastest + 1e-6


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("lost_at_s", [-12.0, -6.0, 0.0, 6.0, 11.0])
@pytest.mark.parametrize("for_s", [10.0, 16.0, 30.0])
def test_lost_it_may_have_turned_unseen(side, lost_at_s, for_s):
    """Around a corner, seconds from its onset: one hypothesis is where it really is."""
    truth = pattern(side)
    first = truth.corners[0]
    seen_s = first.onset_time_s + lost_at_s
    helicopter = Helicopter(HelicopterModel(20.0, 2.0, side))
    if lost_at_s >= 0.0:
        helicopter.phase = Phase.DECELERATING if lost_at_s < 10.0 else Phase.STOPPED
        helicopter.corner = corner_of(first, seen_s)
    else:
        helicopter.phase = Phase.CRUISE
    known = truth.motion(seen_s)
    helicopter.set_motion(known)
    helicopter.phase = Phase.LOST
    now_s = seen_s + for_s
    gone_on = known.after(for_s)
    helicopter.set_motion(gone_on._replace(time_s=now_s))
    futures = helicopter.futures(now_s, TIMES)
    near = [
        np.hypot(*(future.positions - positions(truth, now_s)).T)[TIMES < 15.0].max()
        for future in futures
    ]
    assert min(near) < 60.0
    assert [future.name for future in futures if future.likely] == ["goes on", "stops"]


def test_a_helicopter_never_seen_has_done_nothing_unseen():
    helicopter = Helicopter(HABITS)
    helicopter.set_motion(Motion(0.0, 0.0, 0.0, 20.0, 0.0))
    assert len(helicopter.futures(20.0, TIMES)) == 4


def hovering(seconds, **last):
    """Return one that has stood for so long, with its newest motion changed."""
    helicopter = Helicopter(HABITS)
    for second in range(round(seconds) + 1):
        helicopter.set_motion(Motion(float(second), 5.0, 0.0, 0.2, 0.1), 2.0, 0.2)
        helicopter.set_phase(Phase.STOPPED)
    if last:
        motion = Motion(float(second) + 1.0, 5.0, 0.0, 0.2, 0.1)._replace(**last)
        helicopter.set_motion(motion, 2.0, 0.2)
    return {one.name: one for one in helicopter.futures(helicopter.motion.time_s, TIMES)}


def test_one_that_hovers_is_expected_to_stand_and_may_leave_from_where_it_is():
    in_a_corner, hovers = hovering(5.0), hovering(12.0)
    assert in_a_corner["leaves inside"].likely
    assert not hovers["leaves inside"].likely
    assert hovers["stands"].likely
    assert hovers["leaves inside"].positions[0] == pytest.approx((5.0, 0.0), abs=0.1)
    assert {"leaves inside", "leaves outside", "leaves straight on"} <= hovers.keys()


def test_one_that_hovered_and_is_seen_to_leave_goes_where_it_goes():
    leaving = hovering(12.0, vx_mps=0.0, vy_mps=6.0)
    assert leaving["leaves"].likely
    assert leaving["leaves"].positions[-1] == pytest.approx((5.0, 731.0), abs=40.0)
    assert "stops again" in leaving


@pytest.mark.parametrize("phase", [Phase.STOPPED, Phase.DECELERATING])
@pytest.mark.parametrize(
    ("course_deg", "speed", "sigma", "outside", "onward"),
    [
        (0.0, 2.0, 0.1, True, True),  # too slow to tell
        (0.0, 5.0, 2.0, True, True),  # not sure
        (0.0, 5.0, 0.1, False, False),  # inside, to the right
        (90.0, 5.0, 0.1, False, True),  # straight on
        (180.0, 5.0, 0.1, True, False),  # outside
        (45.0, 5.0, 0.1, False, True),  # neither yet
    ],
)
def test_who_is_seen_to_leave_a_corner_does_not_leave_it_another_way(
    phase, course_deg, speed, sigma, outside, onward
):
    """The leg led north, and the pattern turns right."""
    first = pattern().corners[0]
    now = first.stop_time_s + 2.0
    helicopter = Helicopter(HABITS)
    helicopter.phase = phase
    helicopter.corner = corner_of(first, first.stop_time_s + 1.0)
    course = math.radians(course_deg)
    velocity = speed * math.cos(course), speed * math.sin(course)
    helicopter.set_motion(Motion(now, first.stop.x_m, first.stop.y_m, *velocity), 3.0, sigma)
    found = {future.name for future in helicopter.futures(now, TIMES)}
    assert bool({"leaves outside", "turns outside"} & found) is outside
    assert bool({"leaves straight on", "goes on"} & found) is onward
    assert found & {"leaves inside", "turns inside"}


@pytest.mark.parametrize("phase", list(Phase))
@pytest.mark.parametrize("after_s", [2.0, 6.0, 11.0, 19.0])
def test_no_future_bends_more_than_it_says(phase, after_s):
    """Else what is taken off between two times would be too little."""
    truth = pattern()
    first = truth.corners[0]
    now = first.onset_time_s + after_s
    corner = replace(corner_of(first, now), accel_mps2=3.5)
    step = 0.05
    helicopter = Helicopter(HABITS)
    helicopter.phase, helicopter.corner = Phase.CRUISE, corner
    helicopter.set_motion(truth.motion(now))
    helicopter.phase = phase
    for future in helicopter.futures(now, np.arange(0.0, 40.0, step)):
        bent = np.hypot(*np.diff(future.positions, n=2, axis=0).T) / step**2
        assert 2.0 <= future.most_mps2 <= 3.5
        assert bent.max() <= future.most_mps2 + 1e-6, future.name
