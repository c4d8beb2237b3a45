"""When a slot track's list is due, what every kind of list holds, and where it ends."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_planner.guidance.waypoint_lists import (
    HoldListing,
    PathListing,
    SlotListing,
    WaypointLists,
)
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import Arc, FlightPath, Straight

SLOT = Pose(0.0, -250.0, 0.0)


def uav(x):
    return Motion(100.0, x, -250.0, 20.0, 0.0)


def lists(**changes):
    return WaypointLists(CornerParameters(), MissionParameters(**changes))


def shifted(by_m):
    return SlotListing("leg", SLOT.offset(0.0, by_m))


def test_a_slot_track_is_listed_once_and_again_when_it_shifts():
    made = lists()
    mode, points = made.make(shifted(0.0), uav(0.0))
    assert mode == "leg"
    assert points[:2].tolist() == [[150.0, -250.0], [4000.0, -250.0]]
    assert made.make(shifted(9.0), uav(20.0)) is None
    assert made.make(shifted(11.0), uav(40.0)) is not None


@given(st.floats(0.0, 3000.0))
def test_less_of_a_shift_is_tolerated_the_longer_a_leg_is_flown(flown):
    made = lists()
    made.make(shifted(0.0), uav(0.0))
    tolerance = 10.0 * max(0.3, 0.5 ** (flown / 550.0))
    due = made.make(shifted(tolerance + 0.1), uav(flown))
    assert due is not None
    made = lists()
    made.make(shifted(0.0), uav(0.0))
    again = made.make(shifted(tolerance - 0.1), uav(flown))
    assert (again is None) == (flown < 0.6 * 4000.0)


@pytest.mark.parametrize("side", [1, -1])
def test_lists_end_in_a_circle_apart_from_a_helicopter_that_flies_on(side):
    """The slot is d inside; the circle's 100 m, the least distance and the margin need more."""
    made = WaypointLists(CornerParameters(), MissionParameters(turn_side=side))
    slot = Pose(0.0, -side * 250.0, 0.0)
    _, points = made.make(SlotListing("leg", slot), Motion(0.0, 0.0, slot.y_m, 20.0, 0.0))
    assert abs(points[-1, 1]) - 100.0 == pytest.approx(200.0 + 15.0)
    _, held = made.make(HoldListing("hold", slot), Motion(0.0, 0.0, slot.y_m, 20.0, 0.0))
    assert held.shape == (1, 2)
    assert held[0, 0] == 150.0


def test_a_path_is_listed_from_where_the_uav_is_and_goes_on_beyond_it():
    path = FlightPath.of(Pose(0.0, 0.0, 0.0), [Straight(200.0), Arc(100.0, -0.5 * math.pi)])
    made = lists()
    _, points = made.make(PathListing("D4", path, 20.0, from_m=150.0), uav(0.0))
    assert points[0] == pytest.approx((150.0, 0.0), abs=1e-6)
    end = path.end
    assert points[-2] == pytest.approx((end.x_m, end.y_m - 4000.0), abs=1e-6)
    gaps = np.hypot(*np.diff(points, axis=0).T)
    assert gaps.min() >= 5.0 - 1e-9
    # A list of something else was made since: the slot track is due again.
    assert made.make(shifted(0.0), uav(0.0)) is not None
