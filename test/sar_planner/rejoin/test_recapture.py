"""A path being flown: progress, its row, and corrections."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.paths.flight_path import Arc, CornerFrame, FlightPath, Straight
from sar_planner.paths.slot_intercept import PathBatch, row_of
from sar_planner.prediction.forecast import cornering, cruising
from sar_planner.prediction.separation import closest_over_time
from sar_planner.rejoin.recapture import Recapture
from sar_planner.rejoin.tracked_path import TrackedPath, final_lag_m, total_turn_rad

FRAME = CornerFrame(Pose(0.0, 0.0, 0.0), 1)
LEG = cruising(0.0, Pose(0.0, 250.0, 0.0), 20.0)


@given(st.lists(st.floats(-2.0, 2.0).filter(lambda v: abs(v) > 0.01), min_size=4, max_size=4))
def test_row_of_a_batch_path_is_that_row(turns):
    row = np.array([30.0, turns[0], 40.0, turns[1], 50.0, turns[2], turns[3]])
    path = PathBatch(Pose(0.0, 0.0, 0.3), 100.0, row[None, :]).path(0)
    assert row_of(path) == pytest.approx(row)
    assert total_turn_rad(path) == pytest.approx(sum(abs(turn) for turn in turns))
    rest = path.cut(0.4 * path.length_m)
    assert rest.end.x_m == pytest.approx(path.end.x_m, abs=1e-6)
    whole = path.cut(0.0, 0.4 * path.length_m).then(rest)
    assert whole.length_m == pytest.approx(path.length_m)
    assert len(whole.segments) == len(path.segments) - (turns[2] * turns[3] > 0.0)


def test_path_of_another_shape_has_no_row():
    path = FlightPath.of(Pose(0, 0, 0), [Arc(100, 1.0)] * 1 + [Straight(9), Arc(100, 1)] * 4)
    assert row_of(path) is None


def test_progress_follows_the_uav_and_does_not_jump_where_the_path_crosses_itself():
    path = FlightPath.of(Pose(0, 0, 0), [Straight(300.0), Arc(100.0, 1.9 * math.pi), Straight(300)])
    approach = TrackedPath(FRAME, path, 0.0, 20.0)
    for flown in np.arange(0.0, path.length_m, 13.0):
        pose = path.pose_at(float(flown))
        beside = pose.offset(0.0, 6.0)
        approach = approach.followed(beside, 13.0)
        assert approach.flown_m == pytest.approx(flown, abs=10.0)


def test_final_lag_is_that_of_the_slot():
    path = FlightPath.of(Pose(-100.0, 0.0, 0.0), [Straight(400.0)])
    assert final_lag_m(path, LEG, start_s=0.0, speed_mps=20.0) == pytest.approx(100.0)
    assert final_lag_m(path, LEG, start_s=0.0, speed_mps=25.0) == pytest.approx(20.0)


def search(start, forecast, **changes):
    values = {
        "start": start,
        "start_s": 10.0,
        "forecasts": (forecast,),
        "turn_radius_m": 100.0,
        "speed_mps": 20.0,
        "separation_m": 200.0,
        "longest_m": 2500.0,
    }
    return Recapture(**(values | changes))


@settings(max_examples=30, deadline=None)
@given(st.floats(-60.0, 200.0), st.floats(-0.3, 0.3), st.floats(0.8, 1.0))
def test_correction_in_the_corner_meets_the_slot_and_stays_apart(along, off, share):
    """From about where the UAV turns at L = 0, in the frame of the new slot track."""
    stop = Pose(0.0, 250.0, math.pi / 2)
    forecast = cornering(0.0, stop, speed_mps=20.0, accel_mps2=2.5)
    task = search(Pose(along + 250.0, 150.0, math.pi / 2 + off), forecast, speed_mps=20.0 * share)
    path = task.best(None, 230.0, 200.0)
    if path is None:
        widest, apart = task.widest()
        assert apart <= 200.0
        path = widest
    else:
        nearest = closest_over_time(path, forecast, start_s=10.0, speed_mps=20.0 * share)
        assert nearest.distance_m >= 200.0 - 1e-6
    assert path.end.y_m == pytest.approx(0.0, abs=1e-4)
    assert math.cos(path.end.heading_rad) == pytest.approx(1.0)


def test_turns_are_about_kept_where_they_do():
    stop = Pose(0.0, 250.0, math.pi / 2)
    forecast = cornering(0.0, stop, speed_mps=20.0, accel_mps2=2.5)
    task = search(Pose(250.0, 100.0, math.pi / 2), forecast)
    path = task.best(None, 200.0, 200.0)
    again = task.best(row_of(path), 200.0, 200.0)
    assert again.length_m <= path.length_m + 0.5
    # The same, or a little different where that is shorter.
    assert row_of(again)[[1, 3]] == pytest.approx(row_of(path)[[1, 3]], abs=math.radians(8.1))
    lag = final_lag_m(path, forecast, start_s=10.0, speed_mps=20.0)
    assert lag == pytest.approx(0.0, abs=1e-3)


def test_a_uav_beside_its_path_is_carried_on_as_the_path_goes():
    path = FlightPath.of(Pose(0.0, 0.0, 0.0), (Straight(100.0), Arc(100.0, math.pi / 2)))
    frame = CornerFrame(Pose(0.0, 0.0, 0.0), 1)
    approach = TrackedPath(frame, path, 0.0, 20.0, flown_m=90.0)
    exact = approach.carried_on(path.pose_at(90.0), 150.0)
    there = path.pose_at(150.0)
    assert (exact.x_m, exact.y_m) == pytest.approx((there.x_m, there.y_m))
    beside = approach.carried_on(Pose(90.0, 5.0, 0.2), 150.0)
    assert beside.heading_rad == pytest.approx(there.heading_rad + 0.2)
    far = math.hypot(there.x_m - 90.0, there.y_m)
    assert math.hypot(beside.x_m - 90.0, beside.y_m - 5.0) == pytest.approx(far)
    end = approach.carried_on(path.pose_at(90.0), 1e6)
    assert (end.x_m, end.y_m) == pytest.approx((path.end.x_m, path.end.y_m))
