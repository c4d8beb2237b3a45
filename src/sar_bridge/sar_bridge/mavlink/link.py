"""A MAVLink 2 link over UDP, TCP or a serial line."""

from __future__ import annotations

import contextlib
import select
import socket
import time
from collections.abc import Callable, Iterable
from typing import Any, Protocol

import serial
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Addressed
from sar_bridge.mavlink.signing import Signer, VerifyingParser

GROUND_SYSTEM = 255
GROUND_COMPONENT = 240
"""MAV_COMP_ID_UDP_BRIDGE: ground stations beside have 190."""
DEFAULT_BAUD = 57600
REOPEN_PERIOD_S = 1.0
WRITE_TIMEOUT_S = 0.2
CHUNK = 65536


class Transport(Protocol):
    """Something bytes go through. Its methods raise ``OSError`` when it is broken."""

    def fileno(self) -> int:
        """Return what to wait on for bytes."""
        ...

    def read(self) -> bytes:
        """Return the bytes that are there."""
        ...

    def write(self, data: bytes) -> None:
        """Send bytes; what nobody takes is lost."""
        ...

    def close(self) -> None:
        """Close it."""
        ...


class UdpTransport:
    """UDP: bound to an address, sending to another; without that, answering whom it hears."""

    def __init__(self, bind: tuple[str, int] | None, peer: tuple[str, int] | None = None) -> None:
        """Open the socket."""
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)  # noqa: FBT003
        self._peer: Any = peer
        if bind is not None:
            self._socket.bind(bind)

    def fileno(self) -> int:
        """Return what to wait on for bytes."""
        return self._socket.fileno()

    def read(self) -> bytes:
        """Return the datagrams that are there."""
        data = b""
        with contextlib.suppress(BlockingIOError, ConnectionRefusedError):
            while True:
                datagram, self._peer = self._socket.recvfrom(CHUNK)
                data += datagram
        return data

    def write(self, data: bytes) -> None:
        """Send to the peer, once there is one; nobody listening yet is no error."""
        if self._peer is not None:
            with contextlib.suppress(BlockingIOError, ConnectionRefusedError):
                self._socket.sendto(data, self._peer)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class TcpTransport:
    """A TCP client."""

    def __init__(self, host: str, port: int) -> None:
        """Connect."""
        self._socket = socket.create_connection((host, port), timeout=2.0)
        self._socket.settimeout(WRITE_TIMEOUT_S)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def fileno(self) -> int:
        """Return what to wait on for bytes."""
        return self._socket.fileno()

    def read(self) -> bytes:
        """Return the bytes that are there."""
        data = self._socket.recv(CHUNK)
        if not data:
            raise ConnectionResetError("closed by the other side")
        return data

    def write(self, data: bytes) -> None:
        """Send all."""
        self._socket.sendall(data)

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


class SerialTransport:
    """A serial line (pyserial)."""

    def __init__(self, device: str, baud: int) -> None:
        """Open the device."""
        self._serial = serial.Serial(device, baud, timeout=0.0, write_timeout=WRITE_TIMEOUT_S)

    def fileno(self) -> int:
        """Return what to wait on for bytes."""
        return int(self._serial.fileno())

    def read(self) -> bytes:
        """Return the bytes that are there."""
        return bytes(self._serial.read(CHUNK))

    def write(self, data: bytes) -> None:
        """Send all."""
        self._serial.write(data)

    def close(self) -> None:
        """Close the device."""
        self._serial.close()


def opener(url: str, what: str = "autopilot URL") -> Callable[[], Transport]:
    """Return what opens a URL, also one as MAVROS has it: ``udp://BIND:PORT@HOST:PORT``.

    Raises ``ValueError``, which begins with ``what``, for what is neither UDP, TCP nor serial.
    """
    expected = "udp:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT or /dev/NAME,BAUD"
    refused = ValueError(f"{what} {url!r}: expected {expected}")
    scheme, _, rest = url.partition(":")
    if scheme == "udp" and rest.startswith("//"):
        bind, at, peer = rest[2:].partition("@")
        if not at or not (bind or peer):
            raise refused
        here, there = _place(bind, refused), _place(peer, refused)
        return lambda: UdpTransport(here, there)
    if scheme in ("udp", "udpin", "udpout", "tcp"):
        place = _place(rest, refused)
        if place is None:
            raise refused
        if scheme == "tcp":
            return lambda: TcpTransport(*place)
        return lambda: UdpTransport(None, place) if scheme == "udpout" else UdpTransport(place)
    device, _, baud = url.partition(",")
    if not device.startswith("/dev/") or (baud and not baud.isdigit()):
        raise refused
    return lambda: SerialTransport(device, int(baud or DEFAULT_BAUD))


