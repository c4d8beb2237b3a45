"""Bags with JSON are read as if they had been recorded now."""

import json

import pytest
from std_msgs.msg import String

from sar_estimator.bags.former import FORMER, JSON_KIND, as_now
from sar_estimator.common import topics
from sar_estimator.common.conversions import list_id_of, path_to_points
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import MonitorReport, UavStatus, Uploaded
from sar_sim.world.wires import ALL_WIRES

CORNER = {
    "k": 1, "rule": "D4", "lag_m": 33.5, "next_lag_m": 0.1, "length_m": 970.0, "list_time_s": 72.2,
    "onset_time_s": 43.9, "stop_time_s": 53.0, "estimated_at_s": 44.0, "speed_mps": 19.8,
    "accel_mps2": 2.2, "turn_radius_m": 100.0, "stop": [13.0, 950.0, 1.5],
    "first_stop": [12.0, 9.0], "path": [[262.35, 824.78], [262.43, 834.7]],
}  # fmt: skip
TRUTH = {
    "k": 2, "onset_time_s": 1.0, "onset": [0.0, 1.0, 0.5], "stop_time_s": 9.0,
    "stop": [80.0, 1.0, 0.5], "speed_mps": 20.0, "accel_mps2": 2.5,
}  # fmt: skip


def now(topic, values):
    message = String(data=json.dumps(values))
    return [
        (name, ALL_WIRES[name].from_message(one)) for name, one in as_now(topic, JSON_KIND, message)
    ]


@pytest.mark.parametrize(
    ("topic", "values", "value"),
    [
        (
            topics.UAV_STATE,
            {"mode": "AUTO", "armed": True, "connected": True, "led": True},
            UavStatus("AUTO", armed=True, connected=True, tracking_list=True),
        ),
        (topics.AUTOPILOT, {"WP_RADIUS": 50.0}, {"WP_RADIUS": 50.0}),
        (topics.UPLOADED, {"list_id": 130200000000, "waypoints": 3}, Uploaded(130200000000, 3)),
        (
            topics.MONITOR,
            {"alert": "none", "reason": "", "refused_id": 0, "counts": {"passed": 10}},
            MonitorReport(counts={"passed": 10}),
        ),
        (
            topics.MISSION,
            {"corner": {"taylor_y_m": None}, "mission": {"corner_hurry": 0.1, "a": [1.0, 2.0]}},
            {"mission": {"corner_speed_up": "0.1", "a": ["1.0", "2.0"]}},
        ),
        (topics.SCENARIO, {"faults": [], "uav": {"lag_m": 1}}, {"uav": {"lag_m": "1"}}),
    ],
)
def test_former_messages_are_read(topic, values, value):
    assert now(topic, values) == [(topic, value)]


def test_a_corner_becomes_a_record_and_a_curve():
    message = String(data=json.dumps(CORNER))
    (first, record), (second, curve) = as_now(topics.CORNER_PLAN, JSON_KIND, message)
    assert (first, second) == (topics.CORNER_PLAN, topics.CORNER_PATH)
    found = ALL_WIRES[topics.CORNER_PLAN].from_message(record)
    assert found.stop == Pose(13.0, 950.0, 1.5)
    assert found.first_stop == Pose(12.0, 9.0, 1.5)
    assert found.list_id == list_id_of(curve) == 72_200_000_000
    assert path_to_points(curve).tolist() == CORNER["path"]


def test_a_true_corner_of_an_older_bag_crosses_where_it_stops():
    ((_, found),) = now(topics.TRUE_CORNER, TRUTH)
    assert found.crossing_m == (80.0, 1.0)
    assert found.onset == Pose(0.0, 1.0, 0.5)


@pytest.mark.parametrize("topic", FORMER)
@pytest.mark.parametrize("text", ["", "[1]", "3", '{"a'])
def test_what_is_no_such_text_is_told_in_one_line(topic, text):
    with pytest.raises(ValueError, match="expected JSON") as error:
        list(as_now(topic, JSON_KIND, String(data=text)))
    assert "\n" not in str(error.value)


def test_other_messages_are_handed_on():
    message = String(data="leg")
    assert list(as_now(topics.MODE, JSON_KIND, message)) == [(topics.MODE, message)]
