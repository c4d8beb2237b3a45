"""Kalman filter of the helicopter's position, velocity and acceleration (filterpy).

The motion model is Singer's: each axis' acceleration is a first-order Markov process of variance
sigma_a^2 and time constant tau (Singer 1970, "Estimating optimal tracking filter performance for
manned maneuvering targets"; Bar-Shalom, Li & Kirubarajan 2001, section 8.2.3).
State order: x, vx, ax, y, vy, ay.
"""

from __future__ import annotations

import copy
import math
from functools import lru_cache

import numpy as np
from filterpy.kalman import KalmanFilter

from sar_estimator.states import FloatArray, Motion, MotionEstimate

POSITION = np.array([[1.0, 0, 0, 0, 0, 0], [0, 0, 0, 1.0, 0, 0]])
VELOCITY = np.array([[0, 1.0, 0, 0, 0, 0], [0, 0, 0, 0, 1.0, 0]])


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


@lru_cache(maxsize=512)
def models(dt_s: float, tau_s: float, sigma_mps2: float) -> tuple[FloatArray, FloatArray]:
    """Return transition and process noise of both axes, shapes (6, 6), over ``dt_s`` [s].

    Ticks come at the same few times after a fix again and again. Not to be written to.
    """
    transition, noise = np.zeros((6, 6)), np.zeros((6, 6))
    transition[:3, :3] = transition[3:, 3:] = singer_transition(dt_s, tau_s)
    noise[:3, :3] = noise[3:, 3:] = singer_noise(dt_s, tau_s, sigma_mps2)
    for model in (transition, noise):
        model.setflags(write=False)
    return transition, noise


class MotionFilter:
    """The filter over one continuous stretch of fixes."""

    def __init__(
        self,
        time_s: float,
        position_m: tuple[float, float],
        covariance_m2: FloatArray,
        *,
        tau_s: float,
        speed_sigma_mps: float,
    ) -> None:
        """Begin at a first fix; the velocity is unknown by ``speed_sigma_mps`` on each axis."""
        self.time_s = time_s
        self._tau_s = tau_s
        self._kf = KalmanFilter(dim_x=6, dim_z=2)
        self._kf.x = np.array([position_m[0], 0.0, 0.0, position_m[1], 0.0, 0.0])
        self._kf.P = np.diag([0.0, speed_sigma_mps**2, 1.0] * 2)
        self._kf.P[np.ix_([0, 3], [0, 3])] = covariance_m2
        self._kf.H = POSITION

    def copy(self) -> MotionFilter:
        """Return a filter in the same state."""
        return copy.deepcopy(self)

    @property
    def position(self) -> tuple[float, float]:
        """The position [m] at the filter's time."""
        return float(self._kf.x[0]), float(self._kf.x[3])

    def predicted(self, time_s: float, sigma_mps2: float) -> MotionEstimate:
        """Return the estimate carried to ``time_s`` [s]; the filter itself stays as it is."""
        dt = time_s - self.time_s
        state, covariance = self._kf.x, self._kf.P
        if dt > 0.0:
            f, q = models(round(dt, 9), self._tau_s, sigma_mps2)
            state, covariance = f @ state, f @ covariance @ f.T + q
        x, vx, ax, y, vy, ay = state.tolist()
        return MotionEstimate(Motion(time_s, x, y, vx, vy, ax, ay), np.array(covariance))

    def advance(self, time_s: float, sigma_mps2: float) -> None:
        """Predict to ``time_s`` [s], not before the filter's own time."""
        dt = time_s - self.time_s
        if dt > 0.0:
            f, q = models(round(dt, 9), self._tau_s, sigma_mps2)
            self._kf.predict(F=f, Q=q)
            self.time_s = time_s

    def update_position(self, position_m: tuple[float, float], covariance_m2: FloatArray) -> None:
        """Update with a position [m] and its covariance, shape (2, 2) [m^2]."""
        self._kf.update(np.asarray(position_m), R=covariance_m2, H=POSITION)

    def update_velocity(self, velocity_mps: tuple[float, float], sigma_mps: float) -> None:
        """Update with a velocity [m/s] of standard deviation ``sigma_mps`` on each axis."""
        self._kf.update(np.asarray(velocity_mps), R=np.eye(2) * sigma_mps**2, H=VELOCITY)


def normalised_innovation(
    estimate: MotionEstimate, position_m: tuple[float, float], covariance_m2: FloatArray
) -> float:
    """Return the squared Mahalanobis distance of a fix from a prediction (chi-square, 2 dof)."""
    innovation = np.array(
        [position_m[0] - estimate.motion.x_m, position_m[1] - estimate.motion.y_m]
    )
    spread = POSITION @ estimate.covariance @ POSITION.T + covariance_m2
    return float(innovation @ np.linalg.solve(spread, innovation))
