"""What is wrong now: too near in both ways, and a helicopter that is elsewhere by ADS-B."""

import math

import pytest

from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.outlook import Outlook
from sar_bridge.monitor.parameters import MonitorParameters
from sar_bridge.monitor.present import IN_A_ROW, Present
from sar_estimator.common.reports import Target
from sar_estimator.common.states import Motion

PARAMETERS = MonitorParameters(vertical_separation_m=60.0, adsb_sigma_m=30.0)


def present(*, away_m=150.0, above_m=0.0, time_s=100.0):
    outlook = Outlook(PARAMETERS, HelicopterModel())
    outlook.helicopter.set_motion(Motion(100.0, 0.0, 0.0, 20.0, 0.0), 2.0, 0.1)
    outlook.set_uav(Motion(time_s, 0.0, -away_m, 20.0, 0.0))
    outlook.above_m = above_m
    return Present(PARAMETERS, outlook)


@pytest.mark.parametrize(
    ("away_m", "above_m", "is_told"),
    [
        (150.0, 0.0, True),
        (150.0, 59.0, True),
        (150.0, -59.0, True),
        (199.0, 0.0, True),
        (201.0, 0.0, False),
        (150.0, 60.0, False),
        (150.0, -61.0, False),
        (150.0, math.nan, True),
        (250.0, math.nan, False),
    ],
)
def test_too_near_is_who_is_so_in_both_ways(away_m, above_m, is_told):
    told = present(away_m=away_m, above_m=above_m).too_near(100.0)
    assert bool(told) is is_told
    assert not told or f"{away_m:.0f} m apart" in told


def test_altitudes_that_are_not_known_are_said_to_be():
    assert "altitudes not known" in present(above_m=math.nan).too_near(100.0)


def test_both_are_taken_where_they_are_now_and_nothing_is_said_of_old_positions():
    near = present(away_m=150.0, time_s=99.0)
    assert near.too_near(101.0).startswith("151 m apart")
    assert near.too_near(100.0 + PARAMETERS.stale_s) == ""
    nobody = Present(PARAMETERS, Outlook(PARAMETERS, HelicopterModel()))
    assert nobody.too_near(100.0) == ""


def test_adsb_that_is_elsewhere_is_told_once_it_is_sure_and_taken_back():
    seen = present()
    for i in range(IN_A_ROW):
        assert seen.adsb == ""
        seen.hear(Target(100.0 + 0.5 * i, 400.0, 0.0))
    assert "400 m from" not in seen.adsb
    assert seen.adsb.startswith("the helicopter's ADS-B position is 390 m from its own GPS's")
    seen.hear(Target(101.0, 25.0, 0.0))
    assert seen.adsb == ""


def test_adsb_within_both_errors_and_its_latency_is_believed():
    seen = present()
    for at_s in (100.0, 100.5, 101.0):
        # 30 m of error, and a second late.
        seen.hear(Target(at_s, 20.0 * (at_s - 101.0), 30.0))
    assert seen.adsb == ""


def test_what_is_old_or_cannot_be_compared_says_nothing():
    seen = present()
    for at_s in (90.0, 91.0, 120.0):
        seen.hear(Target(at_s, 5000.0, 0.0))
    assert seen.adsb == ""
    for at_s in (100.0, 101.0):
        seen.hear(Target(at_s, 5000.0, 0.0))
    assert seen.adsb
    seen.forget_old(110.0)
    assert seen.adsb
    seen.forget_old(117.0)
    assert seen.adsb == ""
