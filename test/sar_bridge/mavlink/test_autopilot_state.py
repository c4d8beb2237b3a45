"""The wind from the autopilot, or from track against heading; true against indicated airspeed."""

import math

import pytest

from sar_bridge.mavlink.autopilot_state import WindState
from sar_estimator.common.states import Motion


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


def fly_in_wind(wind, indicated, true, seconds):
    """Fly circles in the wind of 6 m/s from the west that the autopilot tells of."""
    for tick in range(10 * seconds):
        at_s, heading = 0.1 * tick, 0.02 * tick
        wind.told(270.0, 6.0, at_s)
        wind.airspeed_mps = indicated
        vx, vy = true * math.cos(heading) + 6.0, true * math.sin(heading)
        wind.seen(Motion(at_s, 0.0, 0.0, vx, vy), heading, at_s)


def test_airspeed_ratio_is_learnt_in_any_wind():
    wind = WindState()
    assert wind.airspeed_ratio == 1.0
    fly_in_wind(wind, 19.0, 20.2, 20)
    assert 1.03 < wind.airspeed_ratio < 1.05
    fly_in_wind(wind, 19.0, 20.2, 200)
    assert wind.airspeed_ratio == pytest.approx(20.2 / 19.0, abs=1e-3)


@pytest.mark.parametrize(("indicated", "kept"), [(8.0, 1.35), (60.0, 0.9), (math.inf, 0.9)])
def test_an_airspeed_sensor_that_is_wrong_is_believed_only_so_far(indicated, kept):
    wind = WindState()
    fly_in_wind(wind, indicated, 20.0, 300)
    assert wind.airspeed_ratio == pytest.approx(kept, abs=1e-3)


def test_one_late_message_hardly_changes_the_ratio():
    wind = WindState()
    fly_in_wind(wind, 20.0, 20.0, 30)
    wind.told(270.0, 6.0, 90.0)
    wind.seen(Motion(90.0, 0.0, 0.0, 40.0, 0.0), 0.0, 90.0)
    assert wind.airspeed_ratio < 1.02
