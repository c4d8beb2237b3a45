"""Whether a helicopter has turned at its corner, by its own motion."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, Motion
from sar_planner.prediction.turning import has_turned, surely_leaves


def corner_on(heading_rad):
    stop = Pose(80.0, 0.0, heading_rad)
    return CornerEstimate(104.0, stop, 108.0, 20.0, 2.5, np.zeros((2, 2)), 0.0, 0.0)


def flown_on(course_rad, speed_mps):
    return Motion(
        106.0, 0.0, 0.0, speed_mps * math.cos(course_rad), speed_mps * math.sin(course_rad)
    )


HEADINGS = st.floats(-math.pi, math.pi)


@given(HEADINGS, st.floats(-180.0, 180.0), st.floats(0.0, 25.0), st.sampled_from((-1, 1)))
def test_who_leaves_has_turned_and_flies_along_the_next_leg(heading, turned_deg, speed, side):
    corner = corner_on(heading)
    motion = flown_on(heading + math.radians(turned_deg), speed)
    along_mps = speed * math.cos(math.radians(turned_deg - 90.0 * side))
    for sigma_mps in (0.0, 1.5):
        leaves = surely_leaves(motion, corner, side * math.pi / 2.0, sigma_mps)
        if leaves:
            assert has_turned(motion, corner)
            assert along_mps > 3.0 * max(1.0, sigma_mps) - 1e-6
        elif abs(turned_deg) > 40.001 and speed > 3.0:
            assert along_mps <= 3.0 * max(1.0, sigma_mps) + 1e-6


@pytest.mark.parametrize("turned_deg", [30.0, -30.0, 0.0])
def test_a_little_off_its_course_is_no_turn(turned_deg):
    assert not has_turned(flown_on(math.radians(turned_deg), 20.0), corner_on(0.0))


def test_nothing_has_turned_where_nothing_is_known_or_hardly_moves():
    assert not has_turned(None, corner_on(0.0))
    assert not has_turned(flown_on(1.5, 20.0), None)
    assert not has_turned(flown_on(1.5, 2.9), corner_on(0.0))
    assert not surely_leaves(None, corner_on(0.0), 1.57, 0.0)
    assert not surely_leaves(flown_on(1.5, 20.0), None, 1.57, 0.0)
