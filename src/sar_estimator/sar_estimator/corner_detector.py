"""Detection of a deceleration, its onset and strength, and the stop it leads to.

Along a leg the helicopter flies u(t) = u0 + V t; from an unknown onset tau it slows with an unknown
constant a until it stands. A grid over (tau, a) is compared with "no deceleration" by the exact
Gaussian likelihood ratio with u0 and V profiled out (generalised likelihood ratio; Basseville &
Nikiforov 1993, chapter 4), weighted with a prior on a learnt from earlier corners. The same grid
gives the detection statistic and, afterwards, the posterior of the stop point and time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sar_estimator.compiled import compiled
from sar_estimator.constant_velocity import constant_velocity
from sar_estimator.states import FloatArray

ONSET_STEP_S = 0.25
ACCEL_STEPS = 13
ACCEL_SIGMAS = 2.2
FINE_STEPS = 17
MIN_TIME_SIGMA_S = 0.05


@dataclass(frozen=True, slots=True)
class TrackRows:
    """Measurements projected on a leg, in order of time, each array of shape (n,).

    ``values``: along-track positions [m], or speeds [m/s] where ``is_speed``; ``sigmas``: their
    standard deviations.
    """

    times_s: FloatArray
    values: FloatArray
    sigmas: FloatArray
    is_speed: NDArray[np.bool_]


@lru_cache(maxsize=1)
def _normal_grid() -> tuple[FloatArray, FloatArray]:
    """Return standard deviations from the mean and their log weights. Not to be changed."""
    z = np.linspace(-ACCEL_SIGMAS, ACCEL_SIGMAS, ACCEL_STEPS)
    weights = np.exp(-0.5 * z**2)
    return z, np.log(weights / weights.sum())


@dataclass(frozen=True, slots=True)
class AccelPrior:
    """Log-normal prior of the deceleration: its harmonic mean [m/s^2] and relative spread.

    The harmonic mean is what makes the expected stopping distance V^2/2a unbiased.
    """

    centre_mps2: float
    spread: float

    def grid(self) -> tuple[FloatArray, FloatArray]:
        """Return accelerations [m/s^2] and log weights, both shape (ACCEL_STEPS,)."""
        z, log_weights = _normal_grid()
        return self._median * np.exp(self.spread * z), log_weights

    @property
    def _median(self) -> float:
        return self.centre_mps2 * math.exp(0.5 * self.spread**2)

    def log_density(self, log_accels: FloatArray) -> FloatArray:
        """Return the unnormalised log density at log accelerations, the same shape."""
        return np.asarray(-0.5 * ((log_accels - math.log(self._median)) / self.spread) ** 2)


@dataclass(frozen=True, slots=True)
class StopPosterior:
    """Posterior of a deceleration: means and standard deviations along the leg."""

    log_bayes_factor: float
    stop_along_m: float
    stop_along_sigma_m: float
    stop_time_s: float
    stop_time_sigma_s: float
    speed_mps: float
    accel_mps2: float
    accel_sigma_mps2: float


@compiled("float64(float64, boolean, float64, float64, float64)")
def deviation(
    since_s: float,
    is_speed: bool,  # noqa: FBT001 - compiled functions take arguments by position
    accel_mps2: float,
    speed_mps: float,
    stopping_s: float,
) -> float:
    """Return how far slowing to a stand falls behind constant speed, ``since_s`` [s] after onset.

    [m], or [m/s] of a speed. ``stopping_s``: how long the slowing takes.
    """
    slowing = min(max(since_s, 0.0), stopping_s)
    if is_speed:
        return -accel_mps2 * slowing
    return -0.5 * accel_mps2 * slowing * slowing - speed_mps * max(since_s - stopping_s, 0.0)


@compiled(
    "Tuple((float64[:, ::1], UniTuple(float64, 3), float64[::1], float64[::1]))"
    "(float64[::1], float64[::1], float64[::1], boolean[::1])"
)
def _no_slowing(
    times_s: FloatArray, values: FloatArray, sigmas: FloatArray, is_speed: NDArray[np.bool_]
) -> tuple[FloatArray, tuple[float, float, float], FloatArray, FloatArray]:
    """Return the design of constant speed (``constant_velocity``), its fit, and what is left."""
    q, inverse = constant_velocity(times_s, is_speed, sigmas)
    fit = np.zeros(2)
    for i in range(times_s.size):
        fit += q[i] * (values[i] / sigmas[i])
    return q, inverse, fit, values / sigmas - q[:, 0] * fit[0] - q[:, 1] * fit[1]


@compiled(
    "UniTuple(float64, 3)(float64[::1], float64[::1], boolean[::1], float64[:, ::1], float64[::1],"
    " float64, float64, float64)"
)
def _weighed(
    times_s: FloatArray,
    sigmas: FloatArray,
    is_speed: NDArray[np.bool_],
    q: FloatArray,
    free: FloatArray,
    speed_mps: float,
    onset_s: float,
    accel_mps2: float,
) -> tuple[float, float, float]:
    """Return a slow-down's log likelihood ratio, and what the design takes up of its shape."""
    stopping = speed_mps / accel_mps2
    on_free = square = taken0 = taken1 = 0.0
    # Before the onset nothing deviates.
    for i in range(np.searchsorted(times_s, onset_s), times_s.size):
        shape = deviation(times_s[i] - onset_s, is_speed[i], accel_mps2, speed_mps, stopping)
        shape /= sigmas[i]
        on_free += shape * free[i]
        square += shape * shape
        taken0 += shape * q[i, 0]
        taken1 += shape * q[i, 1]
    # What the regression takes up of the shape is off its residual.
    left = square - taken0 * taken0 - taken1 * taken1
    return on_free - 0.5 * left, taken0, taken1


