"""Which leg is flown, and where the UAV has its place, as the helicopter turns."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_planner.patterns.legs import PatternTerms, legs_of
from sar_planner.patterns.progress import Progress, expectation, places_of
from sar_planner.patterns.slot import Slot

PARALLEL = PatternTerms("parallel_track", 1)
KINDS = ("expanding_square", "sector", "parallel_track", "creeping_line")


@given(st.sampled_from(KINDS), st.sampled_from((1, -1)), st.integers(1, 15))
def test_the_turns_expected_are_those_of_the_pattern(kind, side, corners):
    legs = legs_of(kind, leg_m=3000.0, spacing_m=500.0, corners=corners, side=side)
    terms = PatternTerms(kind, side, 3000.0, 500.0)
    for leg, (length, turn) in enumerate(legs[:-1]):
        assert expectation(terms, leg) == pytest.approx((turn, length))
        assert expectation(PatternTerms(kind, side), leg).length_m == 0.0


def test_legs_are_counted_as_the_course_changes_and_no_other_way():
    progress = Progress(PARALLEL)
    for heading_deg in (90, 95, 70, 92, 1, -3, 2, -90, -80, 170, -175, 90):
        progress.fly(math.radians(heading_deg))
    assert progress.leg == 4
    assert progress.here == expectation(PARALLEL, 4)


def test_the_place_is_that_of_the_leg_meant_this_one_or_the_one_to_come():
    progress = Progress(PARALLEL)
    progress.fly(math.radians(90.0))
    progress.fly(0.0)  # the cross leg, to the east
    assert progress.across(math.radians(5.0)) == -1.4
    assert progress.is_cross_leg(math.radians(5.0))
    assert progress.across(math.radians(-90.0)) == -1.0
    assert not progress.is_cross_leg(math.radians(-90.0))


@given(st.lists(st.floats(-7.0, 7.0), max_size=40))
def test_a_square_never_changes_its_side(headings):
    progress = Progress(PatternTerms(side=-1))
    for heading in headings:
        progress.fly(heading)
        assert progress.across(heading) == progress.across(heading + 1.0) == -1.0


def test_places_on_legs_in_a_row():
    assert places_of(PARALLEL, 0, 6) == [1.0, -1.4, -1.0, 1.4, 1.0, -1.4]
    assert places_of(PatternTerms("sector", -1), 0, 3, Slot(tracks=2)) == [-2.0, -2.0, -2.0]
