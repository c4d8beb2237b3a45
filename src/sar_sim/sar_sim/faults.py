"""Injected faults of the helicopter's receiver and of the radio to the UAV, in PX4's words."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sar_sim.gps import FixSource, Reception
from sar_sim.scenario import Fault

NO_NUMBER_SHARE = 0.2


def active(faults: list[Fault], component: str, time_s: float) -> list[Fault]:
    """Return the faults of a component that are on at ``time_s`` [s]."""
    return [
        fault
        for fault in faults
        if fault.component == component and fault.at_s <= time_s < fault.at_s + fault.for_s
    ]


class FaultyReceiver:
    """A receiver with faults.

    off: no fixes. stuck: the last one's position again and again. garbage: positions all over the
    world, some no numbers. wrong: ``size`` metres beside the truth, all at once. slow: one fix in
    ``size``. delayed: ``size`` seconds late, with the old stamp. intermittent: a share ``size``
    gets lost.
    """

    def __init__(self, source: FixSource, faults: list[Fault], seed: int) -> None:
        """Stand between a source and whoever listens to it."""
        self._source, self._faults = source, faults
        self._rng = np.random.default_rng([seed, 11])
        self._last: Reception | None = None
        self._held: list[tuple[float, Reception]] = []
        self._count = 0

    def due(self, time_s: float) -> list[Reception]:
        """Return the receptions not yet given, up to ``time_s`` [s]."""
        given = [item for at, item in self._held if at <= time_s]
        self._held = [(at, item) for at, item in self._held if at > time_s]
        for item in self._source.due(time_s):
            self._count += 1
            received: Reception | None = item
            for fault in active(self._faults, "gps", time_s):
                received = None if received is None else self._faulty(received, fault, time_s)
            if received is not None:
                given.append(received)
                if received is item:
                    self._last = item
        return given

    def _faulty(self, item: Reception, fault: Fault, time_s: float) -> Reception | None:
        fix = item.fix
        if fault.kind == "stuck" and self._last is not None:
            old = self._last.fix
            return Reception(
                replace(fix, latitude_deg=old.latitude_deg, longitude_deg=old.longitude_deg)
            )
        if fault.kind == "garbage":
            return self._garbage(item)
        if fault.kind == "wrong":
            north = fault.size / 111_000.0
            return replace(item, fix=replace(fix, latitude_deg=fix.latitude_deg + north))
        if fault.kind == "slow":
            return item if self._count % max(1, round(fault.size)) == 0 else None
        if fault.kind == "intermittent" and self._rng.random() >= fault.size:
            return item
        if fault.kind == "delayed":
            self._held.append((time_s + fault.size, item))
        return None

    def _garbage(self, item: Reception) -> Reception:
        latitude, longitude = self._rng.uniform((-120.0, -250.0), (120.0, 250.0))
        if self._rng.random() < NO_NUMBER_SHARE:
            latitude = math.nan
        return Reception(
            replace(item.fix, latitude_deg=float(latitude), longitude_deg=float(longitude))
        )


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
