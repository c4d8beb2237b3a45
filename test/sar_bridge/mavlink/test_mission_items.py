import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import first_ahead, waypoint_items
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.states import Motion

DATUM = Datum(37.8, -122.8)
LINE = np.array([[100.0, 0.0], [200.0, 0.0], [300.0, 0.0]])


def test_items_are_home_waypoints_and_a_final_loiter():
    items = waypoint_items(LINE, DATUM, 150.0)
    assert len(items) == 5
    assert items[0].frame == mavlink.MAV_FRAME_GLOBAL_INT
    assert items[-1].command == mavlink.MAV_CMD_NAV_LOITER_UNLIM
    assert {item.altitude_m for item in items[1:]} == {150.0}
    for item, point in zip(items[1:], LINE, strict=False):
        x, y, _ = DATUM.to_local(item.latitude_e7 / 1e7, item.longitude_e7 / 1e7)
        assert (x, y) == pytest.approx(tuple(point), abs=0.02)


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        (None, 0),
        (Motion(0, 0.0, 0.0, 20.0, 0.0), 0),
        (Motion(0, 150.0, 5.0, 20.0, 0.0), 1),
        (Motion(0, 250.0, 0.0, 20.0, 0.0), 2),
        (Motion(0, 900.0, 0.0, 20.0, 0.0), 2),
        (Motion(0, 150.0, 0.0, -20.0, 0.0), 0),  # flying the other way
        (Motion(0, 150.0, 900.0, 20.0, 0.0), 0),  # far to the side
    ],
)
def test_first_waypoint_that_needs_no_turning_back(motion, expected):
    assert first_ahead(LINE, motion) == expected


def test_doubled_waypoints_are_no_trouble():
    assert first_ahead(np.array([[0.0, 0.0], [0.0, 0.0]]), Motion(0, 50.0, 0.0, 20.0, 0.0)) == 1


def test_a_point_inside_the_turn_towards_it_is_skipped():
    flying = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
    near = np.array([[20.0, 25.0], [40.0, 60.0], [60.0, 150.0], [60.0, 1000.0]])
    assert first_ahead(near, flying) == 2
    behind = np.array([[-40.0, 5.0], [-300.0, 5.0], [-900.0, 5.0]])
    assert first_ahead(behind, flying) == 1
