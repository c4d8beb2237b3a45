"""Node ``bridge``: waypoint lists to the autopilot, its telemetry to the graph, over MAVLink 2."""

from __future__ import annotations

import sys
import threading
import time
from typing import Annotated, Any

from pydantic import Field
from pydantic.dataclasses import dataclass
from rclpy.node import Node

from sar_bridge.mavlink.link import Link
from sar_bridge.mavlink.signing import Signer
from sar_bridge.session.component import LINK, BridgeComponent
from sar_estimator.common.checked import CHECKED
from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import now_s, run_node


@dataclass(frozen=True, config=CHECKED)
class BridgeParameters:
    """Parameters of the node.

    autopilot_url: `udp:HOST:PORT` (listens), `tcp:HOST:PORT` (connects), `/dev/NAME,BAUD`.
    altitude_m: of every waypoint, above the UAV's home. target_system: MAVLink system to talk to;
    0 for the first autopilot heard. signing_key_file: file with a MAVLink 2 signing key, mode 600;
    without one nothing is signed. node_timeout_s: planner or monitor silent for so long: no more
    heartbeats to the autopilot while a list is flown. link_timeout_s: without a heartbeat of the
    autopilot, after which it is not heard any more.
    """

    autopilot_url: str = "udp:127.0.0.1:14550"
    altitude_m: float = 150.0
    target_system: Annotated[int, Field(ge=0, le=255)] = 0
    signing_key_file: str = ""
    node_timeout_s: Annotated[float, Field(ge=2.0)] = 4.0
    link_timeout_s: Annotated[float, Field(ge=1.5)] = 3.0


PARAMETERS = (BridgeParameters,)


class BridgeNode(ComponentNode):
    """Runs the bridge's component; a thread reads the link."""

    by_wall_clock = True

    def __init__(self) -> None:
        """Open the link, and read it."""
        self._bridge: BridgeComponent
        self._link: Link
        self._running = True
        super().__init__("bridge", self._make)
        self._reader = threading.Thread(target=self._read, name="mavlink", daemon=True)
        self._reader.start()

    def _make(self, node: Node) -> BridgeComponent:
        own = parameters(node, BridgeParameters)
        key = own.signing_key_file
        self._link = Link(own.autopilot_url, signer=Signer(key, time.time()) if key else None)
        self._bridge = BridgeComponent(
            altitude_m=own.altitude_m,
            target_system=own.target_system,
            node_timeout_s=own.node_timeout_s,
            link_timeout_s=own.link_timeout_s,
        )
        return self._bridge

    def close(self) -> None:
        """Stop reading and close the link."""
        self._running = False
        self._reader.join(timeout=2.0)
        self._link.close()

    def _read(self) -> None:
        while self._running:
            received = self._link.receive(0.05)
            if not received:
                continue
            with self.lock:
                for message in received:
                    self.publish(self._bridge.receive(message, self.component_s()))

    def component_s(self) -> float:
        """Return a monotonic clock [s], and tell the component the graph's."""
        self._bridge.ros_s = now_s(self)
        self._bridge.link_breaks = self._link.breaks
        return time.monotonic()

    def send(self, topic: str, value: Any) -> None:
        """Send messages to the autopilot, and publish everything else while the node runs."""
        if topic == LINK:
            self._link.send(value)
        elif self._running:
            super().send(topic, value)


def main() -> int:
    """Run the node."""
    return run_node("bridge", BridgeNode)


if __name__ == "__main__":
    sys.exit(main())
