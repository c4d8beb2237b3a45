"""One radio for several bridges: every packet goes to the other side as it is."""

from __future__ import annotations

import threading
from collections.abc import Sequence

from sar_bridge.mavlink.link import Link

WAIT_S = 0.2
JOIN_S = 2.0


class Hub:
    """Passes packets from a trunk to all branches, and from every branch to the trunk.

    Packets are not changed, so that signed ones stay signed; who they are for is the ends' matter.
    """

    def __init__(self, trunk: Link, branches: Sequence[Link]) -> None:
        """Join the links, which are closed with it."""
        self.trunk, self.branches = trunk, tuple(branches)
        self.passed = 0
        self._running = True
        ways = [(trunk, self.branches), *((branch, (trunk,)) for branch in self.branches)]
        self._threads = [
            threading.Thread(target=self._carry, args=way, name="hub", daemon=True) for way in ways
        ]
        for thread in self._threads:
            thread.start()

    def _carry(self, source: Link, sinks: Sequence[Link]) -> None:
        while self._running:
            packets = [bytes(message.get_msgbuf()) for message in source.receive(WAIT_S)]
            self.passed += len(packets)
            for sink in sinks:
                sink.send(packets)

    def close(self) -> None:
        """Stop, and close the links."""
        self._running = False
        for thread in self._threads:
            thread.join(timeout=JOIN_S)
        for link in (self.trunk, *self.branches):
            link.close()
