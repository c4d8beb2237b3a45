"""A link to a ground station, which never makes anybody wait."""

from __future__ import annotations

import contextlib
import queue
import threading
from typing import Any

from sar_bridge.mavlink.addressed import Addressed
from sar_bridge.mavlink.link import Link
from sar_bridge.mavlink.signing import Signer

WAITING = 1000
"""How many packets wait for a station that takes none: some ten seconds of telemetry."""


class StationLink:
    """Sends from a thread of its own; what a station does not take in time is lost to it.

    Raises ``ValueError`` for a bad URL, and ``OSError`` where it cannot be opened.
    """

    def __init__(self, url: str, signer: Signer | None = None) -> None:
        """Open it; with a ``signer`` only what is signed with its key is received."""
        self._link = Link(url, signer=signer, what="gcs_url")
        self._waiting: queue.Queue[bytes | Addressed | None] = queue.Queue(WAITING)
        self._sender = threading.Thread(target=self._work, name="to station", daemon=True)
        self._sender.start()
        self.lost = 0

    def receive(self, timeout_s: float) -> list[Any]:
        """Wait for messages, at most ``timeout_s`` [s]; return all there are."""
        return self._link.receive(timeout_s)

    def send(self, message: bytes | Addressed) -> None:
        """Send a packet or a message some time soon."""
        try:
            self._waiting.put_nowait(message)
        except queue.Full:
            self.lost += 1

    def _work(self) -> None:
        while (message := self._waiting.get()) is not None:
            self._link.send([message])

    def close(self) -> None:
        """Close the link, and end its thread."""
        with contextlib.suppress(queue.Full):
            self._waiting.put_nowait(None)
        self._link.close()
