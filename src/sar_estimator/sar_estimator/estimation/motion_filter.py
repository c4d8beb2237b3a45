"""Kalman filters of the helicopter's position, velocity and acceleration.

Two of filterpy's run side by side: a *steady* one that expects little acceleration, and an *agile*
one that can follow a manoeuvre. Both take the same measurements.

The motion model is Singer's: each axis' acceleration is a first-order Markov process of variance
sigma_a^2 and time constant tau (Singer 1970, "Estimating optimal tracking filter performance for
manned maneuvering targets"; Bar-Shalom, Li & Kirubarajan 2001, section 8.2.3).
State order of each: x, vx, ax, y, vy, ay.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from filterpy.kalman import KalmanFilter

from sar_estimator.common.states import FloatArray, Motion, MotionEstimate

STATES = 6
STEADY, AGILE = range(2)
POSITION = np.eye(STATES)[[0, 3]]
VELOCITY = np.eye(STATES)[[1, 4]]
Spread = tuple[float, float, float]
"""Covariance of a pair of axes: xx, xy, yy."""


def singer_transition(dt_s: float, tau_s: float) -> FloatArray:
    """Return one axis' transition, shape (3, 3), over ``dt_s`` [s]."""
    alpha = 1.0 / tau_s
    decay = math.exp(-alpha * dt_s)
    return np.array(
        [
            [1.0, dt_s, (alpha * dt_s - 1.0 + decay) / alpha**2],
            [0.0, 1.0, (1.0 - decay) / alpha],
            [0.0, 0.0, decay],
        ]
    )


def singer_noise(dt_s: float, tau_s: float, sigma_mps2: float) -> FloatArray:
    """Return one axis' process noise, shape (3, 3), over ``dt_s`` [s]."""
    a = 1.0 / tau_s
    x = a * dt_s
    e1, e2 = math.exp(-x), math.exp(-2.0 * x)
    pp = (1.0 - e2 + 2.0 * x + 2.0 * x**3 / 3.0 - 2.0 * x**2 - 4.0 * x * e1) / (2.0 * a**5)
    pv = (e2 + 1.0 - 2.0 * e1 + 2.0 * x * e1 - 2.0 * x + x**2) / (2.0 * a**4)
    pa = (1.0 - e2 - 2.0 * x * e1) / (2.0 * a**3)
    vv = (4.0 * e1 - 3.0 - e2 + 2.0 * x) / (2.0 * a**3)
    va = (e2 + 1.0 - 2.0 * e1) / (2.0 * a**2)
    aa = (1.0 - e2) / (2.0 * a)
    return 2.0 * a * sigma_mps2**2 * np.array([[pp, pv, pa], [pv, vv, va], [pa, va, aa]])


def both_axes(block: FloatArray) -> FloatArray:
    """Return the matrix, shape (6, 6), that does to both axes what one, (3, 3), does to one."""
    return np.asarray(np.kron(np.eye(2), block), dtype=np.float64)


@lru_cache(maxsize=512)
def models(
    dt_s: float, tau_s: float, sigmas_mps2: tuple[float, ...]
) -> tuple[FloatArray, tuple[FloatArray, ...]]:
    """Return the transition, shape (6, 6), and each filter's process noise, (6, 6).

    Ticks come at the same few times after a fix again and again. Not to be written to.
    """
    transition = both_axes(singer_transition(dt_s, tau_s))
    noises = tuple(both_axes(singer_noise(dt_s, tau_s, sigma)) for sigma in sigmas_mps2)
    for model in (transition, *noises):
        model.setflags(write=False)
    return transition, noises


def inverse_2x2(matrix: FloatArray) -> FloatArray:
    """Return the inverse of a matrix, shape (2, 2). A library's own takes ten times as long."""
    (a, b), (c, d) = matrix.tolist()
    determinant = a * d - b * c
    return np.array(((d / determinant, -b / determinant), (-c / determinant, a / determinant)))


def _surprise(
    state: FloatArray, covariance: FloatArray, measured: tuple[float, float], noise: Spread
) -> float:
    """Return the normalised innovation squared of a position."""
    xx, xy = covariance.item(0, 0) + noise[0], covariance.item(0, 3) + noise[1]
    yy = covariance.item(3, 3) + noise[2]
    dx, dy = measured[0] - state.item(0), measured[1] - state.item(3)
    return (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy)


