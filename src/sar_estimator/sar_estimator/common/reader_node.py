"""A node whose component is also fed by threads that read: a radio link, a receiver."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from sar_estimator.common.component import Component, Outputs
from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_support import now_s

JOIN_S = 2.0


class ReaderNode(ComponentNode):
    """Runs a component by the machine's clock; readers feed it as they read.

    The component has ``ros_s``, which is set to the graph's clock [s] before every call.
    """

    by_wall_clock = True

    def __init__(self, name: str, make: Callable[[Node], Component]) -> None:
        """Make the component, which may ``add_reader``; then read."""
        self.running = True
        self._readers: list[threading.Thread] = []
        super().__init__(name, make)
        for reader in self._readers:
            reader.start()

    def add_reader(
        self, name: str, read: Callable[[], Any], take: Callable[[Any, float], Outputs]
    ) -> None:
        """Have a thread hand what ``read`` returns, where that is anything, to ``take``.

        ``read`` waits, for less than a second.
        """

        def work() -> None:
            while self.running:
                found = read()
                if found:
                    with self.lock:
                        self.publish(take(found, self.component_s()))

        self._readers.append(threading.Thread(target=work, name=name, daemon=True))

    def tell_component(self) -> None:
        """Tell the component what else it is to know before every call."""

    def component_s(self) -> float:
        """Return a monotonic clock [s], and tell the component the graph's."""
        self._component.ros_s = now_s(self)  # type: ignore[attr-defined]
        self.tell_component()
        return time.monotonic()

    def close(self) -> None:
        """Stop reading."""
        self.running = False
        for reader in self._readers:
            reader.join(timeout=JOIN_S)
