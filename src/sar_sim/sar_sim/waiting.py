"""What a simulation waits for before it begins: the nodes it flies with, a helicopter in flight."""

from __future__ import annotations

import math
from typing import Any

import rclpy
from nav_msgs.msg import Odometry
from rcl_interfaces.srv import GetParameters
from rclpy.node import Node
from sensor_msgs.msg import NavSatFix

from sar_estimator import topics
from sar_estimator.geodesy import Datum
from sar_estimator.messages import odometry_to_motion
from sar_estimator.node_support import LATCHED, RELIABLE
from sar_estimator.plane import Pose
from sar_estimator.states import Motion

ASK_AGAIN_S = 0.5
FLYING_MPS = 5.0
STILL = Motion(0.0, 0.0, 0.0, 0.0, 0.0)


class Answers:
    """Which nodes answer when they are asked for a parameter.

    So that either side has found the other, which a count of listeners does not show.
    """

    def __init__(self, node: Node, names: tuple[str, ...]) -> None:
        """Ask the nodes of these names."""
        self._node = node
        self._clients = {
            name: node.create_client(GetParameters, f"/{name}/get_parameters") for name in names
        }
        self._asked: dict[str, tuple[float, Any]] = {}

    def missing(self, now_s: float) -> list[str]:
        """Return the nodes that have not answered, and ask those again that were silent."""
        for name, client in list(self._clients.items()):
            asked_s, answer = self._asked.get(name, (-math.inf, None))
            if answer is not None and answer.done():
                del self._clients[name]
                self._node.destroy_client(client)
            elif now_s - asked_s > ASK_AGAIN_S and client.service_is_ready():
                request = GetParameters.Request(names=["use_sim_time"])
                self._asked[name] = now_s, client.call_async(request)
        return list(self._clients)


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
