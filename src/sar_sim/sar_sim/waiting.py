"""What a simulation waits for before it begins: the nodes it flies with, a helicopter in flight."""

from __future__ import annotations

from typing import Any

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import NavSatFix
from std_msgs.msg import String

from sar_estimator import topics
from sar_estimator.geodesy import Datum
from sar_estimator.messages import odometry_to_motion
from sar_estimator.node_support import LATCHED, RELIABLE
from sar_estimator.plane import Pose
from sar_estimator.states import Motion

FLYING_MPS = 5.0
STILL = Motion(0.0, 0.0, 0.0, 0.0, 0.0)


class Answers:
    """Which nodes have told their latched state, as they first do when they have heard the clock.

    So that either side has found the other, which a count of listeners does not show.
    """

    def __init__(self, node: Node, topic_of: dict[str, str]) -> None:
        """Listen for the state (a text) of each named node on its topic."""
        self._node, self._missing = node, dict.fromkeys(topic_of)
        self._subscriptions = [
            node.create_subscription(
                String, topic, lambda _, name=name: self._missing.pop(name, None), LATCHED
            )
            for name, topic in topic_of.items()
        ]

    def missing(self) -> list[str]:
        """Return the nodes that have not been heard."""
        return list(self._missing)

    def close(self) -> None:
        """Listen no more."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)


def await_helicopter(node: Node) -> tuple[Datum, Pose]:
    """Wait until a real helicopter flies; return the datum and where it is."""
    found: dict[str, Any] = {}
    subscriptions = [
        node.create_subscription(
            NavSatFix, topics.DATUM, lambda m: found.__setitem__("datum", m), LATCHED
        ),
        node.create_subscription(
            Odometry,
            topics.HELICOPTER_ODOMETRY,
            lambda m: found.__setitem__("motion", odometry_to_motion(m)),
            RELIABLE,
        ),
    ]
    node.get_logger().info(f"waiting for a helicopter in flight on {topics.FIX}")
    while not ("datum" in found and found.get("motion", STILL).speed_mps > FLYING_MPS):
        rclpy.spin_once(node, timeout_sec=0.2)
    for subscription in subscriptions:
        node.destroy_subscription(subscription)
    origin = found["datum"]
    datum = Datum(origin.latitude, origin.longitude, origin.altitude)
    return datum, found["motion"].pose
