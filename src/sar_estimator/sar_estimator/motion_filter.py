"""Kalman filter of the helicopter's position, velocity and acceleration (filterpy).

Two filters side by side are one of filterpy's, whose state and covariance are theirs in blocks: a
*steady* one that expects little acceleration, and an *agile* one that can follow a manoeuvre.

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

from sar_estimator.compiled import compiled
from sar_estimator.states import FloatArray, Motion, MotionEstimate

STATES = 6
STEADY, AGILE = slice(0, STATES), slice(STATES, 2 * STATES)


def _in_both(block: FloatArray, other: FloatArray | None = None) -> FloatArray:
    """Return a matrix of two blocks, the second like the first where none is given."""
    rows, columns = block.shape
    both = np.zeros((2 * rows, 2 * columns))
    both[:rows, :columns] = block
    both[rows:, columns:] = block if other is None else other
    return both


@compiled("float64[:, ::1](float64[:, ::1])")
def _inverse(both: FloatArray) -> FloatArray:
    """Return the inverse of two blocks of (2, 2)."""
    out = np.zeros((4, 4))
    for i in range(0, 4, 2):
        determinant = both[i, i] * both[i + 1, i + 1] - both[i, i + 1] * both[i + 1, i]
        out[i, i], out[i + 1, i + 1] = both[i + 1, i + 1] / determinant, both[i, i] / determinant
        out[i, i + 1], out[i + 1, i] = -both[i, i + 1] / determinant, -both[i + 1, i] / determinant
    return out


POSITION = _in_both(np.eye(STATES)[[0, 3]])
VELOCITY = _in_both(np.eye(STATES)[[1, 4]])


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


@lru_cache(maxsize=64)
def _both_models(
    dt_s: float, tau_s: float, steady_mps2: float, agile_mps2: float
) -> tuple[FloatArray, FloatArray]:
    """Return transition and process noise of both filters, shapes (12, 12). Not to be changed."""
    transition, steady = models(dt_s, tau_s, steady_mps2)
    return _in_both(transition), _in_both(steady, models(dt_s, tau_s, agile_mps2)[1])


@compiled(
    "Tuple((float64[::1], float64[:, ::1]))"
    "(float64[:], float64[:, :], Array(float64, 2, 'C', readonly=True),"
    " Array(float64, 2, 'C', readonly=True))"
)
def carried(
    state: FloatArray, covariance: FloatArray, transition: FloatArray, noise: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return F x and F P F' + Q, F's two axes not acting on each other: its blocks are (3, 3)."""
    n = state.size
    moved, half, out = np.zeros(n), np.zeros((n, n)), np.empty((n, n))
    for i in range(n):
        block = 3 * (i // 3)
        for k in range(block, block + 3):
            moved[i] += transition[i, k] * state[k]
            for j in range(n):
                half[i, j] += transition[i, k] * covariance[k, j]
    for i in range(n):
        for j in range(n):
            block = 3 * (j // 3)
            total = noise[i, j]
            for k in range(block, block + 3):
                total += half[i, k] * transition[j, k]
            out[i, j] = total
    return moved, out


class MotionFilters:
    """The steady and the agile filter over one continuous stretch of fixes."""

    def __init__(
        self,
        time_s: float,
        position_m: tuple[float, float],
        covariance_m2: FloatArray,
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
        # What each was last carried to: a fix's time is asked for again and again.
        self._foretold: dict[int, MotionEstimate] = {}
        self._kf = KalmanFilter(dim_x=2 * STATES, dim_z=4)
        self._kf.inv = _inverse
        self._kf.x = np.array([position_m[0], 0.0, 0.0, position_m[1], 0.0, 0.0] * 2)
        one = np.diag([0.0, speed_sigma_mps**2, 1.0] * 2)
        one[np.ix_([0, 3], [0, 3])] = covariance_m2
        self._kf.P = _in_both(one)
        self._fix_noise = np.zeros((4, 4))

    @property
    def position(self) -> tuple[float, float]:
        """The agile filter's position [m] at the filters' time."""
        return float(self._kf.x[STATES]), float(self._kf.x[STATES + 3])

    def steady(self, time_s: float) -> MotionEstimate:
        """Return the steady estimate carried to ``time_s`` [s]; the filter stays as it is."""
        return self._predicted(STEADY, time_s, self._accels[0])

    def agile(self, time_s: float) -> MotionEstimate:
        """Return the agile estimate carried to ``time_s`` [s]; the filter stays as it is."""
        return self._predicted(AGILE, time_s, self._accels[1])

    def _predicted(self, which: slice, time_s: float, sigma_mps2: float) -> MotionEstimate:
        known = self._foretold.get(which.start)
        if known is not None and known.motion.time_s == time_s:
            return known
        dt = time_s - self.time_s
        state, covariance = self._kf.x[which], self._kf.P[which, which]
        if dt > 0.0:
            f, q = models(round(dt, 9), self._tau_s, sigma_mps2)
            state, covariance = carried(state, covariance, f, q)
        else:
            covariance = covariance.copy()
        x, vx, ax, y, vy, ay = state.tolist()
        found = MotionEstimate(Motion(time_s, x, y, vx, vy, ax, ay), covariance)
        self._foretold[which.start] = found
        return found

    def settle(self) -> None:
        """Begin the steady filter again where the agile one is."""
        self._foretold.clear()
        self._kf.x[STEADY] = self._kf.x[AGILE]
        self._kf.P[STEADY, STEADY] = self._kf.P[AGILE, AGILE]

    def advance(self, time_s: float) -> None:
        """Predict to ``time_s`` [s], not before the filters' own time."""
        dt = time_s - self.time_s
        if dt > 0.0:
            f, q = _both_models(round(dt, 9), self._tau_s, *self._accels)
            self._kf.predict(F=f, Q=q)
            self.time_s = time_s
            self._foretold.clear()

    def update_position(self, position_m: tuple[float, float], covariance_m2: FloatArray) -> None:
        """Update with a position [m] and its covariance, shape (2, 2) [m^2]."""
        self._foretold.clear()
        self._fix_noise[:2, :2] = self._fix_noise[2:, 2:] = covariance_m2
        self._kf.update(np.array(position_m * 2), R=self._fix_noise, H=POSITION)

    def update_velocity(self, velocity_mps: tuple[float, float], sigma_mps: float) -> None:
        """Update with a velocity [m/s] of standard deviation ``sigma_mps`` on each axis."""
        self._foretold.clear()
        self._kf.update(np.array(velocity_mps * 2), R=np.eye(4) * sigma_mps**2, H=VELOCITY)


def normalised_innovation(
    estimate: MotionEstimate, position_m: tuple[float, float], covariance_m2: FloatArray
) -> float:
    """Return the squared Mahalanobis distance of a fix from a prediction (chi-square, 2 dof)."""
    dx, dy = position_m[0] - estimate.motion.x_m, position_m[1] - estimate.motion.y_m
    (s11, s12), (_, s22) = (estimate.covariance[::3, ::3] + covariance_m2).tolist()
    distance: float = (s22 * dx**2 - 2.0 * s12 * dx * dy + s11 * dy**2) / (s11 * s22 - s12**2)
    return distance
