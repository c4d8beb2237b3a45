"""What the autopilot's parameters allow."""

import pytest

from sar_planner.guidance.vehicle import Vehicle
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters

CORNER, MISSION, CALM = CornerParameters(), MissionParameters(), (0.0, 0.0)
GOOD = {
    "NAVL1_PERIOD": 15.0,
    "NAVL1_DAMPING": 0.75,
    "ROLL_LIMIT_DEG": 65.0,
    "AIRSPEED_MIN": 12.0,
    "AIRSPEED_MAX": 28.0,
    "FS_GCS_ENABL": 1.0,
    "FS_LONG_ACTN": 1.0,
}


def refusal(wind=CALM, ratio=1.0, **changes):
    vehicle = Vehicle(GOOD | changes)
    return vehicle.refusal(CORNER, MISSION, vehicle.air(wind, ratio))


def test_a_good_one_is_flown_and_one_that_tells_nothing_too():
    assert refusal() == ""
    nothing = Vehicle({})
    assert nothing.refusal(CORNER, MISSION, nothing.air(CALM)) == ""
    assert Vehicle({}).tuning(MISSION) is None
    assert Vehicle(GOOD).tuning(MISSION).period_s == 15.0


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"AIRSPEED_MIN": 21.0}, "AIRSPEED_MIN = 21: expected at most V = 20 m/s"),
        ({"AIRSPEED_MAX": 19.0}, "AIRSPEED_MAX = 19: expected at least V = 20 m/s"),
        ({"ROLL_LIMIT_DEG": 25.0}, "ROLL_LIMIT_DEG = 25: expected at least 26"),
        ({"NAVL1_PERIOD": 20.0}, "NAVL1_PERIOD = 20: expected at most 16.2 s"),
        ({"WP_MAX_RADIUS": 30.0}, "WP_MAX_RADIUS = 30: expected 0"),
    ],
)
def test_refusals_name_the_parameter(changes, expected):
    assert expected in refusal(**changes)


def test_wind_that_the_uav_cannot_slow_down_in_asks_for_more_roll():
    assert refusal(ROLL_LIMIT_DEG=30.0) == ""
    assert "ROLL_LIMIT_DEG" in refusal((14.0, 0.0), ROLL_LIMIT_DEG=30.0)


def test_high_up_the_same_indicated_airspeeds_are_faster():
    assert refusal(ratio=1.15, AIRSPEED_MIN=17.0) == ""
    assert "AIRSPEED_MIN = 18: expected at most V = 20 m/s (17.4 indicated)" in refusal(
        ratio=1.15, AIRSPEED_MIN=18.0
    )
    assert refusal(ratio=1.15, AIRSPEED_MAX=18.0) == ""


@pytest.mark.parametrize("name", ["FS_GCS_ENABL", "FS_LONG_ACTN"])
def test_a_failsafe_that_does_nothing_is_told(name):
    assert f"{name} = 0" in Vehicle(GOOD | {name: 0.0}).warning()
    assert Vehicle(GOOD).warning() == ""
    assert Vehicle({}).warning() == ""


@pytest.mark.parametrize("ratio", [1.0, 1.063, 1.1, 1.17])
def test_what_is_told_is_within_the_autopilots_limits_to_the_bit(ratio):
    vehicle = Vehicle(GOOD)
    air = vehicle.air((40.0, 0.0), ratio)
    assert vehicle.indicated_mps(air.airspeed_mps(0.0, 20.0), ratio) >= 12.0
    assert vehicle.indicated_mps(air.airspeed_mps(0.0, 50.0), ratio) == 12.0
    assert vehicle.indicated_mps(air.airspeed_mps(3.14, 20.0), ratio) == 28.0
    assert vehicle.indicated_mps(20.0, ratio) == 20.0 / ratio
    assert Vehicle({}).indicated_mps(20.0, ratio) == 20.0 / ratio


def test_envelope_is_the_autopilots():
    air = Vehicle(GOOD).air((3.0, 0.0))
    assert (air.slowest_mps, air.fastest_mps, air.wind_mps) == (12.0, 28.0, (3.0, 0.0))
    air = Vehicle(GOOD).air((3.0, 0.0), 1.1)
    assert (air.slowest_mps, air.fastest_mps) == pytest.approx((13.2, 30.8))
