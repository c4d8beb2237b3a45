"""Injected faults: which are on, and what they do to radio, autopilot, clock and nodes."""

from __future__ import annotations

import numpy as np

from sar_sim.scenario.scenario import Fault


def active(faults: list[Fault], component: str, time_s: float) -> list[Fault]:
    """Return the faults of a component that are on at ``time_s`` [s]."""
    return [
        fault
        for fault in faults
        if fault.component == component and fault.at_s <= time_s < fault.at_s + fault.for_s
    ]


class FaultyRadio:
    """Says which messages of the radio to the UAV get through, either way.

    off: none; nor while the autopilot is off. slow: one in ``size``. intermittent: a share ``size``
    gets lost.
    """

    def __init__(self, faults: list[Fault], seed: int) -> None:
        """Let everything through that no fault holds back."""
        self._faults = faults
        self._rng = np.random.default_rng([seed, 12])
        self._count = 0

    def gets_through(self, time_s: float) -> bool:
        """Return whether the next message does, at ``time_s`` [s]."""
        self._count += 1
        if active(self._faults, "autopilot", time_s):
            return False
        for fault in active(self._faults, "radio", time_s):
            if fault.kind == "off":
                return False
            if fault.kind == "slow" and self._count % max(1, round(fault.size)) != 0:
                return False
            if fault.kind == "intermittent" and self._rng.random() < fault.size:
                return False
        return True


class AutopilotFaults:
    """When the autopilot boots anew, and when a human changes its mode.

    autopilot off: silent for so long, then booted. mode wrong: LOITER is chosen.
    """

    def __init__(self, faults: list[Fault]) -> None:
        """Take the faults of the autopilot and of its mode."""
        self._booted = sorted(f.at_s + f.for_s for f in faults if f.component == "autopilot")
        self._taken = sorted(f.at_s for f in faults if f.component == "mode")

    def booted(self, time_s: float) -> bool:
        """Return whether it has booted since this was last asked, at ``time_s`` [s]."""
        return _due(self._booted, time_s)

    def taken(self, time_s: float) -> bool:
        """Return whether a human has changed its mode since this was last asked."""
        return _due(self._taken, time_s)


def _due(times_s: list[float], now_s: float) -> bool:
    """Take the times that have come out of a list; return whether there were any."""
    count = sum(time_s <= now_s for time_s in times_s)
    del times_s[:count]
    return count > 0


def clock_error_s(faults: list[Fault], time_s: float) -> float:
    """Return by how much the laptop's clock is wrong [s] at ``time_s``, once set so for good."""
    return sum(f.size for f in faults if f.component == "clock" and f.at_s <= time_s)


class NodeFaults:
    """Which nodes are to be killed, stopped and let go on, in the order of time.

    DDS that is off is like a node that is stopped: it goes on after its time.
    """

    def __init__(self, faults: list[Fault], nodes: tuple[str, ...]) -> None:
        """Take the faults of ``nodes``."""
        steps: list[tuple[float, str, str]] = []
        for fault in faults:
            if fault.component in nodes:
                killed = fault.kind == "off" and fault.component != "dds"
                steps.append((fault.at_s, fault.component, "kill" if killed else "stop"))
                if not killed:
                    steps.append((fault.at_s + fault.for_s, fault.component, "go on"))
        self._steps = sorted(steps)

    def due(self, time_s: float) -> list[tuple[str, str]]:
        """Return nodes and what is to be done with them, up to ``time_s`` [s]."""
        done = [step for step in self._steps if step[0] <= time_s]
        self._steps = self._steps[len(done) :]
        return [(name, action) for _, name, action in done]
