"""Alerts: less at once, more after a while, each counted when it begins."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.monitor.alerts import ALERTS, Alert, Alerts
from sar_bridge.monitor.parameters import MonitorParameters

NEAR_M = {Alert.NONE: 250.0, Alert.CAUTION: 160.0, Alert.WARNING: 140.0}


def alerted(alert):
    alerts = Alerts(MonitorParameters())
    alerts.set(alert)
    return alerts


@pytest.mark.parametrize(("was", "seen"), list(itertools.product(Alert, NEAR_M)))
def test_every_alert_in_every_state(was, seen):
    alerts = alerted(was)
    alerts.watch(NEAR_M[seen], 10.0)
    worse = ALERTS.index(seen) > ALERTS.index(was)
    assert alerts.alert is (was if worse else seen)
    alerts.watch(NEAR_M[seen], 11.9)
    assert alerts.alert is (was if worse else seen)
    alerts.watch(NEAR_M[seen], 12.0)
    assert alerts.alert is seen
    assert alerts.counts[seen] == (seen is not Alert.NONE or was is not Alert.NONE)


def test_what_gets_well_meanwhile_is_never_told():
    alerts = alerted(Alert.NONE)
    for second in range(20):
        alerts.watch(140.0 if second % 2 else 250.0, float(second))
    assert alerts.counts[Alert.WARNING] == alerts.counts[Alert.CAUTION] == 0


@given(st.lists(st.floats(0.0, 400.0), max_size=40))
def test_an_escape_is_never_told_by_distance_alone(distances):
    alerts = alerted(Alert.NONE)
    for second, distance in enumerate(distances):
        alerts.watch(distance, float(second))
    assert alerts.counts[Alert.ESCAPE] == 0
