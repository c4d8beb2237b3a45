"""The helicopter's motion to come."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.prediction.forecast import cornering, cruising, departing


@given(st.floats(10.0, 35.0), st.floats(0.8, 5.0), st.floats(0.0, 30.0), st.floats(-3.0, 3.0))
def test_corner_is_continuous_and_loses_three_stopping_distances(speed, accel, hover, heading):
    stop = Pose(100.0, -50.0, heading)
    forecast = cornering(7.0, stop, speed_mps=speed, accel_mps2=accel, hover_s=hover)
    times = np.arange(0.0, 120.0, 0.01)
    steps = np.hypot(*np.diff(forecast.positions(times), axis=0).T)
    assert steps.max() <= speed * 0.01 + 1e-9
    stopping = speed**2 / (2.0 * accel)
    # The common finish line: T_h = 3 V / 2 a + hover + Y / V.
    late = forecast.steady_s + 50.0
    x, y = forecast.positions([late])[0]
    out = Pose(stop.x_m, stop.y_m, heading - math.pi / 2)
    along = out.along(float(x), float(y))
    assert along == pytest.approx(speed * (late - 7.0 - hover) - 3.0 * stopping)
    assert forecast.along_m(late) == pytest.approx(along)
    assert out.across(float(x), float(y)) == pytest.approx(0.0, abs=1e-6)


def test_departure_and_cruise_agree_in_the_end():
    leg = Pose(0.0, 0.0, 0.5)
    forecast = departing(3.0, leg, 8.0, speed_mps=20.0, accel_mps2=2.0)
    assert forecast.steady_s == pytest.approx(9.0)
    x, y = forecast.positions([9.0])[0]
    assert leg.along(float(x), float(y)) == pytest.approx(84.0)
    assert forecast.along_m(9.0) == pytest.approx(84.0)
    assert cruising(1.0, leg, 20.0).along_m(3.0) == pytest.approx(40.0)


@given(st.floats(-3.0, 3.0), st.sampled_from([1, -1]))
def test_in_a_frame_it_is_the_same_motion(heading, side):
    frame = CornerFrame(Pose(10.0, 20.0, heading), side)
    forecast = cornering(0.0, Pose(5.0, -7.0, 1.0), speed_mps=20.0, accel_mps2=2.5)
    times = np.array([-2.0, 3.0, 9.0, 30.0])
    moved = forecast.in_frame(frame).positions(times)
    for (x, y), point in zip(forecast.positions(times), moved, strict=True):
        there = frame.to_frame(Pose(float(x), float(y), 0.0))
        assert (there.x_m, there.y_m) == pytest.approx(tuple(point), abs=1e-6)
