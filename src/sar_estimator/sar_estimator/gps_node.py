"""Node ``gps``: a receiver at a serial port, a socket or gpsd; the helicopter's fixes out."""

from __future__ import annotations

import sys

from pydantic.dataclasses import dataclass
from rclpy.node import Node

from sar_estimator.common.checked import CHECKED, Positive
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import run_node
from sar_estimator.common.reader_node import ReaderNode
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
READ_S = 0.2


class GpsNode(ReaderNode):
    """Runs the receiver's component; a thread reads."""

    def __init__(self) -> None:
        """Open the receiver, and read it."""
        self._gps: GpsComponent
        self._source: Source
        super().__init__("gps", self._make)

    def _make(self, node: Node) -> GpsComponent:
        own = parameters(node, GpsParameters)
        self._source = Source(own.receiver)
        self._gps = GpsComponent(uere_m=own.uere_m)
        self.add_reader("receiver", lambda: self._source.read(READ_S), self._gps.receive)
        return self._gps

    def tell_component(self) -> None:
        """Tell how the source of its bytes is."""
        self._gps.failure, self._gps.breaks = self._source.failure, self._source.breaks

    def close(self) -> None:
        """Stop reading."""
        super().close()
        self._source.close()


def main() -> int:
    """Run the node."""
    return run_node("gps", GpsNode)


if __name__ == "__main__":
    sys.exit(main())
