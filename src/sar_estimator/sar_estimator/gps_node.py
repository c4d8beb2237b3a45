"""Node ``gps``: a receiver at a serial port, a socket or gpsd; the helicopter's fixes out."""

from __future__ import annotations

import sys
import threading
import time

from pydantic.dataclasses import dataclass
from rclpy.node import Node

from sar_estimator.common.checked import CHECKED, Positive
from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import now_s, run_node
from sar_estimator.gps.component import GpsComponent
from sar_estimator.gps.source import Source


@dataclass(frozen=True, config=CHECKED)
class GpsParameters:
    """Parameters of the node.

    receiver: `/dev/NAME,BAUD`, `tcp:HOST:PORT` (connects), `udp:HOST:PORT` (listens), `gpsd:HOST`.
    uere_m: standard deviation of a range, by which HDOP becomes an accuracy where the receiver
    tells no other.
    """

    receiver: str = "gpsd:127.0.0.1"
    uere_m: Positive = 5.0


PARAMETERS = (GpsParameters,)


class GpsNode(ComponentNode):
    """Runs the receiver's component; a thread reads."""

    by_wall_clock = True

    def __init__(self) -> None:
        """Open the receiver, and read it."""
        self._gps: GpsComponent
        self._source: Source
        self._running = True
        super().__init__("gps", self._make)
        self._reader = threading.Thread(target=self._read, name="receiver", daemon=True)
        self._reader.start()

    def _make(self, node: Node) -> GpsComponent:
        own = parameters(node, GpsParameters)
        self._source = Source(own.receiver)
        self._gps = GpsComponent(uere_m=own.uere_m)
        return self._gps

    def close(self) -> None:
        """Stop reading."""
        self._running = False
        self._reader.join(timeout=2.0)
        self._source.close()

    def _read(self) -> None:
        while self._running:
            data = self._source.read(0.2)
            if data:
                with self.lock:
                    self.publish(self._gps.receive(data, self.component_s()))

    def component_s(self) -> float:
        """Return a monotonic clock [s], and tell the component the graph's."""
        self._gps.ros_s = now_s(self)
        self._gps.failure, self._gps.breaks = self._source.failure, self._source.breaks
        return time.monotonic()


def main() -> int:
    """Run the node."""
    return run_node("gps", GpsNode)


if __name__ == "__main__":
    sys.exit(main())
