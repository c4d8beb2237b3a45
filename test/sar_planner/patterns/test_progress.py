"""Which leg is flown, and where the UAV has its place, as the helicopter turns."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose, wrap_angle
from sar_planner.patterns.legs import PatternTerms, legs_of
from sar_planner.patterns.progress import Progress, begin_of, expectation, places_of
from sar_planner.patterns.slot import Slot

PARALLEL = PatternTerms("parallel_track", 1)
KINDS = ("expanding_square", "sector", "parallel_track", "creeping_line")


def heading(deg):
    return Pose(0.0, 0.0, math.radians(deg))


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
        progress.fly(heading(heading_deg))
    assert progress.leg == 4
    assert progress.here == expectation(PARALLEL, 4)


def test_the_place_is_that_of_the_leg_meant_this_one_or_the_one_to_come():
    progress = Progress(PARALLEL)
    progress.fly(heading(90.0))
    progress.fly(heading(0.0))  # the cross leg, to the east
    assert progress.across(math.radians(5.0)) == -1.4
    assert progress.is_cross_leg(math.radians(5.0))
    assert progress.across(math.radians(-90.0)) == -1.0
    assert not progress.is_cross_leg(math.radians(-90.0))


@given(st.lists(st.floats(-7.0, 7.0), max_size=40))
def test_a_square_never_changes_its_side(headings):
    progress = Progress(PatternTerms(side=-1))
    for rad in headings:
        progress.fly(Pose(0.0, 0.0, rad))
        assert progress.across(rad) == progress.across(rad + 1.0) == -1.0


def test_places_on_legs_in_a_row():
    assert places_of(PARALLEL, 0, 6) == [1.0, -1.4, -1.0, 1.4, 1.0, -1.4]
    assert places_of(PatternTerms("sector", -1), 0, 3, Slot(tracks=2)) == [-2.0, -2.0, -2.0]


@given(st.floats(-3.0, 3.0), st.floats(0.5, 2.6), st.floats(-900.0, -20.0), st.floats(20.0, 900.0))
def test_a_leg_began_where_its_line_crosses_the_last_ones(course, turn, left_m, flown_m):
    corner = Pose(300.0, -40.0, course)
    foot = corner._replace(heading_rad=course + turn).offset(flown_m)
    assert begin_of(foot, corner.offset(left_m)) == pytest.approx(
        (300.0, -40.0, course + turn), abs=1e-6
    )


def test_lines_that_hardly_cross_are_left_abeam_of_where_the_last_was_seen():
    back = begin_of(Pose(500.0, 80.0, math.pi), Pose(900.0, 0.0, 0.1))
    assert back == pytest.approx((900.0, 80.0, math.pi))


@pytest.mark.parametrize("seen", [True, False])
def test_the_first_leg_began_where_the_helicopter_was_first_and_is_laid_as_it_is_flown(seen):
    progress = Progress(PARALLEL)
    for x in (10.0, 90.0) if seen else ():
        progress.see(x, 0.0)
    assert progress.begun is None
    progress.fly(Pose(180.0, 0.0, 0.02))
    progress.fly(Pose(500.0, 5.0, 0.0))
    assert progress.begun == pytest.approx((10.0 if seen else 180.0, 5.0, 0.0))
    progress.fly(Pose(700.0, -300.0, -math.pi / 2))
    assert progress.leg == 1
    assert progress.begun == pytest.approx((700.0, 5.0, -math.pi / 2))


@pytest.mark.parametrize(
    ("kind", "slot", "legs"),
    [
        ("expanding_square", Slot("inside"), [False] * 4),
        ("expanding_square", Slot("outside", 2), [True] * 4),
        ("sector", Slot("left"), [True] * 4),
        ("parallel_track", Slot("right"), [False, False, True, True]),
        ("parallel_track", Slot("inside"), [False] * 4),
    ],
)
def test_whether_a_slot_stays_outside_of_the_turn_to_come(kind, slot, legs):
    """Beyond a cross leg the UAV comes ahead, and is not led as one that stays outside."""
    terms = PatternTerms(kind, 1, 2000.0, 500.0)
    progress = Progress(terms, slot)
    course, found = 0.0, []
    for leg in range(4):
        progress.fly(Pose(0.0, 0.0, course))
        found.append(progress.stays_outside(course))
        course = wrap_angle(course + terms.turn_after(leg))
    assert found == legs
