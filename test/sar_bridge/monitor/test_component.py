"""The monitor as a component: lists handed on, kept back, withdrawn; what is told of it."""

import math

import numpy as np
import pytest

from sar_bridge.monitor.component import MonitorComponent
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import (
    HelicopterReport,
    Target,
    UavReport,
    UavStatus,
    Uploaded,
    WaypointList,
)
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase

SLOT = np.array([[800.0, -250.0], [4000.0, -250.0], [4300.0, -280.0]])
CROSSING = np.array([[500.0, 0.0], [500.0, 3000.0]])
HABITS = HelicopterModel(20.0, 2.5, 1)


def of(outputs, topic):
    return [value for one, value in outputs if one == topic]


def listed(points, number=1):
    return WaypointList(number, 100.0, points)


def fed(component, now_s=100.0, *, uav_y=-250.0):
    for topic, value in (
        (topics.UAV_STATE, UavStatus("AUTO", armed=True, connected=True)),
        (topics.PHASE, Phase.CRUISE),
        (topics.LEG, LegEstimate(now_s, Pose(0.0, 0.0, 0.0), 20.0, 0.3, 0.001, 0.02)),
        (
            topics.HELICOPTER_ODOMETRY,
            HelicopterReport(Motion(now_s, 0, 0, 20.0, 0.0), 1.0, 0.1, 50.0),
        ),
        (topics.UAV_ODOMETRY, UavReport(Motion(now_s, 0.0, uav_y, 20.0, 0.0), 0.0, 150.0)),
        (topics.AUTOPILOT, {"NAVL1_PERIOD": 17.0}),
        (topics.WIND, (1.0, 0.0)),
    ):
        component.handle(topic, value, now_s)
    return component


def monitor(**changes):
    return MonitorComponent(MonitorParameters(**changes), HABITS)


def test_a_list_that_keeps_apart_is_handed_on_and_another_is_not():
    component = fed(monitor())
    passed = component.handle(topics.WAYPOINTS, listed(SLOT), 100.0)
    assert of(passed, topics.CLEARED)[0].list_id == 1
    refused = component.handle(topics.WAYPOINTS, listed(CROSSING, 2), 100.0)
    assert of(refused, topics.CLEARED) == []
    assert "list refused" in of(refused, NOTICES)[0].text
    (report,) = of(refused, topics.MONITOR)
    assert (report.refused_id, report.counts["refused"], report.escaping) == (2, 1, False)


def test_a_list_from_before_both_were_seen_waits_for_them():
    component = monitor()
    assert of(component.handle(topics.WAYPOINTS, listed(SLOT), 99.0), topics.CLEARED) == []
    fed(component)
    assert of(component.tick(100.0), topics.CLEARED)[0].list_id == 1
    assert of(component.tick(100.5), topics.CLEARED) == []


def test_a_withdrawal_is_handed_on_whatever_is_known():
    found = monitor().handle(topics.WAYPOINTS, WaypointList.withdrawal(5.0), 5.0)
    assert len(of(found, topics.CLEARED)[0].points) == 0


def test_a_uav_that_flies_at_the_helicopter_is_sent_away_once_it_is_led():
    component = fed(monitor(watch_only=False), uav_y=-150.0)
    component.monitor.set_flown(np.array([[60.0, 0.0], [80.0, 0.0]]))
    assert component.is_leading
    told = []
    for step in range(20):
        now_s = 100.0 + 0.5 * step
        toward = Motion(now_s, 10.0 * step, -150.0 + 8.0 * step, 20.0, 16.0)
        component.handle(topics.UAV_ODOMETRY, UavReport(toward, 0.7, 150.0), now_s)
        ahead = HelicopterReport(Motion(now_s, 10.0 * step, 0.0, 20.0, 0.0), 1.0, 0.1)
        component.handle(topics.HELICOPTER_ODOMETRY, ahead, now_s)
        told += component.tick(now_s)
    assert of(told, topics.CLEARED)
    assert any(report.escaping for report in of(told, topics.MONITOR))
    assert component.health(110.0).severe
    assert next(notice.level for notice in of(told, NOTICES)) == "error"
    idle = fed(monitor(), uav_y=-150.0)
    idle.handle(topics.UAV_STATE, UavStatus("MANUAL", armed=True, connected=True), 100.0)
    assert not idle.is_leading
    assert of(idle.tick(100.0), topics.CLEARED) == []


