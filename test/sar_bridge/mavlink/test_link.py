"""Real sockets and a real terminal pair."""

import os
import socket
import time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.link import Link, opener

VEHICLE = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
BEAT = mavlink.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3).pack(VEHICLE)


@pytest.mark.parametrize(
    "url", ["udp:127.0.0.1:14550", "tcp:127.0.0.1:5760", "/dev/ttyUSB0,57600", "/dev/ttyACM0"]
)
def test_good_urls(url):
    opener(url)


@pytest.mark.parametrize(
    "url", ["", "udp:14550", "tcp:host:port", "udp:127.0.0.1:99999", "COM3", "/dev/ttyUSB0,fast"]
)
def test_bad_urls_say_what_was_expected(url):
    with pytest.raises(ValueError, match=r"autopilot URL .*: expected"):
        opener(url)


def test_a_device_that_is_not_there_is_named():
    with pytest.raises(OSError, match=r"autopilot URL '/dev/ttyNONE9': .*"):
        Link("/dev/ttyNONE9")


def heard(link, timeout_s=5.0):
    deadline = time.monotonic() + timeout_s
    while time.monotonic() < deadline:
        messages = link.receive(0.05)
        if messages:
            return [message.get_type() for message in messages]
    return []


def free_port(kind):
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def test_udp_both_ways():
    port = free_port(socket.SOCK_DGRAM)
    ground = Link(f"udp:127.0.0.1:{port}")
    vehicle = Link(f"udpout:127.0.0.1:{port}", system=1, component=1)
    beat = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
    ground.send([beat])  # nobody is known yet: lost, no error
    vehicle.send([beat, beat])
    assert heard(ground) == ["HEARTBEAT", "HEARTBEAT"]
    ground.send([beat])
    assert heard(vehicle) == ["HEARTBEAT"]
    for link in (ground, vehicle):
        link.close()


def test_a_broken_tcp_connection_is_opened_again():
    port = free_port(socket.SOCK_STREAM)
    link = Link(f"tcp:127.0.0.1:{port}")  # nobody there yet
    link.send([mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)])
    for breaks in (0, 1):
        with socket.create_server(("127.0.0.1", port)) as server:
            server.settimeout(5.0)
            deadline = time.monotonic() + 5.0
            link.receive(0.05)
            while not link._transport and time.monotonic() < deadline:
                link.receive(0.05)
            connection, _ = server.accept()
            with connection:
                connection.sendall(BEAT[:7])
                assert link.receive(0.2) == []
                connection.sendall(BEAT[7:])
                assert heard(link) == ["HEARTBEAT"]
                assert link.breaks == breaks
        while link._transport:
            link.receive(0.05)
            link.send([mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)])
    link.close()


def test_serial_line():
    far, near = os.openpty()
    link = Link(f"{os.ttyname(near)},57600")
    os.write(far, BEAT)
    assert heard(link) == ["HEARTBEAT"]
    link.send([mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)])
    assert os.read(far, 100)[0] == 0xFD
    link.close()
    os.close(far)
    os.close(near)
