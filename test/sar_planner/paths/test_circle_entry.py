"""Every way onto a circle ends on it, along it, and is flyable."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose, wrap_angle
from sar_planner.paths.circle_entry import LEFT, RIGHT, entries, onto_circle

CIRCLE_M, TURN_M = 300.0, 100.0
PLACES = st.floats(-3000.0, 3000.0)
SIDES = st.sampled_from((LEFT, RIGHT))


@given(
    x=PLACES,
    y=PLACES,
    heading=st.floats(-math.pi, math.pi),
    first=SIDES,
    around=SIDES,
    lead=st.floats(0.0, 1000.0),
    loops=st.integers(0, 2),
)
def test_it_ends_on_the_circle_along_it_the_way_it_is_flown(
    x, y, heading, first, around, lead, loops
):
    path = onto_circle(
        Pose(x, y, heading),
        (0.0, 0.0),
        circle_m=CIRCLE_M,
        turn_m=TURN_M,
        first=first,
        around=around,
        lead_m=lead,
        loops=loops,
    )
    if path is None:
        return
    end = path.end
    assert math.hypot(end.x_m, end.y_m) == pytest.approx(CIRCLE_M, abs=1e-5)
    along = math.atan2(end.y_m, end.x_m) + around * math.pi / 2.0
    assert wrap_angle(end.heading_rad - along) == pytest.approx(0.0, abs=1e-6)
    assert path.start == Pose(x, y, heading)
    least = 2.0 * math.pi * TURN_M * loops + lead
    assert path.length_m >= least - 1e-6


@given(x=PLACES, y=PLACES, heading=st.floats(-math.pi, math.pi))
def test_there_is_always_a_way_and_the_shortest_comes_first(x, y, heading):
    ways = entries(Pose(x, y, heading), (0.0, 0.0), circle_m=CIRCLE_M, turn_m=TURN_M)
    lengths = [path.length_m for path, _ in ways]
    assert lengths
    assert lengths == sorted(lengths)
    assert {around for _, around in ways} == {LEFT, RIGHT}


def test_beside_it_the_way_is_straight():
    path = onto_circle(
        Pose(-1000.0, 300.0, 0.0),
        (0.0, 0.0),
        circle_m=CIRCLE_M,
        turn_m=TURN_M,
        first=RIGHT,
        around=RIGHT,
    )
    assert path.length_m == pytest.approx(1000.0)
    assert path.end.x_m == pytest.approx(0.0, abs=1e-6)


def test_out_of_the_middle_it_has_to_fly_on_first():
    options = {"circle_m": CIRCLE_M, "turn_m": TURN_M, "first": LEFT, "around": LEFT}
    assert onto_circle(Pose(0.0, 0.0, 0.0), (0.0, 0.0), **options) is None
    assert onto_circle(Pose(0.0, 0.0, 0.0), (0.0, 0.0), lead_m=400.0, **options) is not None
