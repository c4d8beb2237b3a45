"""Where a slot is on the legs of a pattern."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_planner.patterns.legs import PatternTerms
from sar_planner.patterns.slot import CROSS_SPACINGS, Slot

KINDS = ("expanding_square", "sector", "parallel_track", "creeping_line", "track_line_return")
TERMS = st.builds(PatternTerms, st.sampled_from(KINDS), st.sampled_from((1, -1)))
TRACKS = st.integers(1, 3)


@pytest.mark.parametrize("kind", ["parallel_track", "creeping_line"])
def test_back_and_forth_inside_is_the_ground_side_to_which_the_pattern_goes_over(kind):
    for side in (1, -1):
        places = [Slot().across_on(PatternTerms(kind, side), leg) for leg in range(12)]
        for search_leg in range(0, 12, 2):
            northward = 1 if search_leg % 4 == 0 else -1
            assert places[search_leg] * northward == side
        # The U-turn leads beyond the cross leg: to the left of one between two right turns.
        assert places[1::4] == [-side * CROSS_SPACINGS] * 3
        assert places[3::4] == [side * CROSS_SPACINGS] * 3


def test_a_track_line_is_flown_back_with_the_uav_on_the_same_ground_side():
    terms = PatternTerms("track_line_return", 1)
    assert [Slot().across_on(terms, leg) for leg in (0, 2)] == [1, -1]


@given(TERMS, st.integers(0, 20), TRACKS)
def test_outside_is_the_mirror_image_of_inside(terms, leg, tracks):
    inside, outside = Slot("inside", tracks), Slot("outside", tracks)
    assert inside.across_on(terms, leg) == -outside.across_on(terms, leg)


@given(TERMS, st.integers(0, 20), TRACKS)
def test_right_and_left_are_the_helicopters_own(terms, leg, tracks):
    assert Slot("right", tracks).across_on(terms, leg) == tracks
    assert Slot("left", tracks).across_on(terms, leg) == -tracks


@given(st.sampled_from(("expanding_square", "sector")), st.sampled_from((1, -1)), TRACKS)
def test_where_all_turns_are_to_one_side_a_slot_stays_there(kind, side, tracks):
    terms = PatternTerms(kind, side)
    assert {Slot("inside", tracks).across_on(terms, leg) for leg in range(9)} == {side * tracks}


def test_it_is_told_as_a_crew_says_it():
    assert [str(Slot()), str(Slot("left", 2))] == ["inside", "left 2"]
