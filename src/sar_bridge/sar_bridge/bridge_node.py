"""Node ``bridge``: waypoint lists to the autopilot, its telemetry to the graph, over MAVLink 2."""

from __future__ import annotations

import sys
import time
from functools import partial
from typing import Annotated, Any

from pydantic import Field
from pydantic.dataclasses import dataclass
from rclpy.node import Node

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.link import GROUND_COMPONENT, GROUND_SYSTEM, Link
from sar_bridge.mavlink.signing import Signer
from sar_bridge.mavlink.station_link import StationLink
from sar_bridge.session.component import LINK, STATIONS, BridgeComponent
from sar_estimator.common.checked import CHECKED
from sar_estimator.common.component import Outputs
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import run_node
from sar_estimator.common.reader_node import ReaderNode


@dataclass(frozen=True, config=CHECKED)
class BridgeParameters:
    """Parameters of the node.

    autopilot_url: `udp:HOST:PORT` (listens), `tcp:HOST:PORT` (connects), `/dev/NAME,BAUD`.
    altitude_m: of every waypoint, above the UAV's home. target_system: MAVLink system to talk to;
    0 for the first autopilot heard. signing_key_file: file with a MAVLink 2 signing key, mode 600;
    without one nothing is signed. node_timeout_s: planner or monitor silent for so long: no more
    heartbeats to the autopilot while a list is flown. link_timeout_s: without a heartbeat of the
    autopilot, after which it is not heard any more. gcs_url: ground stations beside, URLs with
    spaces between; `udpout:HOST:PORT` sends to one that listens there. source_system,
    source_component: the bridge's own MAVLink address; the system is the autopilot's
    MAV_GCS_SYSID, the address no ground station's. helicopter_icao: the helicopter's ICAO address,
    six hexadecimal digits: what the UAV's ADS-B receiver hears of it is compared with its GPS.
    """

    autopilot_url: str = "udp:127.0.0.1:14550"
    altitude_m: float = 150.0
    target_system: Annotated[int, Field(ge=0, le=255)] = 0
    signing_key_file: str = ""
    node_timeout_s: Annotated[float, Field(ge=2.0)] = 4.0
    link_timeout_s: Annotated[float, Field(ge=1.5)] = 3.0
    gcs_url: str = ""
    source_system: Annotated[int, Field(ge=1, le=255)] = GROUND_SYSTEM
    source_component: Annotated[int, Field(ge=1, le=255)] = GROUND_COMPONENT
    helicopter_icao: str = ""


PARAMETERS = (BridgeParameters,)
READ_S = 0.05


class BridgeNode(ReaderNode):
    """Runs the bridge's component; threads read the link, and those to ground stations."""

    def __init__(self) -> None:
        """Open the links, and read them."""
        self._bridge: BridgeComponent
        self._link: Link
        self._stations: list[StationLink] = []
        super().__init__("bridge", self._make)

    def _make(self, node: Node) -> BridgeComponent:
        own = parameters(node, BridgeParameters)
        key = own.signing_key_file
        signer = Signer(key, time.time()) if key else None
        address = Address(own.source_system, own.source_component)
        self._link = Link(
            own.autopilot_url,
            system=address.system,
            component=address.component,
            signer=signer,
        )
        self._stations = [StationLink(url, signer) for url in own.gcs_url.split()]
        self._bridge = BridgeComponent(
            altitude_m=own.altitude_m,
            target_system=own.target_system,
            node_timeout_s=own.node_timeout_s,
            link_timeout_s=own.link_timeout_s,
            own=address,
            stations=len(self._stations),
            helicopter_icao=own.helicopter_icao,
        )
        self.add_reader("mavlink", lambda: self._link.receive(READ_S), self._take)
        for number, station in enumerate(self._stations):
            take = partial(self._take_station, number)
            self.add_reader(f"station {number}", partial(station.receive, READ_S), take)
        return self._bridge

    def _take(self, messages: list[Any], now_s: float) -> Outputs:
        return [one for message in messages for one in self._bridge.receive(message, now_s)]

    def _take_station(self, number: int, messages: list[Any], now_s: float) -> Outputs:
        take = self._bridge.receive_station
        return [one for message in messages for one in take(number, message, now_s)]

    def tell_component(self) -> None:
        """Tell how the link is."""
        self._bridge.link_breaks = self._link.breaks

    def close(self) -> None:
        """Stop reading and close the links."""
        super().close()
        self._link.close()
        for station in self._stations:
            station.close()

    def send(self, topic: str, value: Any) -> None:
        """Send messages over the links, and publish everything else while the node runs."""
        if topic == LINK:
            self._link.send(value)
        elif topic == STATIONS:
            number, message = value
            self._stations[number].send(message)
        elif self.running:
            super().send(topic, value)


def main() -> int:
    """Run the node."""
    return run_node("bridge", BridgeNode)


if __name__ == "__main__":
    sys.exit(main())
