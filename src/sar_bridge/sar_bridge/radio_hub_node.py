"""Node ``radio_hub``: one radio that several UAVs are on, for a bridge each."""

from __future__ import annotations

import sys
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass
from rclpy.node import Node

from sar_bridge.mavlink.hub import Hub
from sar_bridge.mavlink.link import Link
from sar_estimator.common import topics
from sar_estimator.common.checked import CHECKED
from sar_estimator.common.component_node import publisher
from sar_estimator.common.conversions import diagnostics
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import now_s, report_each_second, run_node

Port = Annotated[int, Field(ge=1, le=65535)]


@dataclass(frozen=True, config=CHECKED)
class RadioHubParameters:
    """Parameters of the node.

    radio_url: of the radio, as a bridge's `autopilot_url`. ports: UDP ports on loopback at which
    the bridges listen, `udp:127.0.0.1:PORT`.
    """

    radio_url: str = ""
    ports: tuple[Port, ...] = (14551, 14552)


PARAMETERS = (RadioHubParameters,)


class RadioHubNode(Node):
    """Passes packets between a radio and the bridges, and tells how many."""

    def __init__(self) -> None:
        """Open the links. Raises ``ValueError`` and ``OSError`` where that cannot be."""
        super().__init__("radio_hub")
        own = parameters(self, RadioHubParameters)
        trunk = Link(own.radio_url, what="radio_url")
        self._hub = Hub(trunk, [Link(f"udpout:127.0.0.1:{port}") for port in own.ports])
        self._sender = publisher(self, topics.DIAGNOSTICS)
        report_each_second(self, self._tell)

    def _tell(self) -> None:
        values: dict[str, object] = {
            "packets": self._hub.passed,
            "link_breaks": self._hub.trunk.breaks,
        }
        message = diagnostics(now_s(self), "radio_hub", problem="", values=values)
        self._sender.publish(message)

    def close(self) -> None:
        """Close the links."""
        self._hub.close()


def main() -> int:
    """Run the node."""
    return run_node("radio_hub", RadioHubNode)


if __name__ == "__main__":
    sys.exit(main())
