"""Poses: along and across undo offsets, angles wrap, winds blow from where they are said to."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose, blown_mps, wrap_angle

LENGTHS = st.floats(-1e4, 1e4)
ANGLES = st.floats(-20.0, 20.0)


@given(LENGTHS, LENGTHS, ANGLES, LENGTHS, LENGTHS)
def test_along_and_across_are_what_it_was_moved_by(x, y, heading, forward, left):
    pose = Pose(x, y, heading)
    moved = pose.offset(forward, left)
    assert moved.heading_rad == heading
    assert pose.along(moved.x_m, moved.y_m) == pytest.approx(forward, abs=1e-6)
    assert pose.across(moved.x_m, moved.y_m) == pytest.approx(left, abs=1e-6)


@given(st.floats(-1e3, 1e3))
def test_a_wrapped_angle_is_the_same_direction(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


def test_half_a_turn_is_positive():
    assert wrap_angle(-math.pi) == wrap_angle(math.pi) == math.pi


@pytest.mark.parametrize(
    ("from_deg", "towards"), [(0.0, (0, -5)), (90.0, (-5, 0)), (180.0, (0, 5)), (270.0, (5, 0))]
)
def test_a_wind_from_the_north_blows_south(from_deg, towards):
    assert blown_mps(5.0, from_deg) == pytest.approx(towards, abs=1e-9)
