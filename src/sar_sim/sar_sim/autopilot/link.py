"""The simulated autopilot on its UDP link."""

from __future__ import annotations

from typing import Any, Protocol

from sar_bridge.mavlink.link import Link
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.scenario.faults import AutopilotFaults, FaultyRadio
from sar_sim.scenario.scenario import Fault

HOLD_WAIT_S = 0.002
MAX_HOLD_S = 2.0


class Monotonic(Protocol):
    """A monotonic clock [s]."""

    def __call__(self) -> float:
        """Return the time [s]."""
        ...


class AutopilotLink:
    """Answers the ground station and sends telemetry."""

    def __init__(
        self,
        server: AutopilotServer,
        port: int,
        clock: Monotonic,
        faults: list[Fault] | None = None,
        seed: int = 0,
        *,
        system: int = 1,
    ) -> None:
        """Send to a ground station at UDP ``port`` of loopback; ``faults``: what is injected."""
        self._server, self._clock = server, clock
        self._radio = FaultyRadio(faults or [], seed)
        self._faults = AutopilotFaults(faults or [])
        self._time_s = 0.0
        self._link = Link(f"udpout:127.0.0.1:{port}", system=system, component=1)

    @property
    def heard(self) -> bool:
        """Whether the ground station has been heard."""
        return self._server.gcs_seen

    def listen(self, timeout_s: float) -> None:
        """Answer at once what comes within ``timeout_s`` [s]."""
        now = self._clock()
        for message in self._link.receive(timeout_s):
            if self._radio.gets_through(self._time_s):
                self._send(self._server.handle(message, now))
        self._send(self._server.tick(now))

    def _send(self, messages: list[Any]) -> None:
        through = [item for item in messages if self._radio.gets_through(self._time_s)]
        self._link.send(through)

    def report(self, time_s: float) -> None:
        """Send the telemetry due at the simulation's ``time_s`` [s]."""
        self._time_s = time_s
        if self._faults.booted(time_s):
            self._server.restart(time_s)
        if self._faults.taken(time_s):
            self._server.take()
        self._send(self._server.telemetry(time_s))

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
