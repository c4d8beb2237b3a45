"""A path that is flown: its speed, its end on a slot that has moved, and what is left."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.paths.flight_path import Arc, CornerFrame, FlightPath, Straight
from sar_planner.prediction.forecast import cruising
from sar_planner.rejoin.tracked_path import TrackedPath, final_lag_m, is_on_track

FRAME = CornerFrame(Pose(0.0, 0.0, 0.0), 1)
PATH = FlightPath.of(Pose(-600.0, 0.0, 0.0), [Straight(600.0), Arc(100.0, 0.3), Arc(100.0, -0.3)])
LEG = cruising(0.0, Pose(0.0, 250.0, 0.0), 20.0)


@given(st.floats(0.0, 500.0), st.floats(17.0, 23.0))
def test_the_speed_is_that_which_takes_the_lag_out_within_its_limits(flown, now_s):
    tracked = TrackedPath(FRAME, PATH, 0.0, 20.0, flown)
    rest = PATH.cut(flown)
    timed = tracked.timed(rest, LEG, now_s, (18.0, 22.0))
    assert 18.0 <= timed.speed_mps <= 22.0
    lag = final_lag_m(rest, LEG, start_s=now_s, speed_mps=timed.speed_mps)
    if 18.0 < timed.speed_mps < 22.0:
        assert lag == pytest.approx(0.0, abs=1e-6)
    assert timed.begun_s + flown / timed.speed_mps == pytest.approx(now_s)


@pytest.mark.parametrize(
    ("shift_m", "turn_deg", "left_m", "missed"),
    [
        (0.0, 0.0, 0.0, False),
        (19.0, 0.0, 0.0, False),
        (21.0, 0.0, 0.0, True),
        (0.0, 3.9, 0.0, False),
        (0.0, 4.1, 0.0, True),
        (40.0, 0.0, 2000.0, False),  # 3 % of what is left
        (40.0, 0.0, 1000.0, True),
    ],
)
def test_a_slot_track_that_moves_is_missed_and_far_off_less_so(shift_m, turn_deg, left_m, missed):
    path = FlightPath.of(Pose(-600.0, 0.0, 0.0), [Straight(600.0)])
    moved = CornerFrame(Pose(0.0, shift_m, math.radians(turn_deg)), 1)
    assert TrackedPath(FRAME, path, 0.0, 20.0).misses(moved, left_m, 0.03) is missed


@given(st.floats(0.0, 600.0), st.floats(-30.0, 30.0))
def test_flown_on_beside_its_path_the_uav_stays_beside_it(ahead, beside):
    tracked = TrackedPath(FRAME, PATH, 0.0, 20.0)
    uav = PATH.start.offset(0.0, beside)
    there = tracked.carried_on(uav, ahead)
    on_path = PATH.pose_at(ahead)
    if ahead <= 600.0:
        assert on_path.across(there.x_m, there.y_m) == pytest.approx(beside, abs=1e-6)
        assert there.heading_rad == pytest.approx(on_path.heading_rad)


@pytest.mark.parametrize(
    ("pose", "on_track"),
    [
        (Pose(0.0, 0.0, 0.0), True),
        (Pose(900.0, -39.0, math.radians(24.0)), True),
        (Pose(0.0, 41.0, 0.0), False),
        (Pose(0.0, 0.0, math.radians(-26.0)), False),
    ],
)
def test_on_the_track_is_near_it_and_along_it(pose, on_track):
    assert is_on_track(pose) is on_track


def test_a_path_is_flown_when_its_end_is_reached():
    length = PATH.length_m
    assert not TrackedPath(FRAME, PATH, 0.0, 20.0, length - 2.0).is_flown
    assert TrackedPath(FRAME, PATH, 0.0, 20.0, length - 0.5).is_flown
