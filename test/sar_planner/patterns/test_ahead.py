"""What is expected still to be flown: the pattern, laid onto the leg that is really flown."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.patterns.ahead import LEGS_AHEAD, MOVED_M, corners_ahead, have_moved
from sar_planner.patterns.legs import PatternTerms, ends_of, legs_of

KINDS = ("expanding_square", "sector", "parallel_track", "creeping_line")
SQUARE = PatternTerms("expanding_square", 1, 2000.0, 500.0)
NORTH = Pose(0.0, 0.0, 0.5 * math.pi)


@given(
    st.sampled_from(KINDS),
    st.sampled_from((1, -1)),
    st.integers(0, 12),
    st.builds(Pose, st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(-7.0, 7.0)),
)
def test_a_pilot_who_keeps_to_his_pattern_is_expected_to_fly_it(kind, side, leg, start):
    """From any leg on that begins where the pattern has it, the rest is the pattern's."""
    legs = legs_of(kind, leg_m=3000.0, spacing_m=500.0, corners=25, side=side)
    whole = ends_of(legs, start)
    turned = sum(one.turn_rad for one in legs[:leg])
    place = start[:2] if leg == 0 else whole[leg - 1]
    begun = Pose(*map(float, place), start.heading_rad + turned)
    found = corners_ahead(PatternTerms(kind, side, 3000.0, 500.0), leg, begun)
    assert found == pytest.approx(whole[leg : leg + LEGS_AHEAD], abs=1e-5)


def test_it_lies_on_the_leg_as_it_is_flown():
    found = corners_ahead(SQUARE, 0, Pose(100.0, 50.0, 0.0))
    assert found[:2] == pytest.approx(np.array([[2100.0, 50.0], [2100.0, -1950.0]]))


def test_a_leg_ends_no_sooner_than_the_helicopter_and_where_it_is_predicted_to_stop():
    end, corner = corners_ahead(SQUARE, 0, NORTH, flown_m=2300.0)[:2]
    assert end == pytest.approx((0.0, 2300.0))
    assert corner == pytest.approx((2000.0, 2300.0))
    early = corners_ahead(SQUARE, 0, NORTH, flown_m=1400.0, stop_m=1500.0)
    assert early[:2] == pytest.approx(np.array([[0.0, 1500.0], [2000.0, 1500.0]]))


@pytest.mark.parametrize(
    ("terms", "leg", "count"),
    [
        (PatternTerms("track_line", 1, 9000.0), 0, 1),
        (PatternTerms("track_line_return", 1, 9000.0, 500.0), 0, 3),
        (PatternTerms("track_line_return", 1, 9000.0, 500.0), 2, 1),
        (PatternTerms("track_line_return", 1, 9000.0, 500.0), 3, 0),
        (PatternTerms("parallel_track", 1, 4000.0, 0.0), 0, 1),  # how long a cross leg is unknown
        (PatternTerms("expanding_square", 1, 0.0, 500.0), 0, 0),
        (PatternTerms("none", 1, 2000.0, 500.0), 0, 0),
        (SQUARE, 50, LEGS_AHEAD),
    ],
)
def test_it_ends_where_nothing_is_known(terms, leg, count):
    found = corners_ahead(terms, leg, NORTH, stop_m=700.0)
    assert found.shape == (count, 2)


def test_points_are_told_when_one_has_moved_or_is_new():
    told = corners_ahead(SQUARE, 0, NORTH)
    assert not have_moved(told + np.array([0.0, 0.9 * MOVED_M]), told)
    assert have_moved(told + np.array([0.0, 1.1 * MOVED_M]), told)
    assert have_moved(told[:3], told)
    assert not have_moved(told[:0], told[:0])
