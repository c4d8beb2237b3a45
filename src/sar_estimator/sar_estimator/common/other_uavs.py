"""The other UAVs of a formation, as they are told of: where each is, and the list that it flies."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from sar_estimator.common import topics
from sar_estimator.common.component import Handler, Outputs
from sar_estimator.common.reports import UavReport, Uploaded, WaypointList
from sar_estimator.common.states import Motion

MOST_CLEARED = 8


@dataclass(frozen=True, slots=True)
class OtherUav:
    """Another UAV. ``flown``: the list that it flies, None where it is not known to fly one.

    ``altitude_m``: NaN where it is not known.
    """

    name: str
    motion: Motion
    altitude_m: float = math.nan
    flown: WaypointList | None = None

    def is_in_layer(self, altitude_m: float, layer_m: float) -> bool:
        """Whether altitude does not keep it apart from one at an altitude [m]."""
        apart_m = abs(self.altitude_m - altitude_m)
        return not apart_m >= layer_m  # also where one is not known


class OtherUavs:
    """What is told of UAVs by their names. ``inputs``: handlers by their topics."""

    def __init__(self, names: Iterable[str]) -> None:
        """Have heard of none. Raises ``ValueError`` for a name that is none, or is there twice."""
        wanted = tuple(names)
        if len(set(wanted)) < len(wanted) or not all(wanted):
            raise ValueError(f"other UAVs {list(wanted)}: expected different names")
        self._seen: dict[str, OtherUav] = {}
        self._cleared: dict[str, list[WaypointList]] = {name: [] for name in wanted}
        self._flown: dict[str, WaypointList | None] = dict.fromkeys(wanted)
        takers = {
            topics.UAV_ODOMETRY: self._see,
            topics.CLEARED: self._clear,
            topics.UPLOADED: self._upload,
        }
        self.inputs: Mapping[str, Handler] = {
            topics.of_uav(topic, name): _of(take, name)
            for name in wanted
            for topic, take in takers.items()
        }

    def near(
        self, now_s: float, altitude_m: float, *, layer_m: float, stale_s: float
    ) -> list[OtherUav]:
        """Return those seen not longer than ``stale_s`` ago that altitude does not keep apart.

        ``altitude_m``: one's own, NaN for unknown; ``layer_m``: that keeps apart.
        """
        return [
            one
            for one in self._seen.values()
            if now_s - one.motion.time_s <= stale_s and one.is_in_layer(altitude_m, layer_m)
        ]

    def _see(self, name: str, report: UavReport) -> None:
        if report.motion.is_finite():
            flown = self._flown[name]
            self._seen[name] = OtherUav(name, report.motion, report.altitude_m, flown)

    def _clear(self, name: str, waypoints: WaypointList) -> None:
        if len(waypoints.points) == 0:
            self._cleared[name], self._flown[name] = [], None
            return
        self._cleared[name] = [*self._cleared[name], waypoints][-MOST_CLEARED:]

    def _upload(self, name: str, uploaded: Uploaded) -> None:
        for waypoints in self._cleared[name]:
            if waypoints.list_id == uploaded.list_id:
                self._flown[name] = waypoints


def _of(take: Any, name: str) -> Handler:
    def handle(value: Any, _now_s: float) -> Outputs:
        take(name, value)
        return []

    return handle
