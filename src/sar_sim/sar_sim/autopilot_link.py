"""The simulated autopilot on its UDP link."""

from __future__ import annotations

from typing import Protocol

from sar_bridge.link import Link
from sar_sim.autopilot_server import AutopilotServer

HOLD_WAIT_S = 0.002
MAX_HOLD_S = 2.0


class Monotonic(Protocol):
    """A monotonic clock [s]."""

    def __call__(self) -> float:
        """Return the time [s]."""
        ...


class AutopilotLink:
    """Answers the ground station and sends telemetry."""

    def __init__(self, server: AutopilotServer, port: int, clock: Monotonic) -> None:
        """Send to a ground station at UDP ``port`` of loopback."""
        self._server, self._clock = server, clock
        self._link = Link(f"udpout:127.0.0.1:{port}", system=1, component=1)

    @property
    def heard(self) -> bool:
        """Whether the ground station has been heard."""
        return self._server.gcs_seen

    def listen(self, timeout_s: float) -> None:
        """Answer at once what comes within ``timeout_s`` [s]."""
        now = self._clock()
        for message in self._link.receive(timeout_s):
            self._link.send(self._server.handle(message, now))
        self._link.send(self._server.tick(now))

    def report(self, time_s: float) -> None:
        """Send the telemetry due at the simulation's ``time_s`` [s]."""
        self._link.send(self._server.telemetry(time_s))

    def hold(self) -> float:
        """Serve a mission transfer to its end; return for how long [s].

        A transfer takes as long at any speed of the simulation: the simulation stands meanwhile,
        so that it does not count manifold.
        """
        begun = now = self._clock()
        while self._server.transferring(now) and now - begun < MAX_HOLD_S:
            self.listen(HOLD_WAIT_S)
            now = self._clock()
        return now - begun

    def close(self) -> None:
        """Close the link."""
        self._link.close()
