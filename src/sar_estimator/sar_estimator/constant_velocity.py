"""The weighted least-squares design of a constant velocity, one axis or any number of them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sar_estimator.states import FloatArray


def constant_velocity(
    times_s: FloatArray, is_velocity: NDArray[np.bool_], sigmas: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return Q, shape (n, 2), and the inverse of R, shape (2, 2), of the weighted design QR.

    The unknowns are the position at time 0 and the velocity; each of the n measurements, of
    standard deviation ``sigmas``, is of the one or, where ``is_velocity``, of the other. At least
    one must be a position, and two must tell of the velocity. By Gram and Schmidt: two columns.
    """
    weights = 1.0 / sigmas
    first = np.where(is_velocity, 0.0, weights)
    second = np.where(is_velocity, weights, times_s * weights)
    r11 = math.sqrt(first @ first)
    q = np.empty((len(times_s), 2))
    q[:, 0] = first / r11
    r12 = float(q[:, 0] @ second)
    rest = second - r12 * q[:, 0]
    r22 = math.sqrt(rest @ rest)
    q[:, 1] = rest / r22
    return q, np.array([[1.0 / r11, -r12 / (r11 * r22)], [0.0, 1.0 / r22]])