def _place(text: str, refused: ValueError) -> tuple[str, int] | None:
    """Return host, loopback where none is named, and port; None for nothing."""
    if not text:
        return None
    host, _, port = text.rpartition(":")
    if not port.isdigit() or not 0 < int(port) < 65536 or not (host or text.startswith(":")):
        raise refused
    return host or "127.0.0.1", int(port)


class Link:
    """A link that opens again by itself when it breaks.

    One thread may receive while another sends. Raises ``ValueError`` for a bad URL and ``OSError``
    when it cannot be opened at first; a TCP server that is not there yet is waited for.
    """

    def __init__(
        self,
        url: str,
        *,
        system: int = GROUND_SYSTEM,
        component: int = GROUND_COMPONENT,
        signer: Signer | None = None,
        what: str = "autopilot URL",
    ) -> None:
        """Open the link; what is sent comes from ``system`` and ``component``.

        ``what``: the link's name in errors. With a ``signer`` everything sent is signed, and
        nothing unsigned is received.
        """
        self._open = opener(url, what)
        self._signer = signer
        self._mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
        if signer is not None:
            self._mav.signing = signer.state
        self._parser = self._new_parser()
        self._transport: Transport | None = None
        self._tried_s = time.monotonic()
        self.breaks = 0
        try:
            self._transport = self._open()
        except (ConnectionRefusedError, TimeoutError):
            pass
        except OSError as error:
            raise OSError(f"{what} {url!r}: {error}") from error

    def _new_parser(self) -> Any:
        parser = VerifyingParser(None)
        parser.robust_parsing = True
        if self._signer is not None:
            parser.signing = self._signer.state
        return parser

    def receive(self, timeout_s: float) -> list[Any]:
        """Wait for messages, at most ``timeout_s`` [s]; return all there are."""
        transport = self._transport or self._reopened(timeout_s)
        if transport is None:
            return []
        try:
            if not select.select([transport.fileno()], [], [], timeout_s)[0]:
                return []
            data = transport.read()
        except (OSError, ValueError):
            self._break(transport)
            return []
        return [
            message
            for message in self._parser.parse_buffer(data) or []
            if message.get_type() != "BAD_DATA"
        ]

    def _reopened(self, timeout_s: float) -> Transport | None:
        wait = self._tried_s + REOPEN_PERIOD_S - time.monotonic()
        if wait > 0.0:
            time.sleep(min(wait, timeout_s))
            return None
        self._tried_s = time.monotonic()
        try:
            self._transport = self._open()
        except OSError:
            return None
        self._parser = self._new_parser()
        return self._transport

    def _break(self, transport: Transport) -> None:
        self.breaks += 1
        self._tried_s = time.monotonic()
        self._transport = None
        with contextlib.suppress(OSError):
            transport.close()

    def send(self, messages: Iterable[Any]) -> None:
        """Send messages; what cannot be sent is lost, as on any radio.

        ``Addressed`` ones as from another sender; packets, which are bytes, as they are.
        """
        if self._signer is not None:
            with contextlib.suppress(OSError):  # a full disk is no reason to fall silent
                self._signer.advance(time.time())
        for message in messages:
            data = self._packed(message)
            transport = self._transport
            if transport is None:
                continue
            # A broken transport is noticed, closed and opened again by whoever receives.
            with contextlib.suppress(OSError, ValueError):
                transport.write(data)

    def _packed(self, message: Any) -> bytes:
        if isinstance(message, bytes):
            return message
        own = self._mav.srcSystem, self._mav.srcComponent
        if isinstance(message, Addressed):
            sender, message = message.sender, message.message
            self._mav.srcSystem, self._mav.srcComponent = sender.system, sender.component
        try:
            return bytes(message.pack(self._mav))
        finally:
            self._mav.srcSystem, self._mav.srcComponent = own

    def close(self) -> None:
        """Close the link."""
        if self._transport is not None:
            self._transport.close()
