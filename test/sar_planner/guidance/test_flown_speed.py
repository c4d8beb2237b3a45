"""What a UAV makes good along a path in wind, against closed forms and the simulated UAV."""

import math

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_planner.guidance.flown_speed import ACCEL_MPS2, airspeed_of, flown
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.paths.flight_path import Arc, FlightPath, Straight

EAST = FlightPath.of(Pose(0.0, 0.0, 0.0), (Straight(1000.0),))


def test_where_no_airspeeds_are_known_the_speed_wanted_is_flown():
    found = flown(EAST, 20.0, AirEnvelope(), 12.0, from_m=200.0)
    assert found.share == pytest.approx(1.0)
    assert found.times_s[-1] == pytest.approx(40.0)
    assert found.points_m[0] == pytest.approx((200.0, 0.0))
    assert found.points_m[-1] == pytest.approx((1000.0, 0.0))


@pytest.mark.parametrize(("wind_x", "made_good"), [(-12.0, 18.0), (12.0, 22.0), (-6.0, 20.0)])
def test_the_airspeeds_bound_what_is_made_good(wind_x, made_good):
    air = AirEnvelope(10.0, 30.0, (wind_x, 0.0))
    found = flown(EAST, 20.0, air, min(max(20.0 - wind_x, 10.0), 30.0))
    assert found.share == pytest.approx(made_good / 20.0, rel=1e-3)


def test_airspeed_is_a_state():
    """From 12 to 22 m/s takes 10 s: v^2 / 2a, and what is left at 22 m/s."""
    found = flown(EAST, 22.0, AirEnvelope(10.0, 30.0), 12.0)
    ramp_s = 10.0 / ACCEL_MPS2
    ramp_m = 17.0 * ramp_s
    assert found.times_s[-1] == pytest.approx(ramp_s + (1000.0 - ramp_m) / 22.0, rel=0.01)


def test_turning_into_the_wind_costs_what_the_airspeed_lags_behind():
    """From downwind to upwind the airspeed must rise by 20 m/s: some seconds slower, then."""
    turn = FlightPath.of(Pose(0.0, 0.0, 0.0), (Straight(200.0), Arc(100.0, math.pi)))
    air = AirEnvelope(5.0, 40.0, (10.0, 0.0))
    told_late = flown(turn, 20.0, air, 10.0)
    told_before = flown(turn, 20.0, air, 10.0, lead_s=5.0)
    assert told_late.share < told_before.share < 1.05
    assert told_late.share < 0.97
    assert np.all(np.diff(told_late.times_s) > 0.0)


def test_the_airspeed_of_a_motion():
    air = AirEnvelope(10.0, 30.0, (0.0, 8.0))
    assert airspeed_of(Motion(0.0, 0.0, 0.0, 15.0, 0.0), air) == pytest.approx(17.0)


def test_at_the_paths_end_nothing_is_left():
    assert flown(EAST, 20.0, AirEnvelope(10.0, 30.0), 20.0, from_m=1000.0).share == 1.0
