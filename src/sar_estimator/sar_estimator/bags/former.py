"""Messages of bags that were recorded when some topics carried JSON, as they are now."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from rosbags.interfaces import Connection

from sar_estimator.common import topics
from sar_estimator.common.conversions import points_to_path
from sar_estimator.common.pose import Pose
from sar_estimator.common.statuses import to_status

JSON_KIND = "std_msgs/msg/String"
RENAMED = {"corner_hurry": "corner_speed_up", "led": "tracking_list"}
"""Keys by their former names."""

Message = tuple[str, Any]


def is_former(connection: Connection) -> bool:
    """Whether a bag's topic carries JSON that is something else now."""
    return connection.msgtype == JSON_KIND and connection.topic in FORMER


def now_on(connection: Connection) -> tuple[str, ...]:
    """Return the topics that a former one's messages are on now, none for another."""
    if not is_former(connection):
        return ()
    more = (topics.CORNER_PATH,) if connection.topic == topics.CORNER_PLAN else ()
    return (connection.topic, *more)


def as_now(topic: str, kind: str, message: Any) -> Iterator[Message]:
    """Yield what a recorded message of type ``kind`` is now: topics and messages.

    Raises ``ValueError`` for one that is no JSON where that is expected.
    """
    if kind != JSON_KIND or topic not in FORMER:
        yield topic, message
        return
    try:
        values = dict(json.loads(message.data))
        yield from FORMER[topic](topic, values)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{topic}: {message.data[:80]!r}: expected JSON ({error})") from error


def _plain(topic: str, values: dict[str, Any]) -> Iterator[Message]:
    yield topic, to_status(topic, values)


def _state(topic: str, values: dict[str, Any]) -> Iterator[Message]:
    yield topic, to_status(topic, {RENAMED.get(key, key): item for key, item in values.items()})


def _mission(topic: str, values: dict[str, Any]) -> Iterator[Message]:
    mission = {RENAMED.get(key, key): value for key, value in values["mission"].items()}
    yield topic, to_status(topic, {**values, "mission": mission})


def _corner(topic: str, values: dict[str, Any]) -> Iterator[Message]:
    path, time_s = values.pop("path"), values["list_time_s"]
    stop = Pose(*values["stop"])
    x, y = values["first_stop"]
    list_id = round(time_s * 1e9)
    new = {**values, "list_id": list_id, "stop": stop, "first_stop": stop._replace(x_m=x, y_m=y)}
    yield topic, to_status(topic, new)
    points = np.array(path, dtype=float).reshape(-1, 2)
    yield topics.CORNER_PATH, points_to_path(points, time_s, list_id=list_id)


def _true_corner(topic: str, values: dict[str, Any]) -> Iterator[Message]:
    poses = {key: Pose(*values[key]) for key in ("onset", "stop")}
    crossing = values.get("crossing_m", values["stop"][:2])
    yield topic, to_status(topic, {**values, **poses, "crossing_m": crossing})


FORMER: dict[str, Callable[[str, dict[str, Any]], Iterator[Message]]] = {
    topics.UAV_STATE: _state,
    topics.AUTOPILOT: _plain,
    topics.UPLOADED: _plain,
    topics.MONITOR: _plain,
    topics.MISSION: _mission,
    topics.SCENARIO: _plain,
    topics.CORNER_PLAN: _corner,
    topics.TRUE_CORNER: _true_corner,
}
