"""Where a receiver's bytes come from: a port, a socket or gpsd, opened anew when it ends."""

from __future__ import annotations

import contextlib
import socket
import time
from typing import Protocol

import serial

from sar_estimator.gps.gpsd import WATCH

EXPECTED = "expected /dev/NAME,BAUD, tcp:HOST:PORT, udp:HOST:PORT or gpsd:HOST"
GPSD_PORT = 2947
CHUNK = 4096
AGAIN_S = 1.0
CONNECT_S = 3.0


class Stream(Protocol):
    """What bytes are read from."""

    def read(self, timeout_s: float) -> bytes:
        """Return what comes within a time [s]; raises ``OSError`` when it has ended."""
        ...

    def close(self) -> None:
        """Close it."""
        ...


class _Serial:
    def __init__(self, device: str, baud: int) -> None:
        self._port = serial.Serial(device, baud, timeout=0.0, exclusive=True)

    def read(self, timeout_s: float) -> bytes:
        self._port.timeout = timeout_s
        first = self._port.read(1)
        return bytes(first + self._port.read(min(self._port.in_waiting, CHUNK)))

    def close(self) -> None:
        self._port.close()


class _Socket:
    def __init__(self, found: socket.socket) -> None:
        self._socket = found

    def read(self, timeout_s: float) -> bytes:
        self._socket.settimeout(timeout_s)
        try:
            data = self._socket.recv(CHUNK)
        except TimeoutError:
            return b""
        if not data and self._socket.type is socket.SOCK_STREAM:
            raise ConnectionResetError("closed by the other side")
        return data

    def close(self) -> None:
        self._socket.close()


class Source:
    """Reads from a URL, and opens it anew when it fails; never raises while it is read.

    ``failure``: why it cannot be read now, empty when it can. ``breaks``: how often it has ended.
    Raises ``ValueError`` for a URL that is none.
    """

    def __init__(self, url: str) -> None:
        """Check the URL; nothing is opened yet."""
        self._url = url
        self._kind, self._host, self._number = check_url(url)
        self._stream: Stream | None = None
        self._next_s = 0.0
        self.failure = "not opened yet"
        self.breaks = 0

    def read(self, timeout_s: float) -> bytes:
        """Return what comes within a time [s]."""
        if self._stream is None and not self._open(timeout_s):
            return b""
        assert self._stream is not None
        try:
            return self._stream.read(timeout_s)
        except (OSError, TypeError) as error:  # pyserial's, of a port closed under it
            self.breaks += 1
            self.failure = f"{self._url}: {_why(error)}"
            self.close()
            return b""

    def close(self) -> None:
        """Close it; it is opened anew when it is read again."""
        if self._stream is not None:
            with contextlib.suppress(OSError):
                self._stream.close()
        self._stream = None

    def _open(self, timeout_s: float) -> bool:
        now = time.monotonic()
        if now < self._next_s:
            time.sleep(min(timeout_s, self._next_s - now))
            return False
        self._next_s = now + AGAIN_S
        try:
            self._stream = self._opened()
        except OSError as error:
            self.failure = f"{self._url}: {_why(error)}"
            return False
        self.failure = ""
        return True

    def _opened(self) -> Stream:
        if self._kind == "serial":
            return _Serial(self._host, self._number)
        if self._kind == "udp":
            listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            try:
                listener.bind((self._host, self._number))
            except OSError:
                listener.close()
                raise
            return _Socket(listener)
        found = socket.create_connection((self._host, self._number), CONNECT_S)
        if self._kind == "gpsd":
            found.sendall(WATCH)
        return _Socket(found)


def _why(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or error)


def check_url(url: str) -> tuple[str, str, int]:
    """Return kind, host or device, and port or baud rate; ``ValueError`` for what is none."""
    if url.startswith("/"):
        device, _, baud = url.rpartition(",")
        if baud.isdigit() and int(baud) > 0:
            return "serial", device, int(baud)
    kind, _, rest = url.partition(":")
    host, _, port = rest.rpartition(":")
    if kind == "gpsd" and rest and not host:
        return kind, port, GPSD_PORT
    if kind in ("tcp", "udp", "gpsd") and host and port.isdigit() and 0 < int(port) < 65536:
        return kind, host, int(port)
    raise ValueError(f"receiver {url!r}: {EXPECTED}")
