"""The table of topics: what goes into a message comes out of it, and as is said to be carried."""

import json
import math
import re

import numpy as np
import pytest
from std_msgs.msg import String

from sar_estimator.common import topics
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import (
    CornerRecord,
    Health,
    Mark,
    MonitorReport,
    Target,
    UavReport,
    UavStatus,
    Uploaded,
    Velocity,
    WaypointList,
)
from sar_estimator.common.states import (
    CornerEstimate,
    LegEstimate,
    Motion,
    MotionEstimate,
    Phase,
)
from sar_estimator.common.statuses import to_status
from sar_estimator.common.wires import WIRES

POINTS = np.array([[1.0, 2.0], [300.0, -40.0], [900.0, -41.0]])
CORNER = CornerEstimate(
    104.0, Pose(80.0, 3.0, 0.4), 108.0, 20.0, 2.5, np.diag((9.0, 4.0)), 0.01, 0.2
)
VALUES = {
    topics.FIX: Fix(12.5, 37.8, -122.8, 30.0, np.diag((9.0, 9.0))),
    topics.VELOCITY: Velocity(12.5, 3.0, -4.0),
    topics.FIX_VELOCITY: Velocity(12.5, 3.0, -4.0, 0.25),
    topics.ADSB: Target(12.5, 300.0, -40.0),
    topics.DATUM: Datum(37.8, -122.8, 12.0),
    topics.HELICOPTER_ODOMETRY: MotionEstimate(
        Motion(12.5, 1.0, 2.0, 15.0, -9.0, 0.3, 0.4), np.diag((4.0, 0.3, 1.0, 4.0, 0.3, 1.0)), 35.0
    ),
    topics.LEG: LegEstimate(12.5, Pose(1.0, 2.0, 0.3), 20.0, 1.5, 0.01, 0.2),
    topics.CORNER: CORNER,
    topics.PREDICTION: CORNER,
    topics.PHASE: Phase.DECELERATING,
    topics.UAV_ODOMETRY: UavReport(Motion(12.5, 1.0, 2.0, 15.0, -9.0), -0.5, 150.0),
    topics.UAV_STATE: UavStatus(
        "AUTO", armed=True, connected=True, tracking_list=True, airspeed_ratio=1.1
    ),
    topics.AUTOPILOT: {"NAVL1_PERIOD": 17.0},
    topics.WIND: (3.0, -4.0),
    topics.UAV_CLOCK: 12.5,
    topics.UPLOADED: Uploaded(12_500_000_001, 3, 210.5),
    topics.WAYPOINTS: WaypointList(12_500_000_001, 12.5, POINTS, 21.0),
    topics.CLEARED: WaypointList(12_500_000_001, 12.5, POINTS, None, 40.0),
    topics.SPEED: 21.5,
    topics.MODE: "leg",
    topics.LAG: -3.5,
    topics.CORNER_PLAN: CornerRecord(
        3,
        "D4",
        12_500_000_001,
        12.5,
        4.25,
        0.1,
        940.0,
        104.0,
        108.0,
        105.0,
        20.0,
        2.5,
        100.0,
        Pose(80.0, 3.0, 0.4),
        Pose(79.0, 2.0, 0.4),
        187.5,
        121.0,
    ),
    topics.TARGET: Target(12.5, 300.0, -40.0),
    topics.MARKS: (Mark(1, 11.5, 300.0, -40.0), Mark(2, 12.5, -7.0, 1.0)),
    topics.CORNER_PATH: WaypointList(12_500_000_001, 12.5, POINTS),
    topics.PATTERN: POINTS,
    topics.MISSION: {"corner": {"spacing_m": "250.0"}, "mission": {"speed_range": ["0.5", "2"]}},
    topics.MONITOR: MonitorReport("caution", "near", 7, thresholds={"a": 1.0}, counts={"b": 2}),
}


