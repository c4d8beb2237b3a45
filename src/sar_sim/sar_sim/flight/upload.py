"""What takes the bridge's place in a flight without sockets: lists to the simulated autopilot."""

from __future__ import annotations

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.mavlink.mission_items import first_ahead
from sar_bridge.mission.mission_slots import CaptureWaypoints, MissionSlots, Write
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import WaypointList
from sar_estimator.common.states import FloatArray
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.presets import parameter_values

JOINING_ITEMS = 4


class SimulatedBridge:
    """Takes lists to the autopilot as the bridge does: one after the other, the newest next.

    ``item_s``: how long an item takes; ``latency_s``: a list, beside its items.
    """

    def __init__(
        self,
        autopilot: SimAutopilot,
        datum: Datum,
        *,
        altitude_m: float,
        item_s: float,
        latency_s: float = 0.0,
    ) -> None:
        """Nothing is under way."""
        self._autopilot, self._datum = autopilot, datum
        self._slots = MissionSlots(altitude_m=altitude_m)
        self._item_s, self._latency_s = item_s, latency_s
        self._newest: WaypointList | None = None
        self._under_way: WaypointList | None = None
        self._arrives_s = 0.0

    def take(self, waypoints: WaypointList) -> None:
        """Upload a list next; one without points is none."""
        if len(waypoints.points):
            self._newest = waypoints

    def step(self, time_s: float) -> WaypointList | None:
        """Return the list that has arrived at the autopilot by ``time_s`` [s], if any."""
        arrived = None
        if self._under_way is not None and time_s >= self._arrives_s:
            arrived, self._under_way = self._under_way, None
            load_list(
                self._autopilot,
                self._slots,
                arrived.points,
                self._datum,
                climb_m=arrived.climb_m,
            )
        if self._under_way is None and self._newest is not None:
            self._under_way, self._newest = self._newest, None
            items = len(self._under_way.points) + JOINING_ITEMS
            self._arrives_s = time_s + self._latency_s + items * self._item_s
        return arrived


def load_list(
    autopilot: SimAutopilot,
    slots: MissionSlots,
    points: FloatArray,
    datum: Datum,
    *,
    climb_m: float = 0.0,
) -> None:
    """Put a list, shape (n, 2) [m], into its slot and lead over to it, as the bridge does."""
    if autopilot.mode is not FlightMode.AUTO or not slots.takes(points):
        autopilot.load(slots.whole(points, datum, climb_m=climb_m))
        autopilot.set_current(first_ahead(points, autopilot.motion) + 1)
        autopilot.set_mode(FlightMode.AUTO)
        return
    _put(autopilot, slots.fill(points, datum, autopilot.current, climb_m=climb_m))
    told = parameter_values(autopilot.uav)
    tuning = FollowerTuning.read(told)
    step = slots.join(autopilot.current, autopilot.motion, datum, within_s=0.0, tuning=tuning)
    _put(autopilot, step)
    if isinstance(step, CaptureWaypoints):
        autopilot.set_current(step.start)


def _put(autopilot: SimAutopilot, write: Write) -> None:
    for i, item in enumerate(write.items):
        autopilot.replace_item(write.start + i, item)
