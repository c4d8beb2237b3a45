"""A leg as a human flies it: a straight line at a steady speed, and a wander about both.

On each axis of the map the helicopter is at p + w. The mean p goes on with a velocity v that hardly
changes; the wander w is a second-order Gauss-Markov process of natural frequency 1 / T and damping
z (Gelb 1974, *Applied Optimal Estimation*, section 3.8),

    w'' = -w / T^2 - 2 z w' / T + white noise,

whose velocity u = w' has a standard deviation that says how the pilot flies: some cm/s of a robot,
0.5 m/s of a gentle pilot, more of a rough one. It is not known, nor how good a receiver's positions
are from one to the next. Kalman filters with every pair of both run side by side; how well each
predicts the measurements is what is believed of it (multiple models; Bar-Shalom, Li & Kirubarajan
2001, section 11.6), with a memory of some minutes that goes on from one leg to the next.

State of one axis: p [m], v [m/s], w [m], u [m/s]. Both axes have one covariance: positions are
taken to be as good along either, and the pilot to wander alike.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_estimator.common.states import FloatArray

WANDER_TIME_S = 16.0
WANDER_DAMPING = 0.7
VELOCITY_WALK = 2e-5  # by which v changes: m^2/s^3, 0.1 m/s in 50 s
SIZES_MPS = (0.03, 0.1, 0.25, 0.6, 1.3, 2.8)
SCALES = (0.2, 0.45, 1.0, 2.0)
MEMORY_S = 240.0
UNKNOWN_PLACE_M = 100.0
LOOSENED_M, LOOSENED_MPS = 10.0, 1.0
EXCESS_S = 120.0
EXCESS_RANGE = (0.7, 6.0)
TIME, X, Y, SIGMA, IS_VELOCITY = range(5)


class Belief(NamedTuple):
    """What is believed of a leg at a time: both axes' means, shape (2, 4), and the covariance.

    ``size_mps``: standard deviation of the wander's velocity; ``scale``: of the positions' white
    errors, over what the receiver says. ``along``, ``across``: mean square of the innovations seen
    along the leg and across it, over what the filters expect: a pilot holds his line and his speed
    differently well.
    """

    time_s: float
    means: FloatArray
    covariance: FloatArray
    size_mps: float
    scale: float
    along: float
    across: float

    @property
    def start(self) -> tuple[float, FloatArray, FloatArray, float, float]:
        """What a filter of the leg begins with: the time, the means, how sure, size and scale."""
        return self.time_s, self.means, self.covariance, self.size_mps, self.scale


@compiled("UniTuple(float64, 4)(float64)")
def wander_transition(dt_s: float) -> tuple[float, float, float, float]:
    """Return how offset and velocity of the wander go on over ``dt_s`` [s]: ww, wu, uw, uu."""
    frequency = 1.0 / WANDER_TIME_S
    damped = frequency * math.sqrt(1.0 - WANDER_DAMPING**2)
    decay = math.exp(-WANDER_DAMPING * frequency * dt_s)
    cosine, sine = math.cos(damped * dt_s), math.sin(damped * dt_s) / damped
    slope = WANDER_DAMPING * frequency * sine
    return (
        decay * (cosine + slope),
        decay * sine,
        -decay * frequency**2 * sine,
        decay * (cosine - slope),
    )


@compiled("void(float64[:, ::1], float64[:, ::1], float64, UniTuple(float64, 4), float64)")
def predict(
    means: FloatArray,
    covariance: FloatArray,
    dt_s: float,
    turn: tuple[float, float, float, float],
    size_mps: float,
) -> None:
    """Carry means, shape (2, 4), and covariance, shape (4, 4), on by ``dt_s`` [s], in place.

    ``turn``: ``wander_transition(dt_s)``. The wander's noise is what keeps its variance as it is
    when nothing is measured: D - F D F', D that of the stationary process.
    """
    ww, wu, uw, uu = turn
    for axis in range(2):
        m = means[axis]
        m[0] += dt_s * m[1]
        m[2], m[3] = ww * m[2] + wu * m[3], uw * m[2] + uu * m[3]
    p = covariance
    for j in range(4):
        p[0, j] += dt_s * p[1, j]
        p[2, j], p[3, j] = ww * p[2, j] + wu * p[3, j], uw * p[2, j] + uu * p[3, j]
    for i in range(4):
        p[i, 0] += dt_s * p[i, 1]
        p[i, 2], p[i, 3] = ww * p[i, 2] + wu * p[i, 3], uw * p[i, 2] + uu * p[i, 3]
    p[0, 0] += VELOCITY_WALK * dt_s**3 / 3.0
    p[0, 1] += VELOCITY_WALK * dt_s**2 / 2.0
    p[1, 0] += VELOCITY_WALK * dt_s**2 / 2.0
    p[1, 1] += VELOCITY_WALK * dt_s
    square, far = size_mps**2, WANDER_TIME_S**2
    p[2, 2] += square * (far - ww * ww * far - wu * wu)
    p[2, 3] -= square * (ww * uw * far + wu * uu)
    p[3, 2] -= square * (ww * uw * far + wu * uu)
    p[3, 3] += square * (1.0 - uw * uw * far - uu * uu)


@compiled(
    "Tuple((float64, float64, float64, UniTuple(float64, 4)))"
    "(float64[:, ::1], float64[:, ::1], float64[::1], float64)"
)
def update(
    means: FloatArray, covariance: FloatArray, row: FloatArray, scale: float
) -> tuple[float, float, float, tuple[float, float, float, float]]:
    """Update with a row, shape (5,), in place; return both innovations, their variance, the gain.

    A position is of p + w, a velocity of v + u.
    """
    first = 1 if row[IS_VELOCITY] > 0.0 else 0
    noise = row[SIGMA] if row[IS_VELOCITY] > 0.0 else scale * row[SIGMA]
    p, second = covariance, first + 2
    column = np.empty(4)
    for i in range(4):
        column[i] = p[i, first] + p[i, second]
    variance = column[first] + column[second] + noise * noise
    off_x = row[X] - means[0, first] - means[0, second]
    off_y = row[Y] - means[1, first] - means[1, second]
    for i in range(4):
        gain = column[i] / variance
        means[0, i] += gain * off_x
        means[1, i] += gain * off_y
        for j in range(4):
            p[i, j] -= gain * column[j]
    gains = (
        column[0] / variance,
        column[1] / variance,
        column[2] / variance,
        column[3] / variance,
    )
    return off_x, off_y, variance, gains


@compiled(
    "float64(float64[:, ::1], float64, float64[:, :, ::1], float64[:, :, ::1], float64[::1],"
    " float64[::1], float64[::1], float64, float64[::1])"
)
def _absorb(
    rows: FloatArray,
    time_s: float,
    means: FloatArray,
    covariances: FloatArray,
    log_weights: FloatArray,
    sizes_mps: FloatArray,
    scales: FloatArray,
    heading_rad: float,
    excess: FloatArray,
) -> float:
    """Take rows, shape (n, 5), into every filter, in place; return the time of the last one.

    ``excess``: the mean square innovations along and across a heading, shape (2,).
    """
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    for i in range(rows.shape[0]):
        dt = max(0.0, rows[i, TIME] - time_s)
        turn = wander_transition(dt)
        kept = math.exp(-dt / MEMORY_S)
        along = across = total = 0.0
        most = log_weights.max()
        for n in range(sizes_mps.size):
            weight = math.exp(log_weights[n] - most)
            predict(means[n], covariances[n], dt, turn, sizes_mps[n])
            x, y, variance, _ = update(means[n], covariances[n], rows[i], scales[n])
            fit = -0.5 * (x * x + y * y) / variance - math.log(variance)
            log_weights[n] = kept * log_weights[n] + fit
            along += weight * (x * c + y * s) ** 2 / variance
            across += weight * (y * c - x * s) ** 2 / variance
            total += weight
        share = 0.5 * (1.0 - math.exp(-max(dt, 0.5) / EXCESS_S))
        excess[0] += share * (along / total - excess[0])
        excess[1] += share * (across / total - excess[1])
        time_s = max(time_s, rows[i, TIME])
    log_weights -= log_weights.max()
    return time_s


@compiled(
    "Tuple((float64[:, ::1], float64[:, ::1], float64, float64))(float64[::1], float64[:, :, ::1],"
    " float64[:, :, ::1], float64[::1], float64[::1])"
)
def _merged(
    log_weights: FloatArray,
    means: FloatArray,
    covariances: FloatArray,
    sizes_mps: FloatArray,
    scales: FloatArray,
) -> tuple[FloatArray, FloatArray, float, float]:
    """Return the filters' common mean and covariance, and what differs, as rms.

    Both axes' differences count, each by half: they have one covariance.
    """
    weights = np.exp(log_weights - log_weights.max())
    weights /= weights.sum()
    mean, covariance, size, scale = np.zeros((2, 4)), np.zeros((4, 4)), 0.0, 0.0
    for n in range(weights.size):
        size += weights[n] * sizes_mps[n] ** 2
        scale += weights[n] * scales[n] ** 2
        for i in range(4):
            mean[0, i] += weights[n] * means[n, 0, i]
            mean[1, i] += weights[n] * means[n, 1, i]
    for n in range(weights.size):
        if weights[n] < 1e-9:
            continue
        for i in range(4):
            for j in range(4):
                x = (means[n, 0, i] - mean[0, i]) * (means[n, 0, j] - mean[0, j])
                y = (means[n, 1, i] - mean[1, i]) * (means[n, 1, j] - mean[1, j])
                covariance[i, j] += weights[n] * (covariances[n, i, j] + 0.5 * (x + y))
    return mean, covariance, math.sqrt(size), math.sqrt(scale)


class LegProcess:
    """The filters of the leg being flown, and what the legs before have told of the pilot."""

    def __init__(self, size_mps: float) -> None:
        """Know nothing but the wander that is expected of a pilot [m/s], to a factor of three."""
        sizes, scales = np.meshgrid(SIZES_MPS, SCALES, indexing="ij")
        self._sizes, self._scales = sizes.ravel().copy(), scales.ravel().copy()
        self._log_weights = -0.5 * (np.log(self._sizes / size_mps) / math.log(3.0)) ** 2
        self._log_weights -= 0.5 * (np.log(self._scales) / math.log(1.6)) ** 2
        self._time_s = -math.inf
        count = self._sizes.size
        self._means, self._covariances = np.zeros((count, 2, 4)), np.zeros((count, 4, 4))
        self._excess = np.ones(2)
        self._belief: Belief | None = None

    def begin(
        self,
        time_s: float,
        position_m: tuple[float, float],
        velocity_mps: tuple[float, float],
        velocity_sigma_mps: float,
    ) -> None:
        """Begin a leg where the helicopter is about at ``position_m``, at a velocity."""
        self._time_s, self._belief = time_s, None
        self._means[:] = 0.0
        for axis in range(2):
            self._means[:, axis, 0] = position_m[axis]
            self._means[:, axis, 1] = velocity_mps[axis]
        self._covariances[:] = 0.0
        self._covariances[:, 0, 0] = UNKNOWN_PLACE_M**2
        self._covariances[:, 1, 1] = velocity_sigma_mps**2
        self._covariances[:, 2, 2] = (WANDER_TIME_S * self._sizes) ** 2
        self._covariances[:, 3, 3] = self._sizes**2

    def loosen(self) -> None:
        """Let the line and the speed be other than was thought."""
        self._belief = None
        self._covariances[:, 0, 0] += LOOSENED_M**2
        self._covariances[:, 1, 1] += LOOSENED_MPS**2

    def absorb(self, rows: FloatArray, heading_rad: float) -> None:
        """Take rows, shape (n, 5), that are older than anything that is still to be weighed."""
        if len(rows):
            self._belief = None
            self._time_s = _absorb(
                rows,
                self._time_s,
                self._means,
                self._covariances,
                self._log_weights,
                self._sizes,
                self._scales,
                heading_rad,
                self._excess,
            )

    @property
    def belief(self) -> Belief:
        """All filters as one: their mean and covariance by weight, and the rms of what differs."""
        if self._belief is None:
            means, covariance, size, scale = _merged(
                self._log_weights, self._means, self._covariances, self._sizes, self._scales
            )
            along, across = np.clip(self._excess, *EXCESS_RANGE).tolist()
            self._belief = Belief(self._time_s, means, covariance, size, scale, along, across)
        return self._belief
