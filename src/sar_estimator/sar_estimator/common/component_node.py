"""The one node that runs any component."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from std_srvs.srv import Trigger

from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES, Answer, Component, Notice, Outputs
from sar_estimator.common.frames import Frames
from sar_estimator.common.node_support import (
    LATCHED,
    RELIABLE,
    now_s,
    report_each_second,
)
from sar_estimator.common.wires import WIRES, Quality, Wire

QUALITIES: dict[Quality, QoSProfile] = {
    Quality.RELIABLE: RELIABLE,
    Quality.LATCHED: LATCHED,
    Quality.SENSOR: qos_profile_sensor_data,
}
THROTTLE_S = 5.0
CLOCK_STEP_S = 1.0


def publisher(node: Node, topic: str, wires: Mapping[str, Wire] = WIRES) -> Any:
    """Return a node's publisher of a topic, as the table has it."""
    wire = wires[topics.plain(topic)]
    return node.create_publisher(wire.kind, topics.name_of(topic), QUALITIES[wire.quality])


def subscribe(node: Node, topic: str, callback: Callable[[Any], None]) -> None:
    """Have a node listen to a topic, as the table has it."""
    wire = WIRES[topics.plain(topic)]
    node.create_subscription(wire.kind, topics.name_of(topic), callback, QUALITIES[wire.quality])


class ComponentNode(Node):
    """Feeds a component with messages and the clock, and publishes what it gives.

    ``by_wall_clock``: whether it is ticked by the machine's clock, not by the graph's. ``lock``: is
    held while the component works, for those that other threads feed too.
    """

    by_wall_clock = False

    def __init__(self, name: str, make: Callable[[Node], Component]) -> None:
        """Make the component, which may declare parameters; create topics, services, timers."""
        super().__init__(name)
        self.lock = threading.RLock()
        self._component = make(self)
        self._newest_s = 0.0
        self._frames = Frames(self.get_namespace(), self.create_publisher)
        self._senders = {topic: publisher(self, topic) for topic in self._component.outputs}
        for topic in self._component.inputs:
            subscribe(self, topic, self._taker(topic))
        for service, answer in self._component.services.items():
            self.create_service(Trigger, topics.name_of(service), self._server(service, answer))
        wall = Clock(clock_type=ClockType.STEADY_TIME) if self.by_wall_clock else None
        self.create_timer(self._component.period_s, self._on_timer, clock=wall)
        report_each_second(self, self._on_report)
        self.publish(self._component.start(self.component_s()))

    def component_s(self) -> float:
        """Return the time [s] that the component goes by: the graph's."""
        return now_s(self)

    def _taker(self, topic: str) -> Callable[[Any], None]:
        wire = WIRES[topics.plain(topic)]

        def take(message: Any) -> None:
            try:
                value = wire.from_message(message)
            except ValueError as error:
                self.get_logger().warning(f"{topic}: {error}", throttle_duration_sec=THROTTLE_S)
                return
            with self.lock:
                self.publish(self._component.handle(topic, value, self.component_s()))
                if topic in self._component.urgent:
                    self._on_timer()

        return take

    def _server(
        self, service: str, answer: Callable[[float], Answer]
    ) -> Callable[[Trigger.Request, Trigger.Response], Trigger.Response]:
        def serve(_request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
            with self.lock:
                found = answer(self.component_s())
                response.success, response.message = found.success, found.message
                self.get_logger().info(f"{service.rpartition('/')[2]}: {found.message}")
                self.publish(found.outputs)
            return response

        return serve

    def _on_timer(self) -> None:
        with self.lock:
            now = self.component_s()
            if now < self._newest_s - CLOCK_STEP_S:
                self.get_logger().warning(f"clock set back by {self._newest_s - now:.1f} s")
                self._component.set_clock_back()
            self._newest_s = now
            self.publish(self._component.tick(now))

    def _on_report(self) -> None:
        with self.lock:
            now = self.component_s()
            health = self._component.health(now)
            self.publish([*self._component.report(now), (topics.DIAGNOSTICS, health)])

    def publish(self, outputs: Outputs) -> None:
        """Publish what the component gives, and log its notices."""
        for topic, value in outputs:
            if topic == NOTICES:
                self._log(value)
            else:
                self.send(topic, value)

    def send(self, topic: str, value: Any) -> None:
        """Publish a value."""
        message = WIRES[topic].to_message(value, now_s(self))
        self._senders[topic].publish(message)
        self._frames.broadcast(topic, message)

    def _log(self, notice: Notice) -> None:
        log = self.get_logger()
        # rclpy tells calls apart by their place: one line for each level.
        if notice.level == "error":
            log.error(notice.text)
        elif notice.level == "warning":
            log.warning(notice.text)
        else:
            log.info(notice.text)
