"""The aircraft's frames for tf2, where ROS brings its messages (``tf2_msgs``)."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry

from sar_estimator.common import topics

MOVING = frozenset({topics.HELICOPTER_ODOMETRY, topics.UAV_ODOMETRY})
"""The topics whose motions are those of a frame."""
DEPTH = 100


def transform_of(odometry: Odometry, namespace: str) -> TransformStamped:
    """Return the transform from the map to an aircraft, named with a node's namespace."""
    found = TransformStamped()
    found.header = odometry.header
    child = odometry.child_frame_id
    found.child_frame_id = f"{namespace.strip('/')}/{child}".lstrip("/")
    position, translation = odometry.pose.pose.position, found.transform.translation
    translation.x, translation.y, translation.z = position.x, position.y, position.z
    found.transform.rotation = odometry.pose.pose.orientation
    return found


class Frames:
    """Broadcasts transforms beside odometry; does nothing where there are no such messages."""

    def __init__(self, namespace: str, create_publisher: Callable[[Any, str, int], Any]) -> None:
        """Publish ``/tf`` where that is possible; ``namespace``: of the node."""
        self._namespace = namespace
        self._kind: Any = None
        if importlib.util.find_spec("tf2_msgs") is not None:
            self._kind = importlib.import_module("tf2_msgs.msg").TFMessage
            self._sender = create_publisher(self._kind, "/tf", DEPTH)

    def broadcast(self, topic: str, message: Any) -> None:
        """Tell where an aircraft is, if a message of this topic does."""
        if self._kind is not None and topic in MOVING:
            shared = "" if topic in topics.COMMON else self._namespace
            self._sender.publish(self._kind(transforms=[transform_of(message, shared)]))
