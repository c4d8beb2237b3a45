"""States: what follows from their values."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, Motion, MotionEstimate, list_id_at


def corner(stop_x=80.0, stop_time_s=108.0):
    return CornerEstimate(
        104.0, Pose(stop_x, 0.0, 0.0), stop_time_s, 20.0, 2.5, np.zeros((2, 2)), 0.0, 0.0
    )


def test_speed_and_course_are_those_of_the_velocity():
    motion = Motion(1.0, 2.0, 3.0, -3.0, 4.0)
    assert motion.speed_mps == 5.0
    assert motion.course_rad == pytest.approx(math.atan2(4.0, -3.0))
    assert motion.pose == Pose(2.0, 3.0, motion.course_rad)


@given(st.floats(-100.0, 100.0))
def test_later_it_is_farther_on(seconds):
    later = Motion(1.0, 2.0, 3.0, -3.0, 4.0).after(seconds)
    assert later.time_s == pytest.approx(1.0 + seconds)
    assert (later.x_m, later.y_m) == pytest.approx((2.0 - 3.0 * seconds, 3.0 + 4.0 * seconds))


@pytest.mark.parametrize("field", ["time_s", "x_m", "y_m", "vx_mps", "vy_mps"])
@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_one_bad_number_is_enough(field, bad):
    good = Motion(1.0, 2.0, 3.0, -3.0, 4.0)
    assert good.is_finite()
    assert not good._replace(**{field: bad}).is_finite()


def test_sigmas_are_of_the_worse_axis():
    variances = np.diag([4.0, 0.25, 1.0, 9.0, 0.01, 1.0])
    assert MotionEstimate(Motion(0, 0, 0, 0, 0), variances).sigmas == (3.0, 0.5)


def test_a_corner_begins_v_over_a_before_its_stop():
    assert corner().onset_time_s == 100.0
    assert corner().stopping_distance_m == 80.0


@pytest.mark.parametrize(
    ("other", "changed"),
    [(corner(), 0.0), (corner(stop_x=95.0), 15.0), (corner(stop_time_s=109.0), 20.0)],
)
def test_a_corner_changes_in_place_or_in_time_at_cruise(other, changed):
    assert corner().changed_m(other) == changed


@given(st.lists(st.floats(0.0, 2e9), min_size=2, max_size=20))
def test_lists_have_identities_of_their_own(times):
    last, seen = 0, []
    for time_s in times:
        last = list_id_at(time_s, last)
        seen.append(last)
    assert sorted(set(seen)) == seen
