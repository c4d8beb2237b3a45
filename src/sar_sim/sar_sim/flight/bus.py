"""Hands values from component to component in lockstep, as the graph does by messages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES, Component, Outputs
from sar_estimator.common.reports import UavReport
from sar_estimator.common.wires import WIRES
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.world.gps import Reception

Listener = Callable[[Any], None]


class Bus:
    """Every value goes to all components that listen to its topic, at once and in their order.

    ``now_s``: the clock [s], to be set. ``record``: is called with everything that is published,
    before it is handed on. ``listeners``: others than components, by topic.
    """

    def __init__(
        self,
        components: Sequence[Component],
        *,
        record: Callable[[str, Any], None] | None = None,
        listeners: dict[str, Listener] | None = None,
    ) -> None:
        """Join components."""
        self.now_s = 0.0
        self._record = record
        self._takers: dict[str, list[Component]] = {}
        for component in components:
            for topic in component.inputs:
                self._takers.setdefault(topic, []).append(component)
        self._listeners = listeners or {}

    def publish(self, topic: str, value: Any) -> None:
        """Hand a value to whoever listens, and what comes of that in turn."""
        if topic == NOTICES:
            return
        if self._record is not None:
            self._record(topic, value)
        if topic in self._listeners:
            self._listeners[topic](value)
        takers = self._takers.get(topic)
        if takers:
            carried = WIRES[topic].carried(value)
            for component in takers:
                self.publish_all(component.handle(topic, carried, self.now_s))

    def publish_all(self, outputs: Outputs) -> None:
        """Hand on all of a component's outputs."""
        for topic, value in outputs:
            self.publish(topic, value)

    def start(self, components: Iterable[Component]) -> None:
        """Publish what components tell before anything is known."""
        for component in components:
            self.publish_all(component.start(self.now_s))

    def tick(self, component: Component) -> None:
        """Have a component do what is due."""
        self.publish_all(component.tick(self.now_s))

    def receive(self, reception: Reception) -> None:
        """Publish what the helicopter's receiver gave."""
        self.publish_all(reception.told())

    def tell_uav(self, autopilot: SimAutopilot) -> None:
        """Publish the UAV's telemetry."""
        self.publish(topics.WIND, autopilot.wind_estimate_mps)
        motion = autopilot.motion.stamped(self.now_s)
        report = UavReport(motion, autopilot.state.heading_rad, autopilot.altitude_m)
        self.publish(topics.UAV_ODOMETRY, report)
