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
        # One flat list: one of rows would be some ten thousand objects to the garbage collector.
        self._flat: list[float] = np.hstack((places, velocities, accels)).ravel().tolist()
        self._count = len(places)

    @property
    def end_s(self) -> float:
        """The time of the last sample [s]."""
        return STEP_S * (self._count - 1)

    def at(self, time_s: float) -> Motion:
        """Return the motion at a time [s]: cubic Hermite between samples, the ends' outside."""
        at = min(max(time_s / STEP_S, 0.0), self._count - 1.000001)
        i = int(at)
        t, both = at - i, self._flat[6 * i : 6 * i + 12]
        x, y, vx, vy, ax, ay, next_x, next_y, next_vx, next_vy, next_ax, next_ay = both
        h1, h2 = t * t * (3.0 - 2.0 * t), t * (1.0 - t) * (1.0 - t) * STEP_S
        h3 = -t * t * (1.0 - t) * STEP_S
        return Motion(
            time_s,
            x + h1 * (next_x - x) + h2 * vx + h3 * next_vx,
            y + h1 * (next_y - y) + h2 * vy + h3 * next_vy,
            vx + t * (next_vx - vx),
            vy + t * (next_vy - vy),
            ax + t * (next_ax - ax),
            ay + t * (next_ay - ay),
        )
