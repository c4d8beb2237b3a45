"""Bytes from pseudo-terminals and sockets, which go away and come back."""

import contextlib
import os
import pty
import socket
import time

import pytest

from sar_estimator.gps.gpsd import WATCH
from sar_estimator.gps.source import Source, check_url

pytestmark = pytest.mark.timeout(30)


def read(source, wanted, patience_s=10.0):
    """Read until enough bytes have come."""
    found, until = b"", time.monotonic() + patience_s
    while len(found) < wanted and time.monotonic() < until:
        found += source.read(0.05)
    return found


def test_a_port():
    controller, device = pty.openpty()
    source = Source(f"{os.ttyname(device)},38400".replace("/dev/pts", "/dev/pts"))
    assert source.read(0.01) == b""
    assert source.failure == ""
    os.write(controller, b"$GNGGA")
    assert read(source, 6) == b"$GNGGA"
    os.close(controller)
    os.close(device)
    until = time.monotonic() + 5.0
    while not source.failure and time.monotonic() < until:
        source.read(0.05)
    assert source.breaks == 1
    assert source.failure
    source.close()


def test_a_port_that_is_not_there_is_tried_again():
    source = Source("/dev/nowhere,9600")
    assert source.read(0.01) == b""
    assert source.failure == "/dev/nowhere,9600: No such file or directory" or "nowhere" in (
        source.failure
    )
    assert source.breaks == 0


@pytest.mark.parametrize("kind", ["tcp", "gpsd"])
def test_a_server_that_goes_and_comes_back(kind):
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        source = Source(f"{kind}:127.0.0.1:{port}")
        for count in (1, 2):
            source.read(0.01)
            server.settimeout(5.0)
            until = time.monotonic() + 5.0
            connection = None
            while connection is None and time.monotonic() < until:
                source.read(0.05)
                server.settimeout(0.05)
                with contextlib.suppress(TimeoutError):
                    connection, _ = server.accept()
            with connection:
                if kind == "gpsd":
                    connection.settimeout(5.0)
                    assert connection.recv(100) == WATCH
                connection.sendall(b"abc")
                assert read(source, 3) == b"abc"
            until = time.monotonic() + 5.0
            while source.breaks < count and time.monotonic() < until:
                source.read(0.05)
            assert source.breaks == count
            assert "closed by the other side" in source.failure
        source.close()


def test_datagrams():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    source = Source(f"udp:127.0.0.1:{port}")
    source.read(0.01)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.sendto(b"", ("127.0.0.1", port))
        sender.sendto(b"xyz", ("127.0.0.1", port))
    assert read(source, 3) == b"xyz"
    assert source.breaks == 0
    source.close()


@pytest.mark.parametrize(
    ("url", "parts"),
    [
        ("/dev/ttyACM0,38400", ("serial", "/dev/ttyACM0", 38400)),
        ("tcp:10.0.0.1:2000", ("tcp", "10.0.0.1", 2000)),
        ("udp:0.0.0.0:2000", ("udp", "0.0.0.0", 2000)),
        ("gpsd:localhost", ("gpsd", "localhost", 2947)),
        ("gpsd:localhost:3000", ("gpsd", "localhost", 3000)),
    ],
)
def test_urls(url, parts):
    assert check_url(url) == parts


@pytest.mark.parametrize(
    "url", ["", "/dev/ttyACM0", "/dev/ttyACM0,fast", "tcp:host", "tcp:host:0", "http:h:1", "udp::1"]
)
def test_what_is_no_url_is_one_line(url):
    with pytest.raises(ValueError, match="expected /dev/NAME,BAUD, tcp:") as error:
        Source(url)
    assert repr(url) in str(error.value)
    assert "\n" not in str(error.value)