@compiled(
    "float64(float64[::1], float64[::1], float64[::1], boolean[::1], float64, float64[::1],"
    " float64[::1], float64[::1])"
)
def log_bayes_factor(
    times_s: FloatArray,
    values: FloatArray,
    sigmas: FloatArray,
    is_speed: NDArray[np.bool_],
    speed_mps: float,
    onsets_s: FloatArray,
    accels_mps2: FloatArray,
    log_prior: FloatArray,
) -> float:
    """Return that of "slowing" against "not", over the grid of ``hypotheses``."""
    q, _, _, free = _no_slowing(times_s, values, sigmas, is_speed)
    logs = np.empty((onsets_s.size, accels_mps2.size))
    for i in range(onsets_s.size):
        for j in range(accels_mps2.size):
            weight, _, _ = _weighed(
                times_s, sigmas, is_speed, q, free, speed_mps, onsets_s[i], accels_mps2[j]
            )
            logs[i, j] = weight + log_prior[j]
    most = float(logs.max())
    return most + math.log(np.exp(logs - most).sum())


@compiled(
    "float64[:, ::1](float64[::1], float64[::1], float64[::1], boolean[::1], float64,"
    " float64[::1], float64[::1], float64[::1])"
)
def hypotheses(
    times_s: FloatArray,
    values: FloatArray,
    sigmas: FloatArray,
    is_speed: NDArray[np.bool_],
    speed_mps: float,
    onsets_s: FloatArray,
    accels_mps2: FloatArray,
    log_prior: FloatArray,
) -> FloatArray:
    """Weigh every onset, shape (m,), with every deceleration, shape (n,), whose log prior is given.

    Returns a table, shape (8, m n): log weight, onset, log deceleration, deceleration, stop along
    the leg, stop time, speed, variance of the stop.
    """
    q, inverse, fit, free = _no_slowing(times_s, values, sigmas, is_speed)
    inverse11, inverse12, inverse22 = inverse
    c00 = inverse11 * inverse11 + inverse12 * inverse12
    c01, c11 = inverse12 * inverse22, inverse22 * inverse22
    table = np.empty((8, onsets_s.size * accels_mps2.size))
    h = 0
    for onset in onsets_s:
        begun = onset - times_s[-1]
        for j in range(accels_mps2.size):
            accel = accels_mps2[j]
            weight, taken0, taken1 = _weighed(
                times_s, sigmas, is_speed, q, free, speed_mps, onset, accel
            )
            speed = max(inverse22 * (fit[1] - taken1), 0.5)
            place = inverse11 * (fit[0] - taken0) + inverse12 * (fit[1] - taken1)
            slowing = speed / accel
            slope = begun + slowing
            table[0, h] = weight + log_prior[j]
            table[1, h], table[2, h], table[3, h] = onset, math.log(accel), accel
            table[4, h] = place + speed * begun + 0.5 * speed * slowing
            table[5, h], table[6, h] = onset + slowing, speed
            table[7, h] = c00 + 2.0 * slope * c01 + slope * slope * c11
            h += 1
    return table


