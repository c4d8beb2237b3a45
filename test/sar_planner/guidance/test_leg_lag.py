"""The lag that a leg in wind is begun with, against the leg flown out."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_planner.guidance.leg_lag import GUST_SIGMAS, drift_m
from sar_planner.guidance.steady_wind import SteadyWind
from sar_planner.guidance.wind_triangle import AirEnvelope


def envelope(speed_mps, to_rad, slowest=10.0, fastest=30.0, gusts_mps=0.0):
    wind = speed_mps * math.cos(to_rad), speed_mps * math.sin(to_rad)
    return AirEnvelope(slowest, fastest, wind, SteadyWind(0.0, wind, gusts_mps))


@given(
    st.floats(0.0, 15.0),
    st.floats(-math.pi, math.pi),
    st.sampled_from([(10.0, 30.0), (14.0, 28.0), (18.0, 22.0)]),
    st.floats(500.0, 4000.0),
)
def test_begun_so_no_lag_is_left_at_the_legs_end(wind_mps, to_rad, airspeeds, leg_m):
    """Flown as near to the helicopter's speed as the airspeeds allow."""
    air = envelope(wind_mps, to_rad, *airspeeds)
    slowest, fastest = air.on_course_mps(0.0)
    lag_m = drift_m(air, 0.0, 20.0, leg_m)
    flown_mps = min(max(20.0, slowest), fastest)
    assert lag_m + (20.0 - flown_mps) * leg_m / 20.0 == pytest.approx(0.0, abs=1e-6)


def test_gusts_are_kept_in_hand():
    """Against 10 m/s and its gusts a UAV that flies 30 m/s at most is begun ahead."""
    against = envelope(10.0, math.pi, gusts_mps=1.5)
    assert drift_m(against, 0.0, 20.0, 2000.0) == pytest.approx(-100.0 * GUST_SIGMAS * 1.5)
    assert drift_m(against, math.pi, 20.0, 2000.0) == pytest.approx(100.0 * GUST_SIGMAS * 1.5)
    assert drift_m(against, 0.5 * math.pi, 20.0, 2000.0) == 0.0
    assert drift_m(envelope(6.0, math.pi, gusts_mps=1.0), 0.0, 20.0, 2000.0) == 0.0


def test_without_a_wind_that_is_known_none_is_asked_for():
    assert drift_m(AirEnvelope(10.0, 15.0), 0.0, 20.0, 2000.0) == 0.0
