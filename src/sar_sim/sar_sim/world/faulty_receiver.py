"""Injected faults of the helicopter's receiver, in PX4's words."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sar_sim.scenario.faults import active
from sar_sim.scenario.scenario import Fault
from sar_sim.world.gps import FixSource, Reception

NO_NUMBER_SHARE = 0.2


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
