"""Frames are broadcast where tf2's messages are there, and nothing is missed where they are not."""

import sys
from importlib.machinery import ModuleSpec
from types import ModuleType, SimpleNamespace

import pytest

from sar_estimator.common import topics
from sar_estimator.common.conversions import motion_to_odometry
from sar_estimator.common.frames import Frames, transform_of
from sar_estimator.common.states import Motion

ODOMETRY = motion_to_odometry(
    Motion(12.5, 1.0, 2.0, 15.0, 0.0), child="uav", yaw_rad=1.0, altitude_m=150.0
)


class FakeNode:
    """Stands for a node: what it publishes is kept."""

    def __init__(self, namespace="/"):
        self._namespace = namespace
        self.sent = []

    def get_namespace(self):
        return self._namespace

    def create_publisher(self, _kind, topic, _depth):
        return SimpleNamespace(publish=lambda message: self.sent.append((topic, message)))


@pytest.fixture
def with_tf(monkeypatch):
    package, messages = ModuleType("tf2_msgs"), ModuleType("tf2_msgs.msg")
    package.__spec__ = ModuleSpec("tf2_msgs", None)
    messages.TFMessage = SimpleNamespace
    monkeypatch.setitem(sys.modules, "tf2_msgs", package)
    monkeypatch.setitem(sys.modules, "tf2_msgs.msg", messages)


def test_a_transform_is_where_the_odometry_is():
    found = transform_of(ODOMETRY, "/")
    assert (found.header.frame_id, found.child_frame_id) == ("map", "uav")
    assert found.header.stamp == ODOMETRY.header.stamp
    where = found.transform.translation
    assert (where.x, where.y, where.z) == (1.0, 2.0, 150.0)
    assert found.transform.rotation == ODOMETRY.pose.pose.orientation


@pytest.mark.usefixtures("with_tf")
@pytest.mark.parametrize(
    ("topic", "frame"),
    [(topics.UAV_ODOMETRY, "uav2/uav"), (topics.HELICOPTER_ODOMETRY, "uav")],
)
def test_each_uav_has_its_frame_and_the_helicopter_one_for_all(topic, frame):
    node = FakeNode("/uav2")
    Frames(node.get_namespace(), node.create_publisher).broadcast(topic, ODOMETRY)
    ((name, message),) = node.sent
    assert name == "/tf"
    assert [one.child_frame_id for one in message.transforms] == [frame]


@pytest.mark.usefixtures("with_tf")
def test_other_topics_move_nothing():
    node = FakeNode()
    Frames(node.get_namespace(), node.create_publisher).broadcast(topics.TRUE_UAV, ODOMETRY)
    assert node.sent == []


def test_without_the_messages_nothing_is_broadcast(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    node = FakeNode()
    Frames(node.get_namespace(), node.create_publisher).broadcast(topics.UAV_ODOMETRY, ODOMETRY)
    assert node.sent == []
