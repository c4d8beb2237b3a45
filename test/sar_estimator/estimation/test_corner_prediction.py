"""Stops that are predicted: on the leg's line, and as costly as the corner is."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import LegEstimate, Motion
from sar_estimator.estimation.corner_prediction import Stop, predicted_corner, rolled_stop

LEG = LegEstimate(100.0, Pose(0.0, 0.0, 0.0), 20.0, 1.5, 0.01, 0.2)


@pytest.mark.parametrize("v", [12.0, 16.0, 20.0])
@pytest.mark.parametrize("turned_deg", [20.0, 45.0, 80.0])
def test_a_rolled_corner_costs_as_much_as_the_stop_that_it_is_told_as(v, turned_deg):
    """A quarter of a circle of radius r, flown at v from (200 - r, 0) on."""
    radius, turn = v**2 / 3.0, math.radians(turned_deg)
    begun_s = 100.0 + (200.0 - radius) / 20.0
    now_s = begun_s + radius * turn / v
    x, y = 200.0 - radius + radius * math.sin(turn), -radius * (1.0 - math.cos(turn))
    motion = Motion(now_s, x, y, v * math.cos(turn), -v * math.sin(turn))
    stop = rolled_stop(LEG, motion, -3.0, accel_mps2=2.5, slowest_mps=5.0)
    assert (stop.pose.x_m, stop.pose.y_m) == pytest.approx((200.0, 0.0), abs=1e-6)
    # Both ways end at the same place and time at 20 m/s, some 300 m down the new leg.
    after_s = begun_s + 0.5 * math.pi * radius / v
    ramp_s = (20.0 - v) / 2.5
    ramp_m = 0.5 * (20.0 + v) * ramp_s
    rolled_s = after_s + ramp_s + (300.0 - radius - ramp_m) / 20.0
    back_s = 20.0 / stop.accel_mps2
    stopped_s = stop.time_s + back_s + (300.0 - 0.5 * 20.0 * back_s) / 20.0
    if stop.accel_mps2 < 20.0**2 / (2.0 * 3.0) - 1e-6:  # the least stop is 3 m long
        assert stopped_s == pytest.approx(rolled_s, abs=1e-6)
    else:
        assert stopped_s >= rolled_s - 1e-6


@given(
    st.floats(-math.pi, math.pi), st.floats(1.0, 30.0), st.floats(0.1, 8.0), st.floats(0.0, 30.0)
)
def test_the_covariance_is_along_and_across_the_leg(heading, along_sigma, position_sigma, ahead_s):
    leg = LegEstimate(100.0, Pose(0.0, 0.0, heading), 20.0, position_sigma, 0.01, 0.2)
    pose = Pose(10.0, 20.0, heading)
    stop = Stop(pose, 100.0 + ahead_s, 20.0, 2.5, along_sigma, 0.5)
    corner = predicted_corner(leg, 104.0, stop)
    forward = np.array([math.cos(heading), math.sin(heading)])
    left = np.array([-forward[1], forward[0]])
    assert forward @ corner.covariance @ forward == pytest.approx(along_sigma**2, rel=1e-6)
    across = math.hypot(position_sigma, 0.2 * ahead_s)
    assert left @ corner.covariance @ left == pytest.approx(across**2, rel=1e-6)
    assert (corner.stop, corner.stop_time_s) == (pose, stop.time_s)