@compiled("float64[:, ::1](float64[:, ::1])")
def moments(table: FloatArray) -> FloatArray:
    """Return means and variances of a table's rows, shape (2, 8), by the log weights of its first.

    The first mean is the log of the weights' sum.
    """
    rows, count = table.shape
    out = np.zeros((2, rows))
    weights = np.exp(table[0] - table[0].max())
    total = weights.sum()
    out[0, 0] = table[0].max() + math.log(total)
    for row in range(1, rows):
        for h in range(count):
            out[0, row] += weights[h] * table[row, h]
        out[0, row] /= total
        for h in range(count):
            out[1, row] += weights[h] * (table[row, h] - out[0, row]) ** 2
        out[1, row] /= total
    return out


def _grid(
    onset_range_s: tuple[float, float], accel_prior: AccelPrior
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return onsets, decelerations, and the log prior of each pair by deceleration."""
    first, last = onset_range_s
    onsets = np.arange(first, last + 1e-9, ONSET_STEP_S)
    accels, log_prior = accel_prior.grid()
    return onsets, accels, log_prior - math.log(onsets.size)


def slowing_log_bayes(
    rows: TrackRows,
    *,
    onset_range_s: tuple[float, float],
    speed_mps: float,
    accel_prior: AccelPrior,
) -> float:
    """Return the log Bayes factor alone of ``stop_posterior``."""
    measured = (rows.times_s, rows.values, rows.sigmas, rows.is_speed, speed_mps)
    return float(log_bayes_factor(*measured, *_grid(onset_range_s, accel_prior)))


def stop_posterior(
    rows: TrackRows,
    *,
    onset_range_s: tuple[float, float],
    speed_mps: float,
    accel_prior: AccelPrior,
    refinements: int = 0,
) -> StopPosterior:
    """Return the posterior over the grid of onsets in ``onset_range_s`` and decelerations.

    ``refinements``: how often the grid is laid again, finer, about the posterior.

    ``speed_mps`` is the leg's cruise speed, used for where the slowing ends; the speed that is
    reported is profiled per hypothesis. ``log_bayes_factor`` is that of "slowing" against "not".
    """
    first, last = onset_range_s
    onsets, accels, log_prior = _grid(onset_range_s, accel_prior)
    measured = (rows.times_s, rows.values, rows.sigmas, rows.is_speed, speed_mps)
    table = hypotheses(*measured, onsets, accels, log_prior)
    means, variances = moments(table).tolist()
    bayes = means[0]
    onset_step, accel_step = ONSET_STEP_S, math.log(accels[1] / accels[0])
    offsets = np.linspace(-1.0, 1.0, FINE_STEPS) if refinements else np.empty(0)
    for _ in range(refinements):
        onset_reach = max(3.0 * math.sqrt(variances[1]), onset_step)
        accel_reach = max(3.0 * math.sqrt(variances[2]), accel_step)
        onsets = np.clip(means[1] + onset_reach * offsets, first, last)
        log_accels = means[2] + accel_reach * offsets
        log_prior = accel_prior.log_density(log_accels)
        table = hypotheses(*measured, onsets, np.exp(log_accels), log_prior)
        means, variances = moments(table).tolist()
        step = 2.0 / (FINE_STEPS - 1)
        onset_step, accel_step = onset_reach * step, accel_reach * step
    return StopPosterior(
        log_bayes_factor=bayes,
        stop_along_m=means[4],
        stop_along_sigma_m=math.sqrt(variances[4] + means[7]),
        stop_time_s=means[5],
        stop_time_sigma_s=math.hypot(math.sqrt(variances[5]), MIN_TIME_SIGMA_S),
        speed_mps=means[6],
        accel_mps2=means[3],
        accel_sigma_mps2=math.sqrt(variances[3]),
    )
