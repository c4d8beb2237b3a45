"""The wind triangle."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_planner.guidance.wind_triangle import AirEnvelope


@given(st.floats(-math.pi, math.pi), st.floats(-12.0, 12.0), st.floats(-12.0, 12.0))
def test_airspeed_and_ground_speed_belong_together(course, wx, wy):
    air = AirEnvelope(0.0, 60.0, (wx, wy))
    airspeed = air.airspeed_mps(course, 20.0)
    fixed = AirEnvelope(airspeed, airspeed, (wx, wy))
    across = wy * math.cos(course) - wx * math.sin(course)
    along = wx * math.cos(course) + wy * math.sin(course)
    if along < 19.0 and abs(across) < airspeed - 0.1:
        assert fixed.ground_speeds_mps(np.array([course]), 20.0) == pytest.approx(20.0, abs=1e-6)


def test_envelope_limits_what_is_made_good():
    air = AirEnvelope(15.0, 22.0, (5.0, 0.0))
    path_efficiency = air.ground_speeds_mps(np.array([0.0, math.pi, math.pi / 2.0]), 20.0)
    assert path_efficiency == pytest.approx([20.0, 17.0, 20.0])
    assert air.airspeed_mps(math.pi, 20.0) == 22.0
    assert air.airspeed_mps(0.0, 20.0) == 15.0


def test_wind_stronger_than_the_uav_makes_nothing_good():
    assert AirEnvelope(10.0, 10.0, (0.0, 12.0)).ground_speeds_mps(np.zeros(1), 20.0)[0] == 0.0


def test_a_ground_speed_out_of_reach_is_told():
    air = AirEnvelope(12.0, 28.0, (10.0, 0.0))
    assert "takes an airspeed of 30.0 m/s, expected 12 to 28" in air.out_of_reach(math.pi, 20.0)
    assert "takes an airspeed of 10.0 m/s" in air.out_of_reach(0.0, 20.0)
    assert air.out_of_reach(math.pi / 2.0, 20.0) == ""
    assert AirEnvelope().out_of_reach(1.0, 20.0) == ""


def test_paths_are_planned_with_what_can_be_made_good_on_any_course():
    assert AirEnvelope().speeds_mps(20.0, 0.1) == pytest.approx((18.0, 22.0))
    assert AirEnvelope(10.0, 30.0, (0.0, -6.0)).speeds_mps(20.0, 0.1) == pytest.approx((18.0, 22.0))
    assert AirEnvelope(10.0, 27.0, (0.0, 6.0)).speeds_mps(20.0, 0.1) == pytest.approx((18.0, 21.0))
    assert AirEnvelope(10.0, 30.0, (12.0, 0.0)).speeds_mps(20.0, 0.1) == pytest.approx((19.6, 20.4))


@given(
    st.floats(0.0, 15.0),
    st.floats(-math.pi, math.pi),
    st.floats(-math.pi, math.pi),
    st.floats(8.0, 18.0),
    st.floats(20.0, 35.0),
)
def test_what_a_course_allows_takes_the_least_and_the_most_airspeed(wind, to, course, low, high):
    air = AirEnvelope(low, high, (wind * math.cos(to), wind * math.sin(to)))
    slowest, fastest = air.on_course_mps(course)
    assert 0.0 <= slowest <= fastest
    across = wind * math.sin(to - course)
    assert air.airspeed_mps(course, fastest) == pytest.approx(high)
    if slowest > 0.0 and abs(across) < low:
        needed = math.hypot(slowest - wind * math.cos(to - course), across)
        assert needed == pytest.approx(low)
    elif slowest > 0.0:
        assert slowest == pytest.approx(wind * math.cos(to - course))


def test_a_wind_across_that_is_faster_than_the_uav_carries_it_off():
    assert AirEnvelope(5.0, 9.0, (0.0, 10.0)).on_course_mps(0.0) == (0.0, 0.0)
