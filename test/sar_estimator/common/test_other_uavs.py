"""What is told of other UAVs, and which of them altitude does not keep apart."""

import math

import numpy as np
import pytest

from sar_estimator.common.other_uavs import OtherUavs
from sar_estimator.common.reports import UavReport, Uploaded, WaypointList
from sar_estimator.common.states import Motion

POINTS = np.array([(0.0, 0.0), (1000.0, 0.0)])


def seen(time_s, altitude_m=150.0):
    return UavReport(Motion(time_s, 0.0, 0.0, 20.0, 0.0), 0.0, altitude_m)


def tell(others, topic, value):
    assert others.inputs[f"/uav2/uav/{topic}"](value, 0.0) == []


def near(others, now_s=10.0, altitude_m=150.0):
    return others.near(now_s, altitude_m, layer_m=30.0, stale_s=15.0)


def test_nobody_is_near_before_he_is_seen_nor_long_after():
    others = OtherUavs(["uav2"])
    assert near(others) == []
    tell(others, "odometry", seen(10.0))
    assert [one.name for one in near(others)] == ["uav2"]
    assert [one.name for one in near(others, now_s=25.0)] == ["uav2"]
    assert near(others, now_s=25.1) == []


@pytest.mark.parametrize(
    ("own_m", "other_m", "apart"),
    [
        (150.0, 150.0, False),
        (150.0, 179.0, False),
        (150.0, 180.0, True),
        (210.0, 150.0, True),
        (math.nan, 210.0, False),
        (150.0, math.nan, False),
    ],
)
def test_altitude_keeps_apart_only_where_both_are_known(own_m, other_m, apart):
    others = OtherUavs(["uav2"])
    tell(others, "odometry", seen(10.0, other_m))
    assert (near(others, altitude_m=own_m) == []) is apart


def test_it_flies_the_list_that_its_autopilot_has():
    others = OtherUavs(["uav2"])
    for number in range(1, 12):
        tell(others, "cleared", WaypointList(number, float(number), POINTS + number))
    tell(others, "odometry", seen(10.0))
    assert near(others)[0].flown is None  # none has arrived
    tell(others, "uploaded", Uploaded(10, 2))
    tell(others, "odometry", seen(10.2))
    assert near(others)[0].flown.list_id == 10
    tell(others, "uploaded", Uploaded(99, 2))  # of which nothing was told
    tell(others, "odometry", seen(10.4))
    assert near(others)[0].flown.list_id == 10
    tell(others, "cleared", WaypointList.withdrawal(11.0))
    tell(others, "odometry", seen(10.6))
    assert near(others)[0].flown is None


def test_a_position_that_is_no_number_is_not_taken():
    others = OtherUavs(["uav2"])
    tell(others, "odometry", UavReport(Motion(10.0, math.nan, 0.0, 0.0, 0.0), 0.0))
    assert near(others) == []


@pytest.mark.parametrize("names", [["uav2", "uav2"], [""]])
def test_names_must_be_some_and_different(names):
    with pytest.raises(ValueError, match="expected different names"):
        OtherUavs(names)
