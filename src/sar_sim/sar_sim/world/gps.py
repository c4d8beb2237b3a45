"""Where the helicopter's fixes come from: a simulated receiver or a recorded track."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from sar_estimator.common import reports, topics
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.states import FloatArray, Motion
from sar_sim.scenario.scenario import Gps
from sar_sim.world.helicopter import Helicopter

BLOCK = 64


@dataclass(frozen=True, slots=True)
class Velocity:
    """A Doppler velocity [m/s], east and north."""

    vx_mps: float
    vy_mps: float


@dataclass(frozen=True, slots=True)
class Reception:
    """What the receiver gives at one epoch."""

    fix: Fix
    velocity: Velocity | None = None

    def told(self) -> list[tuple[str, Any]]:
        """Return what is published of it, by topic."""
        found: list[tuple[str, Any]] = []
        if self.velocity is not None:
            velocity = reports.Velocity(self.fix.time_s, self.velocity.vx_mps, self.velocity.vy_mps)
            found.append((topics.VELOCITY, velocity))
        return [*found, (topics.FIX, self.fix)]


class FixSource(Protocol):
    """Gives what was received up to a time."""

    def due(self, time_s: float) -> list[Reception]:
        """Return the receptions not yet given, up to ``time_s`` [s]."""
        ...


class NoReceiver:
    """Stands where the receiver is a real one, outside the simulation."""

    def due(self, time_s: float) -> list[Reception]:  # noqa: ARG002
        """Return nothing."""
        return []


class SimulatedGps:
    """A receiver in a simulated helicopter."""

    def __init__(self, helicopter: Helicopter, gps: Gps, datum: Datum) -> None:
        """Draw all noise from the receiver's own seed."""
        self._helicopter, self._gps, self._datum = helicopter, gps, datum
        self._rng = np.random.default_rng(gps.seed)
        self._drift = np.random.default_rng([gps.seed, 5])
        self._covariance = np.eye(2) * gps.reported_sigma_m**2
        self._epoch = 1
        self._wandering = self._drift.standard_normal((2, 2)) * [
            [gps.bias_sigma_m],
            [gps.correlated_sigma_m],
        ]
        self._block = self._draw()

    def due(self, time_s: float) -> list[Reception]:
        """Return the receptions not yet given, up to ``time_s`` [s]."""
        given = []
        while self._epoch / self._gps.rate_hz <= time_s + 1e-9:
            reception = self._block.popleft()
            self._epoch += 1
            if reception is not None:
                given.append(reception)
            if not self._block:
                self._block = self._draw()
        return given

    def _draw(self) -> deque[Reception | None]:
        """Return the next epochs' receptions, None where one is lost."""
        gps = self._gps
        times = [epoch / gps.rate_hz for epoch in range(self._epoch, self._epoch + BLOCK)]
        noise, lost = np.empty((BLOCK, 4)), np.empty(BLOCK, dtype=bool)
        for i in range(BLOCK):
            noise[i] = self._rng.standard_normal(4)
            lost[i] = self._rng.random() < gps.dropout
        truth = [self._measured(at) for at in times]
        points = np.array([(motion.x_m, motion.y_m) for motion in truth])
        points += gps.sigma_m * noise[:, :2] + self._errors()
        places = self._datum.all_to_geodetic(points).tolist()
        return deque(
            None if gone else self._reception(at, place, motion, off)
            for at, place, motion, off, gone in zip(
                times, places, truth, noise[:, 2:].tolist(), lost.tolist(), strict=True
            )
        )

    def _measured(self, at: float) -> Motion:
        """Return the motion that is given out at a time: that of a little before."""
        gps = self._gps
        late_s = gps.latency_s
        if gps.latency_per_mps_s > 0.0:
            late_s += gps.latency_per_mps_s * self._helicopter.motion(at).speed_mps
        return self._helicopter.motion(max(0.0, at - late_s))

    def _errors(self) -> FloatArray:
        """Return the errors of the next epochs that wander, shape (BLOCK, 2) [m]."""
        gps = self._gps
        out = np.zeros((BLOCK, 2))
        for kind, (sigma, time_s) in enumerate(
            (
                (gps.bias_sigma_m, gps.bias_time_s),
                (gps.correlated_sigma_m, gps.correlated_time_s),
            )
        ):
            if sigma == 0.0:
                continue
            kept = math.exp(-1.0 / (gps.rate_hz * time_s))
            fresh = sigma * math.sqrt(1.0 - kept**2) * self._drift.standard_normal((BLOCK, 2))
            for i in range(BLOCK):
                self._wandering[kind] = kept * self._wandering[kind] + fresh[i]
                out[i] += self._wandering[kind]
        return out

    def _reception(
        self, at: float, place: list[float], truth: Motion, off: list[float]
    ) -> Reception:
        latitude, longitude, altitude = place
        fix = Fix(at, latitude, longitude, altitude, self._covariance)
        sigma = self._gps.doppler_sigma_mps
        if sigma == 0.0:
            return Reception(fix)
        velocity = Velocity(truth.vx_mps + sigma * off[0], truth.vy_mps + sigma * off[1])
        return Reception(fix, velocity)


class RecordedTrack:
    """A recorded track, its times counted from its first fix."""

    def __init__(self, fixes: list[Fix]) -> None:
        """Keep the fixes in the order they were recorded."""
        self.start_s = fixes[0].time_s
        self.end_s = max(fix.time_s for fix in fixes) - self.start_s
        self._fixes = fixes
        self._next = 0

    def due(self, time_s: float) -> list[Reception]:
        """Return the receptions not yet given, up to ``time_s`` [s] after the first."""
        given = []
        while self._next < len(self._fixes):
            fix = self._fixes[self._next]
            if fix.time_s - self.start_s > time_s + 1e-9:
                break
            given.append(Reception(fix))
            self._next += 1
        return given
