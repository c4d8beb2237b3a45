"""Ways out, and what they are worth."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.arduplane.l1_predictor import STEP_S
from sar_bridge.monitor.escapes import TURNS_RAD, apart, climb_m, ends, worth
from sar_bridge.monitor.helicopter_hypotheses import Future
from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import Motion

TIMES = STEP_S * np.arange(81)


def line(x_m, y_m, vx_mps, vy_mps):
    return np.array((x_m, y_m)) + TIMES[:, None] * np.array((vx_mps, vy_mps))


def future(positions, *, likely, sigma_m=0.0):
    return Future("flies", positions, np.full(len(positions), sigma_m), likely=likely)


def test_what_is_likely_counts_to_the_end_and_what_is_possible_for_a_while():
    path = line(0.0, -400.0, 20.0, 0.0)
    crossing = line(600.0, 200.0, 0.0, -20.0)  # meets it after 30 s
    (far,) = apart(path, [future(crossing, likely=False)], 0.0, 0.0)
    assert worth([far], 0.0, 40.0).least_m == pytest.approx(0.0, abs=1e-6)
    assert worth([far], 0.0, 20.0).least_m == pytest.approx(math.hypot(200.0, 200.0))
    (sure,) = apart(path, [future(crossing, likely=True)], 0.0, 0.0)
    assert worth([sure], 0.0, 20.0).least_m == pytest.approx(0.0, abs=1e-6)


def test_the_doubt_of_both_is_taken_off():
    beside = line(0.0, -250.0, 20.0, 0.0)
    near = apart(beside, [future(line(0.0, 0.0, 20.0, 0.0), likely=True, sigma_m=30.0)], 40.0, 0.0)
    assert near[0].sigma_m == pytest.approx(np.full(81, 50.0))
    assert worth(near, 2.0, 20.0).least_m == pytest.approx(150.0)
    assert worth(near, 9.0, 20.0).least_m == 0.0


def test_of_two_ways_alike_in_the_least_the_one_that_leads_away_is_worth_more():
    standing = [future(np.zeros((81, 2)), likely=True)]
    here, there = line(150.0, 0.0, 0.1, 0.0), line(150.0, 0.0, 20.0, 0.0)
    stays, leaves = (worth(apart(way, standing, 0.0, 0.0), 0.5, 20.0) for way in (here, there))
    assert stays.least_m == leaves.least_m == pytest.approx(150.0)
    assert leaves.value_m > stays.value_m + 10.0


def test_what_comes_near_between_two_times_is_seen():
    # They meet halfway between two of the times, at 20 m/s each.
    path = line(-105.0, 0.0, 20.0, 0.0)
    (near,) = apart(path, [future(line(105.0, 0.0, -20.0, 0.0), likely=True)], 0.0, 0.0)
    assert near.distance_m.min() == pytest.approx(0.0, abs=1e-6)
    assert near.distance_m[:2] == pytest.approx((210.0, 190.0))


def test_what_both_can_turn_between_two_times_is_taken_off():
    path, other = line(0.0, -250.0, 20.0, 0.0), future(line(0.0, 0.0, 20.0, 0.0), likely=True)
    (near,) = apart(path, [other._replace(most_mps2=2.0)], 0.0, 8.0)
    assert near.distance_m[0] == pytest.approx(250.0)
    assert near.distance_m[1:] == pytest.approx(np.full(80, 250.0 - 0.125 * STEP_S**2 * 10.0))


@given(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(-math.pi, math.pi))
def test_the_ways_out_lead_all_around(x_m, y_m, course_rad):
    uav = Motion(0.0, x_m, y_m, 20.0 * math.cos(course_rad), 20.0 * math.sin(course_rad))
    ways = np.vstack(ends(uav, 1500.0)) - (x_m, y_m)
    assert ways.shape == (len(TURNS_RAD), 2)
    assert np.hypot(*ways.T) == pytest.approx(np.full(len(ways), 1500.0))
    courses = np.arctan2(ways[:, 1], ways[:, 0])
    turns = np.array([wrap_angle(course - course_rad) for course in courses])
    assert turns == pytest.approx(TURNS_RAD)
    assert np.abs(turns).max() < math.radians(160.0)  # behind, either way to turn is as good
    assert np.diff(turns) == pytest.approx(np.full(len(turns) - 1, math.radians(30.0)))


@pytest.mark.parametrize(
    ("above_m", "climb"), [(0.0, 40.0), (100.0, 40.0), (-100.0, 0.0), (-15.0, 40.0)]
)
def test_it_climbs_where_that_separates_more(above_m, climb):
    passing = apart(
        line(-400.0, 0.0, 20.0, 0.0), [future(np.zeros((81, 2)), likely=True)], 0.0, 0.0
    )
    # It has climbed 50 m when it passes.
    assert climb_m(passing, above_m, 40.0, 2.5) == climb
