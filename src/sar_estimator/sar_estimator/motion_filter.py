"""Kalman filters of the helicopter's position, velocity and acceleration.

Two run side by side: a *steady* one that expects little acceleration, and an *agile* one that can
follow a manoeuvre. Both take the same measurements, and each step is one compiled loop over them.
Tests hold each to filterpy's.

The motion model is Singer's: each axis' acceleration is a first-order Markov process of variance
sigma_a^2 and time constant tau (Singer 1970, "Estimating optimal tracking filter performance for
manned maneuvering targets"; Bar-Shalom, Li & Kirubarajan 2001, section 8.2.3).
State order of each: x, vx, ax, y, vy, ay.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from sar_estimator.compiled import compiled
from sar_estimator.states import FloatArray, Motion, MotionEstimate

STATES = 6
STEADY, AGILE = range(2)
POSITION, VELOCITY = range(2)
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


@lru_cache(maxsize=512)
def models(
    dt_s: float, tau_s: float, sigmas_mps2: tuple[float, ...]
) -> tuple[FloatArray, FloatArray]:
    """Return one axis' transition, shape (3, 3), and each filter's process noise, (n, 3, 3).

    Ticks come at the same few times after a fix again and again. Not to be written to.
    """
    transition = singer_transition(dt_s, tau_s)
    noises = np.array([singer_noise(dt_s, tau_s, sigma) for sigma in sigmas_mps2])
    for model in (transition, noises):
        model.setflags(write=False)
    return transition, noises


@compiled(
    "Tuple((float64[:, ::1], float64[:, :, ::1]))"
    "(float64[:, ::1], float64[:, :, ::1], Array(float64, 2, 'C', readonly=True),"
    " Array(float64, 3, 'C', readonly=True))"
)
def carried(
    states: FloatArray, covariances: FloatArray, transition: FloatArray, noises: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return F x and F P F' + Q of each filter, shapes (n, 6) and (n, 6, 6).

    ``transition``, ``noises``: those of one axis, (3, 3) and (n, 3, 3); the axes are moved alike
    and do not act on each other.
    """
    moved, out, half = (
        np.zeros(states.shape),
        np.zeros(covariances.shape),
        np.empty((STATES, STATES)),
    )
    for n in range(states.shape[0]):
        half[:] = 0.0
        for i in range(STATES):
            block = 3 * (i // 3)
            for k in range(3):
                moved[n, i] += transition[i - block, k] * states[n, block + k]
                for j in range(STATES):
                    half[i, j] += transition[i - block, k] * covariances[n, block + k, j]
        for i in range(STATES):
            for j in range(STATES):
                block = 3 * (j // 3)
                if i // 3 == j // 3:
                    out[n, i, j] = noises[n, i - block, j - block]
                for k in range(3):
                    out[n, i, j] += half[i, block + k] * transition[j - block, k]
    return moved, out


@compiled(
    "void(float64[:, ::1], float64[:, :, ::1], int64, UniTuple(float64, 2), UniTuple(float64, 3))"
)
def _update(
    states: FloatArray,
    covariances: FloatArray,
    what: int,
    measured: tuple[float, float],
    noise: Spread,
) -> None:
    """Update each filter, in place, with both axes' positions or velocities (``what``).

    P = (I - K H) P (I - K H)' + K R K', which stays symmetric and positive (Joseph's form;
    Bar-Shalom, Li & Kirubarajan 2001, equation 5.2.3-18).
    """
    x, y = what, 3 + what
    gain, rest, half = np.empty((STATES, 2)), np.empty((STATES, STATES)), np.empty((STATES, STATES))
    for n in range(states.shape[0]):
        state, p = states[n], covariances[n]
        xx, xy, yy = p[x, x] + noise[0], p[x, y] + noise[1], p[y, y] + noise[2]
        determinant = xx * yy - xy * xy
        off_x, off_y = measured[0] - state[x], measured[1] - state[y]
        for i in range(STATES):
            gain[i, 0] = (p[i, x] * yy - p[i, y] * xy) / determinant
            gain[i, 1] = (p[i, y] * xx - p[i, x] * xy) / determinant
        for i in range(STATES):
            state[i] += gain[i, 0] * off_x + gain[i, 1] * off_y
            for j in range(STATES):
                rest[i, j] = p[i, j] - gain[i, 0] * p[x, j] - gain[i, 1] * p[y, j]
            half[i, 0] = gain[i, 0] * noise[0] + gain[i, 1] * noise[1]
            half[i, 1] = gain[i, 0] * noise[1] + gain[i, 1] * noise[2]
        for i in range(STATES):
            for j in range(STATES):
                p[i, j] = rest[i, j] - rest[i, x] * gain[j, 0] - rest[i, y] * gain[j, 1]
                p[i, j] += half[i, 0] * gain[j, 0] + half[i, 1] * gain[j, 1]


@compiled(
    "UniTuple(float64, 2)"
    "(float64[:, ::1], float64[:, :, ::1], UniTuple(float64, 2), UniTuple(float64, 3))"
)
def _surprises(
    states: FloatArray, covariances: FloatArray, measured: tuple[float, float], noise: Spread
) -> tuple[float, float]:
    """Return the normalised innovation squared of a position, by the steady and the agile."""
    found = np.empty(2)
    for n in range(2):
        xx, xy = covariances[n, 0, 0] + noise[0], covariances[n, 0, 3] + noise[1]
        yy = covariances[n, 3, 3] + noise[2]
        dx, dy = measured[0] - states[n, 0], measured[1] - states[n, 3]
        found[n] = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy)
    return found[0], found[1]


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
        self._states = np.array([[position_m[0], 0.0, 0.0, position_m[1], 0.0, 0.0]] * 2)
        one = np.diag([0.0, speed_sigma_mps**2, 1.0] * 2)
        xx, xy, yy = spread_m2
        one[np.ix_([0, 3], [0, 3])] = ((xx, xy), (xy, yy))
        self._covariances = np.array([one, one])
        # Where both were last carried to: a fix's time is asked for again and again.
        self._ahead: tuple[float, FloatArray, FloatArray] | None = None

    @property
    def position(self) -> tuple[float, float]:
        """The agile filter's position [m] at the filters' time."""
        return float(self._states[AGILE, 0]), float(self._states[AGILE, 3])

    def steady(self, time_s: float) -> MotionEstimate:
        """Return the steady estimate carried to ``time_s`` [s]; the filter stays as it is."""
        return self._estimate(STEADY, time_s)

    def agile(self, time_s: float) -> MotionEstimate:
        """Return the agile estimate carried to ``time_s`` [s]; the filter stays as it is."""
        return self._estimate(AGILE, time_s)

    def surprises(
        self, time_s: float, position_m: tuple[float, float], spread_m2: Spread
    ) -> tuple[float, float]:
        """Return the squared Mahalanobis distances of a fix from both (chi-square, 2 dof)."""
        return _surprises(*self._carried(time_s), position_m, spread_m2)

    def _estimate(self, which: int, time_s: float) -> MotionEstimate:
        states, covariances = self._carried(time_s)
        x, vx, ax, y, vy, ay = states[which].tolist()
        return MotionEstimate(Motion(time_s, x, y, vx, vy, ax, ay), covariances[which].copy())

    def _carried(self, time_s: float) -> tuple[FloatArray, FloatArray]:
        """Return both filters' states and covariances at ``time_s`` [s]; not to be changed."""
        dt = time_s - self.time_s
        if dt <= 0.0:
            return self._states, self._covariances
        if self._ahead is None or self._ahead[0] != time_s:
            model = models(round(dt, 9), self._tau_s, self._accels)
            self._ahead = time_s, *carried(self._states, self._covariances, *model)
        return self._ahead[1:]

    def settle(self) -> None:
        """Begin the steady filter again where the agile one is."""
        self._states[STEADY], self._covariances[STEADY] = (
            self._states[AGILE],
            self._covariances[AGILE],
        )
        self._ahead = None

    def advance(self, time_s: float) -> None:
        """Predict to ``time_s`` [s]; the filters' own time, where that is later."""
        self._states, self._covariances = self._carried(time_s)
        self.time_s, self._ahead = max(time_s, self.time_s), None

    def update_position(self, position_m: tuple[float, float], spread_m2: Spread) -> None:
        """Update with a position [m] and its covariance [m^2]."""
        self._ahead = None
        _update(self._states, self._covariances, POSITION, position_m, spread_m2)

    def update_velocity(self, velocity_mps: tuple[float, float], sigma_mps: float) -> None:
        """Update with a velocity [m/s] of standard deviation ``sigma_mps`` on each axis."""
        self._ahead = None
        spread = sigma_mps**2, 0.0, sigma_mps**2
        _update(self._states, self._covariances, VELOCITY, velocity_mps, spread)
