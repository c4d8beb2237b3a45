"""Which leg is flown, and where the UAV has its place, as the helicopter turns."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_planner.patterns.legs import legs_of
from sar_planner.patterns.progress import Progress, expectation, sides_of

KINDS = ("expanding_square", "sector", "parallel_track", "creeping_line")


@given(st.sampled_from(KINDS), st.sampled_from((1, -1)), st.integers(1, 15))
def test_the_turns_expected_are_those_of_the_pattern(kind, side, corners):
    legs = legs_of(kind, leg_m=3000.0, spacing_m=500.0, corners=corners, side=side)
    for leg, (_, turn) in enumerate(legs[:-1]):
        assert expectation(kind, side, leg).turn_rad == pytest.approx(turn)


@pytest.mark.parametrize("kind", ["parallel_track", "creeping_line"])
def test_back_and_forth_the_uav_is_beside_the_tracks_to_come(kind):
    """On search legs it is on one ground side: where the helicopter goes over to."""
    for side in (1, -1):
        for search_leg in range(0, 12, 2):
            northward = 1 if search_leg % 4 == 0 else -1
            assert expectation(kind, side, search_leg).slot_side * northward == side


def test_a_track_line_is_flown_back_with_the_uav_outward():
    assert [expectation("track_line_return", 1, leg).slot_side for leg in range(3)] == [1, 1, -1]


def test_legs_are_counted_as_the_course_changes_and_no_other_way():
    progress = Progress("parallel_track", 1)
    for heading_deg in (90, 95, 70, 92, 1, -3, 2, -90, -80, 170, -175, 90):
        progress.fly(math.radians(heading_deg))
    assert progress.leg == 4
    assert progress.here == expectation("parallel_track", 1, 4)


def test_the_place_is_that_of_the_leg_meant_this_one_or_the_one_to_come():
    progress = Progress("parallel_track", 1)
    progress.fly(math.radians(90.0))
    progress.fly(0.0)  # the cross leg, to the east
    assert progress.slot_side(math.radians(5.0)) == 1
    assert progress.slot_side(math.radians(-90.0)) == -1


@given(st.lists(st.floats(-7.0, 7.0), max_size=40))
def test_a_square_never_changes_its_side(headings):
    progress = Progress("expanding_square", -1)
    for heading in headings:
        progress.fly(heading)
        assert progress.here.slot_side == progress.slot_side(heading + 1.0) == -1


def test_sides_of_legs_in_a_row():
    assert sides_of("parallel_track", 1, 0, 6) == [1, 1, -1, -1, 1, 1]
    assert sides_of("parallel_track", 1, 3, 2) == [-1, 1]
    assert sides_of("sector", -1, 0, 3) == [-1, -1, -1]