class MotionFilters:
    """The steady and the agile filter over one continuous stretch of fixes."""

    def __init__(
        self,
        time_s: float,
        position_m: tuple[float, float],
        spread_m2: Spread,
        *,
        tau_s: float,
        speed_sigma_mps: float,
        accel_sigmas_mps2: tuple[float, float],
    ) -> None:
        """Begin at a first fix; the velocity is unknown by ``speed_sigma_mps`` on each axis.

        ``accel_sigmas_mps2``: the acceleration that the steady and the agile filter expect.
        """
        self.time_s = time_s
        self._tau_s = tau_s
        self._accels = accel_sigmas_mps2
        xx, xy, yy = spread_m2
        self._filters = (KalmanFilter(dim_x=STATES, dim_z=2), KalmanFilter(dim_x=STATES, dim_z=2))
        for one in self._filters:
            one.inv = inverse_2x2
            one.x = np.array([position_m[0], 0.0, 0.0, position_m[1], 0.0, 0.0])
            one.P = np.diag([0.0, speed_sigma_mps**2, 1.0] * 2)
            one.P[np.ix_([0, 3], [0, 3])] = ((xx, xy), (xy, yy))
        # What each was carried to last: a fix's time is asked for again and again.
        self._ahead: list[tuple[float, FloatArray, FloatArray] | None] = [None, None]

    @property
    def position(self) -> tuple[float, float]:
        """The agile filter's position [m] at the filters' time."""
        state = self._filters[AGILE].x
        return float(state[0]), float(state[3])

    def steady(self, time_s: float, altitude_m: float = math.nan) -> MotionEstimate:
        """Return the steady estimate carried to ``time_s`` [s]; the filter stays as it is.

        ``altitude_m``: what is said of the altitude, which is not filtered.
        """
        return self._estimate(STEADY, time_s, altitude_m)

    def agile(self, time_s: float, altitude_m: float = math.nan) -> MotionEstimate:
        """Return the agile estimate carried to ``time_s`` [s], as ``steady``."""
        return self._estimate(AGILE, time_s, altitude_m)

    def surprises(
        self, time_s: float, position_m: tuple[float, float], spread_m2: Spread
    ) -> tuple[float, float]:
        """Return the squared Mahalanobis distances of a fix from both (chi-square, 2 dof)."""
        steady, agile = (
            _surprise(*self._carried(which, time_s), position_m, spread_m2)
            for which in (STEADY, AGILE)
        )
        return steady, agile

    def _estimate(self, which: int, time_s: float, altitude_m: float) -> MotionEstimate:
        state, covariance = self._carried(which, time_s)
        x, vx, ax, y, vy, ay = state.tolist()
        return MotionEstimate(Motion(time_s, x, y, vx, vy, ax, ay), covariance.copy(), altitude_m)

    def _carried(self, which: int, time_s: float) -> tuple[FloatArray, FloatArray]:
        """Return a filter's state and covariance at ``time_s`` [s]; not to be changed."""
        one, dt = self._filters[which], time_s - self.time_s
        if dt <= 0.0:
            return one.x, one.P
        known = self._ahead[which]
        if known is None or known[0] != time_s:
            one.F, noises = models(round(dt, 9), self._tau_s, self._accels)
            one.Q = noises[which]
            known = self._ahead[which] = time_s, *one.get_prediction()
        return known[1], known[2]

    def settle(self) -> None:
        """Begin the steady filter again where the agile one is."""
        steady, agile = self._filters
        steady.x, steady.P = agile.x.copy(), agile.P.copy()
        self._ahead[STEADY] = None

    def advance(self, time_s: float) -> None:
        """Predict to ``time_s`` [s]; the filters' own time, where that is later."""
        for which, one in enumerate(self._filters):
            one.x, one.P = self._carried(which, time_s)
        self.time_s, self._ahead = max(time_s, self.time_s), [None, None]

    def update_position(self, position_m: tuple[float, float], spread_m2: Spread) -> None:
        """Update with a position [m] and its covariance [m^2]."""
        xx, xy, yy = spread_m2
        self._update(POSITION, position_m, np.array(((xx, xy), (xy, yy))))

    def update_velocity(self, velocity_mps: tuple[float, float], sigma_mps: float) -> None:
        """Update with a velocity [m/s] of standard deviation ``sigma_mps`` on each axis."""
        self._update(VELOCITY, velocity_mps, np.eye(2) * sigma_mps**2)

    def _update(self, shown: FloatArray, values: tuple[float, float], noise: FloatArray) -> None:
        self._ahead = [None, None]
        measured = np.array(values)
        for one in self._filters:
            one.update(measured, R=noise, H=shown)
