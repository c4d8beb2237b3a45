"""Hands values from component to component in lockstep, as the graph does by messages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES, Component, Handler, Outputs
from sar_estimator.common.reports import UavReport
from sar_estimator.common.wires import WIRES
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.world.gps import Reception

Listener = Callable[[Any], None]


class Joined(NamedTuple):
    """A component, and the name of the UAV that it is of: its namespace."""

    component: Component
    uav: str = ""


class Taker(NamedTuple):
    """A component's handler of a topic, and the UAV that what comes of it is of."""

    handler: Handler
    uav: str


class Way(NamedTuple):
    """Where a topic's values go: its full name, a listener, and takers of what a message carries.

    ``carry``: returns what comes out of the message that a value goes into.
    """

    topic: str
    listener: Listener | None
    carry: Callable[[Any], Any]
    takers: Sequence[Taker]


def _unchanged(value: Any) -> Any:
    return value


class Bus:
    """Every value goes to all components that listen to its topic, at once and in their order.

    ``now_s``: the clock [s], to be set. ``record``: is called with everything that is published,
    before it is handed on. ``listeners``: others than components, by topic. Topics are those of the
    graph: what is of a UAV with a name begins with it.
    """

    def __init__(
        self,
        joined: Sequence[Joined],
        *,
        record: Callable[[str, Any], None] | None = None,
        listeners: dict[str, Listener] | None = None,
    ) -> None:
        """Join components."""
        self.now_s = 0.0
        self._record = record
        self._takers: dict[str, list[Taker]] = {}
        for one in joined:
            for topic, handler in one.component.inputs.items():
                takers = self._takers.setdefault(topics.of_uav(topic, one.uav), [])
                takers.append(Taker(handler, one.uav))
        self._listeners = listeners or {}
        self._ways: dict[tuple[str, str], Way] = {}

    def publish(self, topic: str, value: Any, uav: str = "") -> None:
        """Hand a value of a UAV to whoever listens, and what comes of that in turn."""
        if topic == NOTICES:
            return
        way = self._ways.get((topic, uav))
        if way is None:
            way = self._ways[topic, uav] = self._way(topic, uav)
        if self._record is not None:
            self._record(way.topic, value)
        if way.listener is not None:
            way.listener(value)
        if way.takers:
            carried = way.carry(value)
            for handler, of in way.takers:
                outputs = handler(carried, self.now_s)
                if outputs:
                    self.publish_all(outputs, of)

    def _way(self, topic: str, uav: str) -> Way:
        """Return who takes a topic of a UAV: those that have joined by now stay the same."""
        full = topics.of_uav(topic, uav)
        takers = self._takers.get(full, [])
        carry = WIRES[topic].carried if takers else _unchanged
        return Way(full, self._listeners.get(full), carry, takers)

    def publish_all(self, outputs: Outputs, uav: str = "") -> None:
        """Hand on all of a component's outputs."""
        for topic, value in outputs:
            self.publish(topic, value, uav)

    def start(self, joined: Iterable[Joined]) -> None:
        """Publish what components tell before anything is known."""
        for component, uav in joined:
            self.publish_all(component.start(self.now_s), uav)

    def tick(self, component: Component, uav: str = "") -> None:
        """Have a component do what is due."""
        self.publish_all(component.tick(self.now_s), uav)

    def receive(self, reception: Reception) -> None:
        """Publish what the helicopter's receiver gave."""
        self.publish_all(reception.told())

    def tell_uav(self, autopilot: SimAutopilot, uav: str = "") -> None:
        """Publish a UAV's telemetry."""
        self.publish(topics.WIND, autopilot.wind_estimate_mps, uav)
        motion = autopilot.motion.stamped(self.now_s)
        report = UavReport(motion, autopilot.state.heading_rad, autopilot.altitude_m)
        self.publish(topics.UAV_ODOMETRY, report, uav)
