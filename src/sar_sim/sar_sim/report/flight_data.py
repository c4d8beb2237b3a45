"""What a bag tells of a flight, as arrays: the one input of metrics, figures and report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sar_estimator.bags.bag import read_messages, topics_in
from sar_estimator.common import topics
from sar_estimator.common.checked import read
from sar_estimator.common.conversions import (
    list_id_of,
    odometry_to_motion,
    path_to_points,
    to_yaw,
)
from sar_estimator.common.reports import CornerRecord, MonitorReport
from sar_planner.patterns.legs import ends_of
from sar_sim.report.coverage import FloatArray
from sar_sim.scenario.scenario import Pattern
from sar_sim.world.helicopter import CornerTruth, flown_legs
from sar_sim.world.wires import ALL_WIRES

ODOMETRY = {
    topics.HELICOPTER_ODOMETRY,
    topics.UAV_ODOMETRY,
    topics.TRUE_HELICOPTER,
    topics.TRUE_UAV,
}
LISTS = {topics.WAYPOINTS, topics.CORNER_PATH}
STATUSES = {
    topics.TRUE_CORNER,
    topics.CORNER_PLAN,
    topics.MISSION,
    topics.SCENARIO,
    topics.MONITOR,
}
WANTED = ODOMETRY | LISTS | STATUSES
NOWHERE = np.empty((0, 2))


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
    """Every record of one corner, oldest first; of the last the waypoints and the planned curve.

    ``waypoints``, ``curve``: shape (n, 2) [m].
    """

    records: list[CornerRecord]
    waypoints: FloatArray
    curve: FloatArray

    @property
    def first(self) -> CornerRecord:
        """The first decision."""
        return self.records[0]

    @property
    def last(self) -> CornerRecord:
        """The decision that was flown."""
        return self.records[-1]


@dataclass
class FlightData:
    """A UAV's flight. ``helicopter`` and ``uav`` are the true tracks where the bag has them.

    ``name``: the UAV's, empty for one alone. ``planned``: by corner number. ``corners``: the true
    corners. ``missions``: the parameters that were flown with, from when on [s], oldest first: they
    are told again when the slot is changed. ``scenario``: what was simulated, empty for a real
    flight; both as texts by key, since they may be of another version. ``monitor``: the monitor's
    last report.
    """

    helicopter: Track
    uav: Track
    planned: dict[int, PlannedCorner]
    corners: list[CornerTruth]
    missions: list[tuple[float, dict[str, Any]]]
    scenario: dict[str, Any]
    monitor: MonitorReport
    simulated: bool
    name: str = ""

    @property
    def ordered_m(self) -> FloatArray:
        """The pattern that a simulated helicopter was ordered to fly, shape (n, 2) [m].

        Its start, corners and end; no points behind any other helicopter. Raises ``ValueError`` for
        a pattern of another version.
        """
        if not self.simulated or "pattern" not in self.scenario:
            return NOWHERE
        pattern = read(Pattern, self.scenario["pattern"], "pattern", texts=True)
        return np.vstack((pattern.start[:2], ends_of(flown_legs(pattern), pattern.start)))


class _Told:
    """What a bag tells of one UAV, or of what all share."""

    def __init__(self) -> None:
        self.samples: dict[str, list[tuple[float, float, float, float]]] = {}
        self.lists: dict[tuple[str, int], FloatArray] = {}
        self.records: dict[int, list[CornerRecord]] = {}
        self.values: dict[str, list[Any]] = {}
        self.missions: list[tuple[float, dict[str, Any]]] = []

    def take(self, topic: str, message: Any, time_s: float) -> None:
        if topic in ODOMETRY:
            motion = odometry_to_motion(message)
            yaw = to_yaw(message.pose.pose.orientation)
            sample = motion.time_s, motion.x_m, motion.y_m, yaw
            self.samples.setdefault(topic, []).append(sample)
        elif topic in LISTS:
            self.lists[topic, list_id_of(message)] = path_to_points(message)
        elif topic == topics.CORNER_PLAN:
            record = ALL_WIRES[topic].from_message(message)
            self.records.setdefault(record.k, []).append(record)
        elif topic == topics.MISSION:
            self.missions.append((time_s, ALL_WIRES[topic].from_message(message)))
        else:
            self.values.setdefault(topic, []).append(ALL_WIRES[topic].from_message(message))

    def flight(self, shared: _Told, name: str) -> FlightData:
        """Return a UAV's flight, with what all share."""
        planned = {
            k: PlannedCorner(
                found,
                self.lists.get((topics.WAYPOINTS, found[-1].list_id), NOWHERE),
                self.lists.get((topics.CORNER_PATH, found[-1].list_id), NOWHERE),
            )
            for k, found in self.records.items()
        }
        helicopter = topics.TRUE_HELICOPTER, topics.HELICOPTER_ODOMETRY
        return FlightData(
            helicopter=_track(shared.samples, *helicopter),
            uav=_track(self.samples, topics.TRUE_UAV, topics.UAV_ODOMETRY),
            planned=planned,
            corners=shared.values.get(topics.TRUE_CORNER, []),
            missions=self.missions,
            scenario=(shared.values.get(topics.SCENARIO) or [{}])[-1],
            monitor=(self.values.get(topics.MONITOR) or [MonitorReport()])[-1],
            simulated=topics.TRUE_HELICOPTER in shared.samples,
            name=name,
        )


def read_flights(bag: Path) -> list[FlightData]:
    """Read a bag: the flight of every UAV in it, by name.

    Raises ``ValueError`` when it has no position of an aircraft.
    """
    shared = _Told()
    own: dict[str, _Told] = {}
    wanted = {name for name in topics_in(bag) if topics.plain(name) in WANTED}
    for topic, time_s, message in read_messages(bag, wanted):
        plain = topics.plain(topic)
        if plain in topics.OF_UAV:
            own.setdefault(topics.uav_of(topic), _Told()).take(plain, message, time_s)
        else:
            shared.take(plain, message, time_s)
    seen = sorted(name for name, told in own.items() if told.samples) or [""]
    return [own.get(name, _Told()).flight(shared, name) for name in seen]


def read_flight(bag: Path) -> FlightData:
    """Read the flight of the first UAV in a bag: see ``read_flights``."""
    return read_flights(bag)[0]


def _track(samples: dict[str, list[tuple[float, float, float, float]]], *preferred: str) -> Track:
    for topic in preferred:
        if topic in samples:
            # A clock that was set back in flight leaves them out of order.
            values = np.array(sorted(samples[topic]))
            values = values[np.concatenate(([True], np.diff(values[:, 0]) > 0.0))]
            return Track(values[:, 0], values[:, 1:3], values[:, 3])
    raise ValueError(f"bag without {preferred[-1]}: nothing to report")
