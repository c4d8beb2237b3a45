"""The leg being flown: its newest measurements, what is known of it, and what is told of it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import FloatArray, LegEstimate
from sar_estimator.estimation.leg_process import IS_VELOCITY, TIME, Belief, LegProcess

MIN_SPACING_S = 0.4
ROOM = 256
BEGIN_SPEED_SIGMA_MPS = 3.0


class LegRow(NamedTuple):
    """One accepted measurement: position [m] with sigma [m], or a velocity [m/s] with sigma."""

    time_s: float
    x: float
    y: float
    sigma: float
    is_velocity: bool


class LegTracker:
    """Keeps the newest rows of a leg by themselves, and lets older ones into its process.

    ``process``: what is known of the pilot, which outlives the leg.
    """

    def __init__(self, process: LegProcess) -> None:
        """Fly no leg yet."""
        self.process = process
        self._table = np.empty((ROOM, 5))
        self._first = self._end = 0
        self._newest_s = [-math.inf, -math.inf]
        self.begun_s = math.inf

    @property
    def rows(self) -> FloatArray:
        """The rows that the process has not taken in, shape (n, 5), in order of time."""
        return self._table[self._first : self._end]

    @property
    def has_velocities(self) -> bool:
        """Whether velocities come with the positions."""
        newest = self._table[max(self._first, self._end - 4) : self._end, IS_VELOCITY]
        return any(newest.tolist())

    @property
    def belief(self) -> Belief:
        """What is known of the leg before these rows."""
        return self.process.belief

    def begin(
        self, time_s: float, position_m: tuple[float, float], velocity_mps: tuple[float, float]
    ) -> None:
        """Begin a leg that is flown at about a velocity."""
        self._first = self._end = 0
        self._newest_s = [-math.inf, -math.inf]
        self.begun_s = time_s
        self.process.begin(time_s, position_m, velocity_mps, BEGIN_SPEED_SIGMA_MPS)

    def add(self, row: LegRow) -> None:
        """Append a row.

        Rows of a kind closer than ``MIN_SPACING_S`` are left out: a receiver's errors over such
        times are alike, and more of them tell no more.
        """
        if row.time_s - self._newest_s[row.is_velocity] < MIN_SPACING_S:
            return
        self._newest_s[row.is_velocity] = row.time_s
        if self._end == len(self._table):
            kept = self.rows.copy()
            if len(kept) > len(self._table) // 2:
                self._table = np.empty((2 * len(self._table), 5))
            self._table[: len(kept)] = kept
            self._first, self._end = 0, len(kept)
        self._table[self._end] = row
        self._end += 1

    def settle(self, until_s: float, heading_rad: float) -> None:
        """Let the rows older than a time into the process; ``heading_rad``: of the leg."""
        first = self._first
        while first < self._end and self._table[first, TIME] < until_s:
            first += 1
        self.process.absorb(self._table[self._first : first], heading_rad)
        self._first = first


def leg_estimate(
    time_s: float, means: FloatArray, covariance: FloatArray, heading_rad: float
) -> LegEstimate:
    """Return what is published of a leg: its line, p and the direction of v, and its speed."""
    speed = math.hypot(means[0, 1], means[1, 1])
    sigma_v = math.sqrt(max(covariance[1, 1], 0.0))
    return LegEstimate(
        time_s=time_s,
        foot=Pose(float(means[0, 0]), float(means[1, 0]), heading_rad),
        speed_mps=speed,
        position_sigma_m=math.sqrt(max(covariance[0, 0], 0.0)),
        heading_sigma_rad=sigma_v / max(speed, sigma_v, 1e-6),
        speed_sigma_mps=sigma_v,
    )
