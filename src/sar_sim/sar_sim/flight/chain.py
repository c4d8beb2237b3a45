"""One UAV in a flight offline: its planner, its monitor, and what takes its bridge's place."""

from __future__ import annotations

from typing import Any

from sar_bridge.monitor.component import MonitorComponent
from sar_estimator.common import topics
from sar_estimator.common.component import Answer
from sar_estimator.common.reports import UavStatus, Uploaded
from sar_planner.component import PlannerComponent
from sar_planner.mission_planner import MissionPlanner
from sar_planner.strategies.active_corner import Mode
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.presets import parameter_values
from sar_sim.flight.bus import Bus, Joined, Listener
from sar_sim.flight.upload import SimulatedBridge


class Chain:
    """Leads one UAV. ``name``: its namespace. ``planner``, ``monitor``: the components.

    ``is_led``: until it goes home.
    """

    def __init__(
        self,
        name: str,
        planner: PlannerComponent,
        monitor: MonitorComponent,
        bridge: SimulatedBridge,
        autopilot: SimAutopilot,
    ) -> None:
        """Join what belongs together."""
        self.name, self.planner, self.monitor = name, planner, monitor
        self._bridge, self._autopilot = bridge, autopilot
        self._told_mode = ""
        self.is_led = True

    @property
    def mission(self) -> MissionPlanner:
        """What decides."""
        return self.planner.planner

    @property
    def joined(self) -> tuple[Joined, Joined]:
        """The components, in the order in which they are told."""
        return Joined(self.planner, self.name), Joined(self.monitor, self.name)

    @property
    def listeners(self) -> dict[str, Listener]:
        """What goes to the autopilot."""
        return {
            topics.of_uav(topics.CLEARED, self.name): self._bridge.take,
            topics.of_uav(topics.SPEED, self.name): self._set_airspeed,
        }

    def _set_airspeed(self, airspeed_mps: float) -> None:
        self._autopilot.airspeed_mps = airspeed_mps

    def start(self, bus: Bus) -> None:
        """Tell how the autopilot is tuned, where it tells."""
        parameters = parameter_values(self._autopilot.uav)
        if parameters:
            bus.publish(topics.AUTOPILOT, parameters, self.name)

    def step(self, bus: Bus, time_s: float) -> None:
        """Tell of a list that has arrived by a mission's time [s]."""
        arrived = self._bridge.step(time_s)
        if arrived is not None:
            uploaded = Uploaded(arrived.list_id, len(arrived.points))
            bus.publish(topics.UPLOADED, uploaded, self.name)

    def tell(self, bus: Bus) -> None:
        """Tell how the UAV is, and where."""
        autopilot = self._autopilot
        if autopilot.mode.name != self._told_mode:
            self._told_mode = autopilot.mode.name
            ratio = autopilot.uav.airspeed_ratio
            status = UavStatus(self._told_mode, armed=True, connected=True, airspeed_ratio=ratio)
            bus.publish(topics.UAV_STATE, status, self.name)
        bus.tell_uav(autopilot, self.name)

    def decide(self, bus: Bus) -> None:
        """Have the planner decide; engaged as soon as it agrees."""
        if not self.is_led:
            return
        if self.mission.mode is Mode.IDLE:
            self.ask(bus, topics.ENGAGE)
        else:
            bus.tick(self.planner, self.name)

    def leave(self) -> None:
        """Send the UAV home, as its pilot does: it is led no more."""
        self._autopilot.set_mode(FlightMode.RTL)
        self.is_led = False

    def ask(self, bus: Bus, service: str) -> Answer:
        """Ask the planner for something; return its answer."""
        answer = self.planner.services[service](bus.now_s)
        bus.publish_all(answer.outputs, self.name)
        return answer

    def report(self, bus: Bus) -> None:
        """Tell what is told once a second."""
        bus.publish_all(self.planner.report(bus.now_s), self.name)
        health: Any = self.planner.health(bus.now_s)
        bus.publish(topics.DIAGNOSTICS, health, self.name)

    def guard(self, bus: Bus) -> None:
        """Have the monitor look."""
        bus.tick(self.monitor, self.name)
