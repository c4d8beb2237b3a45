"""What a bag tells of a flight, as arrays: the one input of metrics, figures and report."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sar_estimator.common import topics
from sar_estimator.common.conversions import (
    from_stamp,
    odometry_to_motion,
    path_to_points,
    to_yaw,
)
from sar_sim.bags.bag import read_messages
from sar_sim.report.coverage import FloatArray

ODOMETRY = {
    topics.HELICOPTER_ODOMETRY,
    topics.UAV_ODOMETRY,
    topics.TRUE_HELICOPTER,
    topics.TRUE_UAV,
}
TEXTS = {
    topics.TRUE_CORNER,
    topics.CORNER_PLAN,
    topics.MISSION,
    topics.SCENARIO,
    topics.MONITOR,
}
WANTED = ODOMETRY | TEXTS | {topics.WAYPOINTS}


@dataclass
class Track:
    """Positions over time: ``times_s`` shape (n,), ``xy_m`` shape (n, 2), ``yaw_rad`` (n,)."""

    times_s: FloatArray
    xy_m: FloatArray
    yaw_rad: FloatArray

    def __len__(self) -> int:
        """Return how many positions there are."""
        return int(self.times_s.size)

    def at(self, times_s: FloatArray) -> FloatArray:
        """Return positions, shape (m, 2) [m], interpolated linearly."""
        return np.column_stack(
            [np.interp(times_s, self.times_s, self.xy_m[:, axis]) for axis in (0, 1)]
        )

    def between(self, first_s: float, last_s: float) -> Track:
        """Return the part of the track between two times [s]."""
        chosen = (self.times_s >= first_s) & (self.times_s <= last_s)
        return Track(self.times_s[chosen], self.xy_m[chosen], self.yaw_rad[chosen])


@dataclass
class PlannedCorner:
    """Every record of one corner, oldest first, and the waypoints of its last list."""

    records: list[dict[str, Any]]
    waypoints: FloatArray

    @property
    def first(self) -> dict[str, Any]:
        """The first decision."""
        return self.records[0]

    @property
    def last(self) -> dict[str, Any]:
        """The decision that was flown."""
        return self.records[-1]


@dataclass
class FlightData:
    """A flight. ``helicopter`` and ``uav`` are the true tracks where the bag has them.

    ``planned``: by corner number. ``corners``: the true corners. ``scenario``: what the simulation
    was told, empty for a real flight. ``monitor``: the monitor's last state, empty without one.
    """

    helicopter: Track
    uav: Track
    planned: dict[int, PlannedCorner]
    corners: list[dict[str, Any]]
    mission: dict[str, Any]
    scenario: dict[str, Any]
    monitor: dict[str, Any]
    simulated: bool


def read_flight(bag: Path) -> FlightData:
    """Read a bag. Raises ``ValueError`` when it has no position of either aircraft."""
    samples: dict[str, list[tuple[float, float, float, float]]] = {}
    lists: dict[float, FloatArray] = {}
    records: dict[int, list[dict[str, Any]]] = {}
    texts: dict[str, list[dict[str, Any]]] = {}
    for topic, _, message in read_messages(bag, WANTED):
        if topic in ODOMETRY:
            motion = odometry_to_motion(message)
            yaw = to_yaw(message.pose.pose.orientation)
            samples.setdefault(topic, []).append((motion.time_s, motion.x_m, motion.y_m, yaw))
        elif topic == topics.WAYPOINTS:
            lists[round(from_stamp(message.header.stamp), 6)] = path_to_points(message)
        elif topic == topics.CORNER_PLAN:
            record = json.loads(message.data)
            records.setdefault(int(record["k"]), []).append(record)
        else:
            texts.setdefault(topic, []).append(json.loads(message.data))
    planned = {
        k: PlannedCorner(found, lists.get(round(found[-1]["list_time_s"], 6), np.empty((0, 2))))
        for k, found in records.items()
    }
    return FlightData(
        helicopter=_track(samples, topics.TRUE_HELICOPTER, topics.HELICOPTER_ODOMETRY),
        uav=_track(samples, topics.TRUE_UAV, topics.UAV_ODOMETRY),
        planned=planned,
        corners=texts.get(topics.TRUE_CORNER, []),
        mission=(texts.get(topics.MISSION) or [{}])[-1],
        scenario=(texts.get(topics.SCENARIO) or [{}])[-1],
        monitor=(texts.get(topics.MONITOR) or [{}])[-1],
        simulated=topics.TRUE_HELICOPTER in samples,
    )


def _track(samples: dict[str, list[tuple[float, float, float, float]]], *preferred: str) -> Track:
    for topic in preferred:
        if topic in samples:
            # A clock that was set back in flight leaves them out of order.
            values = np.array(sorted(samples[topic]))
            values = values[np.concatenate(([True], np.diff(values[:, 0]) > 0.0))]
            return Track(values[:, 0], values[:, 1:3], values[:, 3])
    raise ValueError(f"bag without {preferred[-1]}: nothing to report")
