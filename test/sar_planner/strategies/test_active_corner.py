"""A corner as it was measured: its lag at the onset, and whether rules are for it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, Motion
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.strategies.active_corner import measured, unusable

P, M = CornerParameters(), MissionParameters()


def estimate(speed=20.0, accel=2.5):
    stop = Pose(0.0, 0.0, 0.0)
    return CornerEstimate(
        104.0, stop, 100.0 + speed / accel, speed, accel, np.zeros((2, 2)), 0.0, 0.0
    )


@given(st.floats(-300.0, 800.0), st.floats(0.0, 8.0), st.floats(15.0, 24.0))
def test_the_lag_is_that_of_the_onset_however_late_it_is_measured(lag, late_s, uav_mps):
    """At the onset the helicopter is s before its stop, the UAV L behind it."""
    corner = estimate()
    x = -P.stopping_m - lag + uav_mps * late_s
    uav = Motion(corner.onset_time_s + late_s, x, -250.0, uav_mps, 0.0)
    parameters, found = measured(corner, CornerFrame(corner.stop, 1), uav, P)
    assert found == pytest.approx(lag, abs=1e-6)
    assert parameters == P


@pytest.mark.parametrize(
    ("speed", "accel", "reason"),
    [
        (20.0, 2.5, ""),
        (15.0, 1.0, ""),
        (25.0, 150.0, ""),
        (14.9, 2.5, "helicopter's speed 14.90: the rules expect 15.00 ... 25.00"),
        (25.1, 2.5, "helicopter's speed 25.10: the rules expect 15.00 ... 25.00"),
        (20.0, 0.99, "helicopter's deceleration 0.99: the rules expect 1.00 ... 150.00"),
    ],
)
def test_rules_are_for_speeds_and_decelerations_within_limits(speed, accel, reason):
    assert unusable(estimate(speed, accel), 20.0, 2.5, M) == reason