def test_who_is_too_near_is_told_while_the_uav_is_armed_whoever_flies_it():
    component = fed(monitor(vertical_separation_m=120.0), uav_y=-150.0)
    component.handle(topics.UAV_STATE, UavStatus("MANUAL", armed=True, connected=True), 100.0)
    (report,) = of(component.tick(100.0), topics.MONITOR)
    assert report.too_near.startswith("150 m apart, 100 m in altitude")
    assert component.health(100.0).problem == report.too_near
    component.handle(topics.UAV_STATE, UavStatus("MANUAL", connected=True), 100.0)
    (report,) = of(component.tick(100.5), topics.MONITOR)
    assert report.too_near == ""


def test_an_adsb_position_elsewhere_is_told():
    component = fed(monitor())
    for _ in range(2):
        component.handle(topics.ADSB, Target(100.0, 900.0, 0.0), 100.0)
    (report,) = of(component.tick(100.0), topics.MONITOR)
    assert "900 m from its own GPS" in report.adsb
    assert component.health(100.0).problem == report.adsb


def test_its_state_is_told_when_it_changes():
    component = monitor()
    assert of(component.start(0.0), topics.MONITOR)[0].alert == "none"
    assert component.start(0.0) == []


def test_heights_and_what_was_uploaded_are_heeded():
    component = fed(monitor())
    assert component.monitor.outlook.above_m == pytest.approx(150.0 - 50.0)
    component.handle(topics.WAYPOINTS, listed(SLOT, 7), 100.0)
    assert not component.monitor.guarding
    component.handle(topics.UPLOADED, Uploaded(7), 100.0)
    assert component.monitor.guarding
    assert component.monitor.outlook.tuning.period_s == 17.0


def test_a_corner_has_the_covariance_that_came_before_it():
    component = fed(monitor())
    corner = CornerEstimate(
        104.0, Pose(80.0, 0.0, 0.0), 108.0, 20.0, 2.5, np.zeros((2, 2)), 0.0, 0.0
    )
    component.handle(topics.CORNER, np.diag((9.0, 4.0)), 104.0)
    component.handle(topics.PREDICTION, corner, 104.0)
    assert component.monitor.helicopter.corner.covariance[0, 0] == 9.0


def test_health_tells_the_thresholds_and_the_alert():
    component = fed(monitor())
    health = component.health(100.0)
    assert health.values["min_separation_m"] == 200.0
    assert (health.problem, health.severe) == ("", False)


@pytest.mark.parametrize("rate", [0.0, -1.0, 1000.0, math.nan])
def test_a_rate_that_cannot_be_meant_is_named(rate):
    with pytest.raises(ValueError, match="guard_rate_hz"):
        MonitorComponent(MonitorParameters(), HABITS, rate_hz=rate)


def test_it_tells_how_late_it_is_and_counts_on_that():
    component = fed(monitor())
    component.handle(topics.FIX_TIME, 98.2, 100.0)
    component.tick(100.0)
    health = component.health(100.0)
    assert health.problem == "laptop is late: fixes 1.8 s old at decision"
    assert health.values["fix_late_s"] == "1.8"
    assert (health.values["list_late_s"], health.values["delay_s"]) == ("0.0", "1.0")
    component.handle(topics.WAYPOINTS, listed(SLOT), 100.0)
    component.handle(topics.UPLOADED, Uploaded(1), 103.0)
    values = component.health(103.0).values
    assert (values["list_late_s"], values["delay_s"]) == ("3.0", "3.0")
    assert component.health(180.0).problem == ""


def test_a_way_out_counts_as_a_list_does():
    component = fed(monitor())
    component.handle(topics.WAYPOINTS, listed(SLOT), 100.0)
    component.handle(topics.UPLOADED, Uploaded(1), 100.1)
    fed(component, 101.0, uav_y=-90.0)
    (away,) = of(component.tick(101.0), topics.CLEARED)
    component.handle(topics.UPLOADED, Uploaded(away.list_id), 103.5)
    assert component.health(103.5).values["list_late_s"] == "2.5"


def test_a_list_given_before_the_clock_was_set_back_is_not_late():
    component = fed(monitor())
    component.handle(topics.WAYPOINTS, listed(SLOT), 100.0)
    component.set_clock_back()
    component.handle(topics.UPLOADED, Uploaded(1), 104.0)
    assert component.health(104.0).values["list_late_s"] == "0.0"
