"""The legs of the patterns: where they lead is what the manual draws."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.patterns.legs import PatternTerms, ends_of, legs_of


def stops(legs):
    """Return where each leg ends when the first leads north, shape (n, 2) [m]."""
    x = y = 0.0
    course, found = 0.5 * math.pi, []
    for length, turn in legs:
        x, y = x + length * math.cos(course), y + length * math.sin(course)
        course += turn
        found.append((x, y))
    return np.array(found)


@pytest.mark.parametrize("side", [1, -1])
def test_an_expanding_square_grows_by_the_spacing_every_second_leg(side):
    legs = legs_of(
        "expanding_square", leg_m=2000.0, spacing_m=500.0, corners=5, side=side, last_m=700.0
    )
    assert [leg.length_m for leg in legs] == [2000.0, 2000.0, 2500.0, 2500.0, 3000.0, 700.0]
    assert [leg.turn_rad for leg in legs] == pytest.approx([-side * math.pi / 2] * 5 + [0.0])


@pytest.mark.parametrize("side", [1, -1])
def test_a_sector_search_crosses_the_datum_twice_and_ends_there(side):
    found = stops(legs_of("sector", leg_m=3000.0, spacing_m=500.0, corners=6, side=side))
    assert found[-1] == pytest.approx((0.0, 0.0), abs=1e-6)
    radii = np.hypot(*found[:-1].T)
    assert radii == pytest.approx([3000.0] * 6)
    for k in (2, 4):  # half-way along the diameters
        assert 0.5 * (found[k - 1] + found[k]) == pytest.approx((0.0, 0.0), abs=1e-6)


@pytest.mark.parametrize("kind", ["parallel_track", "creeping_line"])
def test_search_legs_lie_side_by_side_and_lead_back_and_forth(kind):
    found = stops(legs_of(kind, leg_m=4000.0, spacing_m=500.0, corners=8, side=1))
    expected = [
        (0, 4000), (500, 4000), (500, 0), (1000, 0), (1000, 4000), (1500, 4000), (1500, 0),
        (2000, 0), (2000, 4000),
    ]  # fmt: skip
    assert found == pytest.approx(np.array(expected, dtype=float), abs=1e-6)


def test_a_track_line_is_flown_once_or_back_beside_itself():
    (single,) = legs_of("track_line", leg_m=9000.0, spacing_m=500.0, corners=0, side=1)
    assert single == (9000.0, 0.0)
    found = stops(legs_of("track_line_return", leg_m=9000.0, spacing_m=500.0, corners=2, side=-1))
    assert found[-1] == pytest.approx((-500.0, 0.0), abs=1e-6)


@given(
    st.sampled_from(("expanding_square", "sector", "parallel_track", "creeping_line")),
    st.integers(1, 20),
    st.floats(500.0, 9000.0),
    st.floats(200.0, 2000.0),
)
def test_the_other_side_is_the_mirror_image(kind, corners, leg_m, spacing_m):
    given_ = {"leg_m": leg_m, "spacing_m": spacing_m, "corners": corners}
    right, left = (stops(legs_of(kind, side=side, **given_)) for side in (1, -1))
    assert right * (-1.0, 1.0) == pytest.approx(left, abs=1e-6)
    assert len(right) == corners + 1


@pytest.mark.parametrize(("kind", "corners"), [("track_line", 1), ("track_line_return", 3)])
def test_corners_that_a_pattern_has_not_are_refused(kind, corners):
    with pytest.raises(ValueError, match=rf"corners = {corners}: expected . in a {kind}"):
        legs_of(kind, leg_m=1.0, spacing_m=1.0, corners=corners, side=1)


def test_of_no_pattern_only_the_side_is_known():
    terms = PatternTerms("none", -1, 2000.0, 500.0)
    assert terms.lengths_m() == ()
    assert {terms.turn_after(leg) for leg in range(9)} == {0.5 * math.pi}
    assert terms.turns_one_way
    with pytest.raises(ValueError, match="pattern none"):
        legs_of("none", leg_m=2000.0, spacing_m=500.0, corners=4, side=1)


def test_where_legs_end_is_drawn_from_where_the_first_begins():
    legs = legs_of("sector", leg_m=3000.0, spacing_m=500.0, corners=6, side=1)
    found = ends_of(legs, Pose(0.0, 0.0, 0.5 * math.pi))
    assert found == pytest.approx(stops(legs), abs=1e-6)
    moved = ends_of(legs[:1], Pose(100.0, 50.0, 0.0))
    assert moved == pytest.approx(np.array([[3100.0, 50.0]]))
    assert ends_of([], Pose(0.0, 0.0, 0.0)).shape == (0, 2)
