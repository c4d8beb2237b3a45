"""The wind from the autopilot, or from track against heading."""

import math

import pytest

from sar_bridge.autopilot_state import WindState
from sar_estimator.states import Motion


def test_autopilots_estimate_is_taken():
    wind = WindState()
    wind.told(45.0, 6.0, 0.0)
    assert wind.vector_mps == pytest.approx((-6.0 * math.sqrt(0.5), -6.0 * math.sqrt(0.5)))
    wind.told(math.nan, 3.0, 1.0)
    assert math.hypot(*wind.vector_mps) == pytest.approx(6.0)


def test_track_against_heading_where_nothing_is_told():
    wind = WindState()
    for tick in range(1200):
        heading = 0.02 * tick
        vx, vy = 20.0 * math.cos(heading) + 5.0, 20.0 * math.sin(heading) - 2.0
        wind.airspeed_mps = 20.0
        wind.seen(Motion(0.1 * tick, 0.0, 0.0, vx, vy), heading, 0.1 * tick)
    assert wind.vector_mps == pytest.approx((5.0, -2.0), abs=0.05)


def test_told_wind_goes_before_seen_until_it_falls_silent():
    wind = WindState()
    wind.airspeed_mps = 20.0
    wind.told(270.0, 4.0, 0.0)
    wind.seen(Motion(1.0, 0.0, 0.0, 30.0, 0.0), 0.0, 1.0)
    assert wind.vector_mps == pytest.approx((4.0, 0.0))
    for tick in range(600):
        wind.seen(Motion(0.0, 0.0, 0.0, 30.0, 0.0), 0.0, 20.0 + 0.1 * tick)
    assert wind.vector_mps == pytest.approx((10.0, 0.0), abs=0.2)


def test_nothing_is_made_of_an_airspeed_that_is_none():
    wind = WindState()
    wind.seen(Motion(0.0, 0.0, 0.0, 20.0, 0.0), 0.0, 0.0)
    wind.airspeed_mps = math.nan
    wind.seen(Motion(0.0, 0.0, 0.0, 20.0, 0.0), 0.0, 1.0)
    assert wind.vector_mps is None
