"""The wind that the simulated UAV flies in: its mean, and gusts about it."""

from __future__ import annotations

import math

import numpy as np

from sar_sim.scenario.scenario import Wind

BLOCK = 1024


class Gusts:
    """A first-order Gauss-Markov process on each axis about the mean wind."""

    def __init__(self, wind: Wind) -> None:
        """Begin with a gust drawn from the stationary distribution."""
        self._wind, self._mean = wind, wind.vector_mps
        self._rng = np.random.default_rng(wind.seed)
        self._drawn: list[list[float]] = []
        self._gust = [wind.gust_sigma_mps * value for value in self._draw()]
        self._shares = 0.0, 1.0, 0.0

    def _draw(self) -> list[float]:
        if not self._drawn:
            self._drawn = self._rng.standard_normal((BLOCK, 2)).tolist()
        return self._drawn.pop()

    def step(self, dt_s: float) -> tuple[float, float]:
        """Advance by ``dt_s`` [s]; return where the wind blows to, east and north [m/s]."""
        if self._wind.gust_sigma_mps == 0.0:
            return self._mean
        if self._shares[0] != dt_s:
            kept = math.exp(-dt_s / self._wind.gust_time_s)
            self._shares = dt_s, kept, self._wind.gust_sigma_mps * math.sqrt(1.0 - kept**2)
        _, kept, fresh = self._shares
        east, north = self._draw()
        self._gust = [kept * self._gust[0] + fresh * east, kept * self._gust[1] + fresh * north]
        return self._mean[0] + self._gust[0], self._mean[1] + self._gust[1]
