"""The forecast of another UAV: along its list, at its present speed."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.states import Motion
from sar_planner.prediction.forecast import along_list

EAST = Motion(10.0, 0.0, 0.0, 20.0, 0.0)
NOWHERE = np.empty((0, 2))


def test_without_a_list_it_flies_straight_on():
    found = along_list(EAST, NOWHERE, 12.0, 60.0).positions([12.0, 22.0])
    assert found == pytest.approx(np.array([(40.0, 0.0), (240.0, 0.0)]))


def test_it_flies_from_waypoint_to_waypoint_and_straight_on_behind():
    points = np.array([(-500.0, 0.0), (200.0, 0.0), (200.0, -300.0)])
    found = along_list(EAST, points, 10.0, 60.0).positions([15.0, 20.0, 30.0, 40.0])
    assert found == pytest.approx(
        np.array([(100.0, 0.0), (200.0, 0.0), (200.0, -200.0), (200.0, -400.0)])
    )


def test_a_list_that_begins_ahead_is_flown_to_its_begin():
    points = np.array([(0.0, 200.0), (400.0, 200.0)])
    found = along_list(EAST, points, 10.0, 60.0).positions([15.0, 25.0])
    assert found == pytest.approx(np.array([(0.0, 100.0), (100.0, 200.0)]))


@given(
    st.lists(st.tuples(st.floats(-3000, 3000), st.floats(-3000, 3000)), max_size=8),
    st.floats(0.0, 40.0),
    st.floats(0.0, 10.0),
)
def test_whatever_the_list_it_goes_on_at_its_speed(points, speed, late_s):
    motion = Motion(10.0, 5.0, -7.0, speed, 0.0)
    now = 10.0 + late_s
    forecast = along_list(motion, np.array(points).reshape(-1, 2), now, 60.0)
    times = np.arange(now, now + 60.0, 0.5)
    places = forecast.positions(times)
    assert places[0] == pytest.approx((5.0 + speed * late_s, -7.0), abs=1e-6)
    steps = np.hypot(*np.diff(places, axis=0).T)
    assert steps.max() <= 0.5 * max(speed, 5.0) + 1e-6
    assert math.isfinite(places.sum())
