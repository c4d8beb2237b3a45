"""A MAVLink 2 link to an autopilot: UDP, TCP or serial, by pymavlink."""

from __future__ import annotations

import os
import select
from typing import Any

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil

SOURCE_SYSTEM = 255
SOURCE_COMPONENT = 190
DEFAULT_BAUD = 57600


def check_url(url: str) -> None:
    """Raise ``ValueError`` for what is neither UDP, TCP nor a serial device."""
    scheme, _, rest = url.partition(":")
    if scheme in ("udp", "udpin", "udpout", "tcp"):
        host, _, port = rest.rpartition(":")
        if not host or not port.isdigit() or not 0 < int(port) < 65536:
            raise ValueError(f"autopilot URL {url!r}: expected {scheme}:HOST:PORT")
        return
    device, _, baud = url.partition(",")
    if not device.startswith("/dev/") or (baud and not baud.isdigit()):
        raise ValueError(
            f"autopilot URL {url!r}: expected udp:HOST:PORT, tcp:HOST:PORT or /dev/NAME,BAUD"
        )


class Link:
    """An open link. Raises ``ValueError`` for a bad URL, ``OSError`` when it cannot be opened."""

    def __init__(self, url: str) -> None:
        """Open the link."""
        check_url(url)
        device, _, baud = url.partition(",")
        try:
            self._connection: Any = mavutil.mavlink_connection(
                device,
                baud=int(baud or DEFAULT_BAUD),
                source_system=SOURCE_SYSTEM,
                source_component=SOURCE_COMPONENT,
                dialect="ardupilotmega",
                autoreconnect=True,
            )
        except Exception as error:
            raise OSError(f"autopilot URL {url!r}: {error}") from error

    def receive(self, timeout_s: float) -> list[Any]:
        """Wait for messages, at most ``timeout_s`` [s]; return all there are."""
        descriptor = self._connection.fd
        if descriptor is not None and descriptor >= 0:
            select.select([descriptor], [], [], timeout_s)
        messages = []
        while (message := self._connection.recv_msg()) is not None:
            if message.get_type() != "BAD_DATA":
                messages.append(message)
        return messages

    def send(self, messages: list[Any]) -> None:
        """Send messages; what cannot be sent is lost, as on any radio."""
        for message in messages:
            try:
                self._connection.mav.send(message)
            except OSError:
                return

    def close(self) -> None:
        """Close the link."""
        self._connection.close()
