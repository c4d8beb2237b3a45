"""The receiver's component: fixes stamped with this machine's clock, velocity first."""

import math

import pytest

from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES
from sar_estimator.gps.component import GpsComponent


def fed(component, data, ros_s):
    component.ros_s = ros_s
    return component.receive(data, ros_s)


def test_fix_and_velocity_of_an_epoch_have_one_time(make):
    component = GpsComponent()
    (first, velocity), (second, fix) = fed(component, make["pvt"](), 5000.0)
    assert (first, second) == (topics.FIX_VELOCITY, topics.FIX)
    assert velocity.time_s == fix.time_s == pytest.approx(5000.0)
    assert (velocity.vx_mps, velocity.vy_mps) == (3.0, -4.0)
    assert velocity.sigma_mps == component.health(5000.0).values["velocity_sigma_mps"] > 0.0
    assert (fix.latitude_deg, fix.longitude_deg, fix.altitude_m) == pytest.approx(
        (37.5, -122.5, 30.0)
    )
    assert component.health(5000.0).problem == ""


def test_without_a_fix_that_is_published_and_severe(make):
    component = GpsComponent()
    ((topic, fix),) = fed(component, make["pvt"](ok=0), 5000.0)
    assert topic == topics.FIX
    assert not fix.has_fix
    assert math.isnan(fix.latitude_deg)
    health = component.health(5000.0)
    assert (health.problem, health.severe) == ("receiver has no fix", True)


def test_why_nothing_comes_goes_before_everything_else():
    component = GpsComponent()
    component.failure = "/dev/ttyACM0,38400: No such file or directory"
    assert component.health(0.0).problem == component.failure


def test_a_clock_that_was_set_is_told_once(make):
    component, notices = GpsComponent(), []
    for second in range(20):
        shift = 3600.0 if second > 9 else 0.0
        out = fed(component, make["pvt"](second=second), 5000.0 + second + shift)
        notices += [value for topic, value in out if topic == NOTICES]
    assert len(notices) == 1
    assert component.health(9000.0).values["clock_steps"] == 1
    assert component.health(9000.0).values["unbelieved"] == 3


def test_a_velocity_without_an_accuracy_is_told_as_one(make):
    component = GpsComponent()
    data = make["rmc"]() + make["gga"]() + make["rmc"](time="10:20:31") + make["gga"]("10:20:31")
    told = [topic for topic, _ in fed(component, data, 5000.0)]
    assert topics.VELOCITY in told
    assert topics.FIX_VELOCITY not in told