def plain(value):
    """Return a value as nested lists of its parts, to be compared."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple) and not isinstance(value, str):
        return [plain(part) for part in value]
    if hasattr(value, "__dataclass_fields__"):
        return [plain(getattr(value, name)) for name in value.__dataclass_fields__]
    return value


def same(one, other):
    if isinstance(one, list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float):
        return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-7)
    return one == other


@pytest.mark.parametrize("topic", VALUES)
def test_a_message_carries_what_is_said_to_be_carried(topic):
    wire, value = WIRES[topic], VALUES[topic]
    message = wire.to_message(value, 12.5)
    assert type(message) is wire.kind
    received = wire.from_message(message)
    assert same(plain(received), plain(wire.carried(value)))


def test_every_topic_that_nodes_talk_over_is_in_the_table():
    known = {value for name, value in vars(topics).items() if name.isupper()} - {
        topics.COMMON,
        topics.OF_UAV,
    }
    others = {
        topics.CLOCK,
        topics.SCENARIO,
        topics.TRUE_HELICOPTER,
        topics.TRUE_UAV,
        topics.TRUE_CORNER,
        topics.ENGAGE,
        topics.DISENGAGE,
        topics.RETURN_HOME,
        topics.MARK,
        topics.ORBIT,
        topics.RESUME,
        topics.SET_PARAMETERS,
    }
    assert set(WIRES) == known - others


def status(**values):
    return to_status("it", values)


def monitor(**changes):
    return status(**{"alert": "none", "reason": "", "refused_id": 0, **changes})


def flying(**changes):
    return status(**{"mode": "AUTO", "armed": True, "connected": True, **changes})


@pytest.mark.parametrize(
    ("topic", "message", "expected"),
    [
        (
            topics.MONITOR,
            monitor(refused_id="some"),
            "it.refused_id = 'some': expected a whole num",
        ),
        (topics.MONITOR, monitor(counts=3), "it.counts = '3': expected a mapping"),
        (topics.UAV_STATE, flying(armed="perhaps"), "it.armed = 'perhaps': expected true or false"),
        (topics.AUTOPILOT, status(WP_RADIUS="wide"), "it.WP_RADIUS = 'wide': expected a number"),
        (topics.AUTOPILOT, status(WP_RADIUS=math.nan), "it.WP_RADIUS = 'nan': expected a number"),
        (topics.UPLOADED, status(waypoints=3), "it.list_id: missing"),
        (topics.CORNER_PLAN, status(k=1), "it.rule: missing"),
        (topics.PHASE, String(data="flying"), "flying"),
    ],
)
def test_what_is_no_such_value_is_refused_in_one_line(topic, message, expected):
    with pytest.raises(ValueError, match=re.escape(expected)) as error:
        WIRES[topic].from_message(message)
    assert "\n" not in str(error.value)


def test_status_of_an_older_bridge_has_no_airspeed_ratio():
    message = status(mode="AUTO", armed=True, connected=True)
    found = WIRES[topics.UAV_STATE].from_message(message)
    assert found == UavStatus("AUTO", armed=True, connected=True)


@pytest.mark.parametrize("ratio", [0, -1.0, math.nan, 3, "one"])
def test_an_airspeed_ratio_that_cannot_be_is_refused(ratio):
    with pytest.raises(ValueError, match=r"it\.airspeed_ratio = .*: expected"):
        WIRES[topics.UAV_STATE].from_message(flying(airspeed_ratio=ratio))


@pytest.mark.parametrize(
    ("alert", "level"), [("none", 0), ("caution", 1), ("warning", 1), ("escape", 2)]
)
def test_the_level_of_a_status_is_that_of_the_alert(alert, level):
    message = WIRES[topics.MONITOR].to_message(MonitorReport(alert), 0.0)
    assert (message.level, message.message) == (bytes([level]), alert)
    message = WIRES[topics.MONITOR].to_message(MonitorReport(alert, "too near"), 0.0)
    assert message.message == "too near"


def test_a_link_that_is_dead_is_an_error():
    for connected, level in ((True, b"\x00"), (False, b"\x02")):
        told = WIRES[topics.UAV_STATE].to_message(UavStatus("AUTO", connected=connected), 0.0)
        assert told.level == level


@pytest.mark.parametrize("topic", [topics.UAV_STATE, topics.MONITOR])
def test_a_status_of_something_else_is_not_taken_for_one_that_says_nothing(topic):
    whole = WIRES[topic].to_message(VALUES[topic], 0.0)
    for message in (status(), status(voltage=12.0)):
        with pytest.raises(ValueError, match=r"^it\.\w+: missing$"):
            WIRES[topic].from_message(message)
    del whole.values[0]
    with pytest.raises(ValueError, match="missing"):
        WIRES[topic].from_message(whole)


def test_attitude_and_climb_are_in_the_uavs_odometry():
    flown = UavReport(Motion(12.5, 1.0, 2.0, 15.0, -9.0), 0.7, 150.0, 0.1, -0.4, 1.5)
    message = WIRES[topics.UAV_ODOMETRY].to_message(flown, 0.0)
    q = message.pose.pose.orientation
    roll = math.atan2(2.0 * (q.w * q.x + q.y * q.z), 1.0 - 2.0 * (q.x**2 + q.y**2))
    pitch = math.asin(2.0 * (q.w * q.y - q.z * q.x))
    assert WIRES[topics.UAV_ODOMETRY].from_message(message).yaw_rad == pytest.approx(0.7)
    assert message.twist.twist.linear.z == 1.5
    assert abs(roll) == pytest.approx(0.4)
    assert abs(pitch) == pytest.approx(0.1)


def test_a_withdrawal_is_a_list_without_points():
    message = WIRES[topics.WAYPOINTS].to_message(WaypointList.withdrawal(12.5), 12.5)
    assert len(message.poses) == 0
    assert len(WIRES[topics.WAYPOINTS].from_message(message).points) == 0


def test_a_report_is_not_changed_by_being_told():
    report = VALUES[topics.MONITOR]
    before = json.dumps(plain(report), default=dict)
    WIRES[topics.MONITOR].to_message(report, 0.0)
    assert json.dumps(plain(report), default=dict) == before


@pytest.mark.parametrize(
    ("problem", "severe", "level"),
    [("", False, b"\x00"), ("slow", False, b"\x01"), ("lost", True, b"\x02"), ("", True, b"\x00")],
)
def test_health_is_ok_a_warning_or_an_error(problem, severe, level):
    health = Health("monitor", problem, {"alert": "none"}, severe=severe)
    (status,) = WIRES[topics.DIAGNOSTICS].to_message(health, 3.0).status
    assert (status.level, status.message) == (level, problem or "ok")
    assert [(value.key, value.value) for value in status.values] == [("alert", "none")]


def test_what_all_uavs_share_is_absolute_and_all_else_relative():
    assert topics.name_of(topics.FIX) == "/helicopter/fix"
    assert topics.name_of(topics.WAYPOINTS) == "uav/waypoints"
    assert topics.name_of(topics.ENGAGE) == "planner/engage"


@pytest.mark.parametrize("topic", sorted(topics.OF_UAV))
def test_what_is_of_a_uav_has_its_name_and_what_all_share_has_none(topic):
    named = topics.of_uav(topic, "uav2")
    assert named == f"/uav2{topic}"
    assert topics.of_uav(topic, "") == topic
    assert topics.of_uav(named, "uav3") == named  # it is another one's already
    assert topics.plain(named) == topics.plain(topic) == topic
    assert (topics.uav_of(named), topics.uav_of(topic)) == ("uav2", "")
    assert topics.name_of(topic) == topic[1:]
    assert topics.name_of(named) == named


@pytest.mark.parametrize("topic", sorted(topics.COMMON))
def test_what_all_share_is_named_alike_for_all(topic):
    assert topics.of_uav(topic, "uav2") == topics.plain(topic) == topics.name_of(topic) == topic
