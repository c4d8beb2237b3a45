"""Where the helicopter's fixes come from: a simulated receiver or a recorded track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sar_estimator.fixes import Fix
from sar_estimator.geodesy import Datum
from sar_sim.helicopter import PatternHelicopter
from sar_sim.scenario import Gps


@dataclass(frozen=True, slots=True)
class Velocity:
    """A Doppler velocity [m/s], east and north."""

    vx_mps: float
    vy_mps: float
    sigma_mps: float


@dataclass(frozen=True, slots=True)
class Reception:
    """What the receiver gives at one epoch."""

    fix: Fix
    velocity: Velocity | None = None


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

    def __init__(self, helicopter: PatternHelicopter, gps: Gps, datum: Datum) -> None:
        """Draw all noise from the receiver's own seed."""
        self._helicopter, self._gps, self._datum = helicopter, gps, datum
        self._rng = np.random.default_rng(gps.seed)
        self._epoch = 1

    def due(self, time_s: float) -> list[Reception]:
        """Return the receptions not yet given, up to ``time_s`` [s]."""
        given = []
        while self._epoch / self._gps.rate_hz <= time_s + 1e-9:
            at = self._epoch / self._gps.rate_hz
            self._epoch += 1
            noise = self._rng.standard_normal(4)
            if self._rng.random() >= self._gps.dropout:
                given.append(self._receive(at, noise))
        return given

    def _receive(self, at: float, noise: np.ndarray) -> Reception:
        gps, truth = self._gps, self._helicopter.motion(at)
        latitude, longitude, altitude = self._datum.to_geodetic(
            truth.x_m + gps.sigma_m * noise[0], truth.y_m + gps.sigma_m * noise[1]
        )
        covariance = np.eye(2) * max(gps.sigma_m, 0.1) ** 2
        fix = Fix(at, latitude, longitude, altitude, covariance)
        if gps.doppler_sigma_mps == 0.0:
            return Reception(fix)
        sigma = gps.doppler_sigma_mps
        return Reception(
            fix, Velocity(truth.vx_mps + sigma * noise[2], truth.vy_mps + sigma * noise[3], sigma)
        )


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
