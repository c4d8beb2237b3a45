"""One radio for several bridges, over real sockets."""

import socket
import time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.hub import Hub
from sar_bridge.mavlink.link import Link

pytestmark = pytest.mark.timeout(30)


def free_ports(count):
    probes = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]
    for probe in probes:
        probe.bind(("127.0.0.1", 0))
    ports = [probe.getsockname()[1] for probe in probes]
    for probe in probes:
        probe.close()
    return ports


def heartbeat():
    return mavlink.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3)


@pytest.fixture
def joined():
    """A hub, what is on the radio, and two bridges."""
    air_port, *ports = free_ports(3)
    air = Link(f"udp:127.0.0.1:{air_port}", system=7, component=1)
    bridges = [Link(f"udp:127.0.0.1:{port}") for port in ports]
    branches = [Link(f"udpout:127.0.0.1:{port}") for port in ports]
    hub = Hub(Link(f"udpout:127.0.0.1:{air_port}"), branches)
    yield hub, air, bridges
    hub.close()
    for link in (air, *bridges):
        link.close()


def heard(link, within_s=10.0):
    ends = time.monotonic() + within_s
    while time.monotonic() < ends:
        found = link.receive(0.2)
        if found:
            return found
    return []


def test_every_packet_goes_to_the_other_side_as_it_is(joined):
    hub, air, bridges = joined
    # The radio's other end answers whom it hears: a bridge speaks first, as bridges do.
    hub.trunk.send([heartbeat()])
    assert heard(air)
    air.send([heartbeat()])
    for bridge in bridges:
        (message,) = heard(bridge)
        assert (message.get_srcSystem(), message.get_srcComponent()) == (7, 1)
    for i, bridge in enumerate(bridges):
        bridge.send([mavlink.MAVLink_statustext_message(6, f"bridge {i}".encode())])
        (message,) = heard(air)
        assert message.text == f"bridge {i}"
        assert message.get_srcSystem() == 255
    assert hub.passed == 3


def test_bridges_do_not_hear_each_other(joined):
    hub, air, (one, other) = joined
    hub.trunk.send([heartbeat()])
    assert heard(air)
    air.send([heartbeat()])
    assert heard(one)
    assert heard(other)
    one.send([heartbeat()])
    assert heard(air)
    assert other.receive(0.3) == []
