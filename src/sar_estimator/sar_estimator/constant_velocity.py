"""The weighted least-squares design of a constant velocity, one axis or any number of them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sar_estimator.compiled import compiled
from sar_estimator.states import FloatArray


@compiled(
    "Tuple((float64[:, ::1], UniTuple(float64, 3)))(float64[::1], boolean[::1], float64[::1])"
)
def constant_velocity(
    times_s: FloatArray, is_velocity: NDArray[np.bool_], sigmas: FloatArray
) -> tuple[FloatArray, tuple[float, float, float]]:
    """Return Q, shape (n, 2), and the inverse of R (11, 12, 22), of the weighted design QR.

    The unknowns are the position at the last time and the velocity; each of the n measurements, of
    standard deviation ``sigmas``, is of the one or, where ``is_velocity``, of the other. At least
    one must be a position, and two must tell of the velocity. By Gram and Schmidt: two columns.
    """
    count = times_s.size
    q = np.empty((count, 2))
    r11 = r12 = r22 = 0.0
    for i in range(count):
        q[i, 0] = 0.0 if is_velocity[i] else 1.0 / sigmas[i]
        q[i, 1] = (1.0 if is_velocity[i] else times_s[i] - times_s[count - 1]) / sigmas[i]
        r11 += q[i, 0] * q[i, 0]
    r11 = math.sqrt(r11)
    for i in range(count):
        q[i, 0] /= r11
        r12 += q[i, 0] * q[i, 1]
    for i in range(count):
        q[i, 1] -= r12 * q[i, 0]
        r22 += q[i, 1] * q[i, 1]
    r22 = math.sqrt(r22)
    for i in range(count):
        q[i, 1] /= r22
    return q, (1.0 / r11, -r12 / (r11 * r22), 1.0 / r22)
