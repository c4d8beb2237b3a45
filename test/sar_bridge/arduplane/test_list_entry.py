"""On which leg of a list a UAV is."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.arduplane.list_entry import LEFT_M, Entry, entry_of
from sar_estimator.common.states import Motion

LINE = np.column_stack((np.arange(0.0, 1000.0, 100.0), np.zeros(10)))


def at(x_m, y_m, course_rad=0.0, speed_mps=20.0):
    vx, vy = speed_mps * math.cos(course_rad), speed_mps * math.sin(course_rad)
    return Motion(0.0, x_m, y_m, vx, vy)


def test_on_the_leg_that_it_is_abeam_of():
    assert entry_of(LINE, at(30.0, 10.0)) == Entry(1, (0.0, 0.0))
    assert entry_of(LINE, at(130.0, 10.0)) == Entry(2, (100.0, 0.0))


def test_on_the_next_leg_where_its_own_is_nearly_over():
    assert entry_of(LINE, at(85.0, 10.0)) == Entry(1, (0.0, 0.0))
    assert entry_of(LINE, at(95.0, 10.0)) == Entry(2, (100.0, 0.0))
    assert entry_of(LINE, at(195.0, 10.0)) == Entry(3, (200.0, 0.0))


def test_up_to_a_begin_that_is_ahead_it_flies_beside():
    assert entry_of(LINE, at(-20.0, 10.0)) == Entry(0, (-20.0, 0.0))
    assert entry_of(LINE, at(-20.0, -30.0)) == Entry(0, (-20.0, 0.0))


def test_the_first_leg_begins_at_the_begin_whatever_the_course():
    assert entry_of(LINE, at(5.0, 10.0, math.pi / 2.0)).begin == (0.0, 0.0)
    assert entry_of(LINE, at(20.0, 5.0, math.pi)) == Entry(0, pytest.approx((20.0, 0.0)))


def test_to_a_list_elsewhere_it_flies_straight():
    far = LINE + np.array((500.0, 300.0))
    assert entry_of(far, at(0.0, 0.0)) == Entry(0, (0.0, 0.0))
    assert entry_of(far[:1], at(0.0, 0.0)) == Entry(0, (0.0, 0.0))


@given(
    st.floats(-400.0, 1500.0),
    st.floats(-400.0, 400.0),
    st.floats(-math.pi, math.pi),
    st.integers(1, 10),
)
def test_every_uav_has_a_leg_of_a_list_and_never_one_behind_it(x, y, course, count):
    points, uav = LINE[:count], at(x, y, course)
    entry = entry_of(points, uav)
    assert 0 <= entry.at < count
    if entry.at > 1 and entry.begin != (x, y):
        assert entry.begin == tuple(points[entry.at - 1])
        assert uav.x_m >= points[entry.at - 1][0] - LEFT_M
