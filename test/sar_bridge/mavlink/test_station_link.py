"""A ground station that takes nothing makes nobody wait."""

import socket
import time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address, Addressed
from sar_bridge.mavlink.station_link import WAITING, StationLink

BEAT = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


def test_packets_come_as_they_are_and_messages_from_whom_they_are_said_to_be():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.bind(("127.0.0.1", 0))
        station.settimeout(5.0)
        link = StationLink(f"udpout:127.0.0.1:{station.getsockname()[1]}")
        packet = bytes(BEAT.pack(mavlink.MAVLink(None, srcSystem=9, srcComponent=3)))
        link.send(packet)
        assert station.recv(1000) == packet
        link.send(Addressed(Address(1, 191), BEAT))
        (heard,) = mavlink.MAVLink(None).parse_buffer(station.recv(1000))
        assert (heard.get_srcSystem(), heard.get_srcComponent()) == (1, 191)
        link.close()


def test_one_that_takes_nothing_is_not_waited_for():
    with socket.create_server(("127.0.0.1", 0)) as station:
        link = StationLink(f"tcp:127.0.0.1:{station.getsockname()[1]}")
        begun = time.monotonic()
        for _ in range(20 * WAITING):
            link.send(bytes(10_000))
        assert time.monotonic() - begun < 5.0
        assert link.lost > 0
        link.close()


@pytest.mark.parametrize("url", ["nowhere", "udp:here", "udp://", "udpout:127.0.0.1:0"])
def test_a_url_that_is_none_is_one_line(url):
    with pytest.raises(ValueError, match="gcs_url"):
        StationLink(url)
