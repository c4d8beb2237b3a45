"""The simulated autopilot's end of a UDP link on this machine."""

from __future__ import annotations

import select
import socket
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink


class UdpPort:
    """Sends to a ground station at ``port`` of loopback and hears its answers."""

    def __init__(self, port: int, *, system: int = 1, component: int = 1) -> None:
        """Open a socket; ``system`` and ``component`` sign what is sent."""
        self._target = ("127.0.0.1", port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(0.0)
        self._mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
        self._mav.robust_parsing = True

    def wait(self, timeout_s: float) -> list[Any]:
        """Wait for messages, at most ``timeout_s`` [s]; return those of the next datagrams."""
        if not select.select([self._socket], [], [], max(0.0, timeout_s))[0]:
            return []
        messages: list[Any] = []
        while True:
            try:
                data = self._socket.recv(65536)
            except (BlockingIOError, ConnectionRefusedError):
                break
            messages += self._mav.parse_buffer(data) or []
        return [message for message in messages if message.get_type() != "BAD_DATA"]

    def send(self, messages: list[mavlink.MAVLink_message]) -> None:
        """Send messages; nobody listening yet is no error."""
        for message in messages:
            try:
                self._socket.sendto(message.pack(self._mav), self._target)
            except (BlockingIOError, ConnectionRefusedError):
                return

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
