"""A motion that is known at every step: positions and velocities, and what lies between them."""

from __future__ import annotations

import numpy as np

from sar_estimator.common.states import FloatArray, Motion

STEP_S = 0.1


class SampledMotion:
    """The motion through samples ``STEP_S`` apart, from time 0 on."""

    def __init__(self, places: FloatArray, velocities: FloatArray) -> None:
        """Take positions [m] and velocities [m/s], each of shape (n, 2), n at least 2."""
        accels = np.gradient(velocities, STEP_S, axis=0)
        self._rows = np.hstack((places, velocities, accels)).tolist()

    @property
    def end_s(self) -> float:
        """The time of the last sample [s]."""
        return STEP_S * (len(self._rows) - 1)

    def at(self, time_s: float) -> Motion:
        """Return the motion at a time [s]: cubic Hermite between samples, the ends' outside."""
        at = min(max(time_s / STEP_S, 0.0), len(self._rows) - 1.000001)
        i = int(at)
        t, a, b = at - i, self._rows[i], self._rows[i + 1]
        h1, h2 = t * t * (3.0 - 2.0 * t), t * (1.0 - t) * (1.0 - t) * STEP_S
        h3 = -t * t * (1.0 - t) * STEP_S
        return Motion(
            time_s,
            a[0] + h1 * (b[0] - a[0]) + h2 * a[2] + h3 * b[2],
            a[1] + h1 * (b[1] - a[1]) + h2 * a[3] + h3 * b[3],
            a[2] + t * (b[2] - a[2]),
            a[3] + t * (b[3] - a[3]),
            a[4] + t * (b[4] - a[4]),
            a[5] + t * (b[5] - a[5]),
        )
