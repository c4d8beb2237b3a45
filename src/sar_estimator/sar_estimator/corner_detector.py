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
NEGLIGIBLE_LOG = -45.0  # less than a double's rounding, 10,000 times over
TIME, SIGMA, IS_SPEED, LEFT, Q0, Q1 = range(6)


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


@dataclass(frozen=True, slots=True)
class AccelPrior:
    """Log-normal prior of the deceleration: its harmonic mean [m/s^2] and relative spread.

    The harmonic mean is what makes the expected stopping distance V^2/2a unbiased.
    """

    centre_mps2: float
    spread: float

    def grid(self) -> tuple[FloatArray, FloatArray]:
        """Return accelerations [m/s^2] and log weights, both shape (ACCEL_STEPS,)."""
        z = np.linspace(-ACCEL_SIGMAS, ACCEL_SIGMAS, ACCEL_STEPS)
        weights = np.exp(-0.5 * z**2)
        return self._median * np.exp(self.spread * z), np.log(weights / weights.sum())

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
    "Tuple((float64[:, ::1], UniTuple(float64, 3), float64[::1]))"
    "(float64[::1], float64[::1], float64[::1], boolean[::1])"
)
def _no_slowing(
    times_s: FloatArray, values: FloatArray, sigmas: FloatArray, is_speed: NDArray[np.bool_]
) -> tuple[FloatArray, tuple[float, float, float], FloatArray]:
    """Fit constant speed.

    Returns the measurements, shape (n, 6): time, sigma, whether a speed, what the fit leaves of it
    [sigmas], and its row of Q; the inverse of R (``constant_velocity``); the fit as Q has it.
    """
    q, inverse = constant_velocity(times_s, is_speed, sigmas)
    fit, seen = np.zeros(2), np.empty((times_s.size, 6))
    for i in range(times_s.size):
        fit += q[i] * (values[i] / sigmas[i])
    for i in range(times_s.size):
        left = values[i] / sigmas[i] - q[i, 0] * fit[0] - q[i, 1] * fit[1]
        seen[i, TIME], seen[i, SIGMA] = times_s[i], sigmas[i]
        seen[i, IS_SPEED], seen[i, LEFT] = is_speed[i], left
        seen[i, Q0], seen[i, Q1] = q[i]
    return seen, inverse, fit


@compiled("UniTuple(float64, 4)(float64[:, ::1], int64, float64, float64, float64, float64)")
def _projected(
    seen: FloatArray,
    first: int,
    onset_s: float,
    accel_mps2: float,
    speed_mps: float,
    stopping_s: float,
) -> tuple[float, float, float, float]:
    """Return a slow-down's shape times what is left, times itself, and times the columns of Q.

    ``first``: the first measurement after the onset; before it nothing deviates.
    """
    on_left = square = taken0 = taken1 = 0.0
    for i in range(first, seen.shape[0]):
        since, is_speed = seen[i, TIME] - onset_s, seen[i, IS_SPEED] > 0.0
        shape = deviation(since, is_speed, accel_mps2, speed_mps, stopping_s) / seen[i, SIGMA]
        on_left += shape * seen[i, LEFT]
        square += shape * shape
        taken0 += shape * seen[i, Q0]
        taken1 += shape * seen[i, Q1]
    return on_left, square, taken0, taken1


@compiled("void(float64[:, ::1], float64, float64, float64[::1], float64[:, ::1])")
def _weigh(
    seen: FloatArray,
    speed_mps: float,
    onset_s: float,
    accels_mps2: FloatArray,
    out: FloatArray,
) -> None:
    """Write the log likelihood ratio of each deceleration from an onset to ``out``, shape (n, 3).

    The others of a row are what the columns of Q take up of its shape. While it has not stopped,
    that is its deceleration times one shape that is common to all.
    """
    first = int(np.searchsorted(seen[:, TIME], onset_s))
    since_s = seen[-1, TIME] - onset_s
    common = _projected(seen, first, onset_s, 1.0, speed_mps, math.inf)
    for j in range(accels_mps2.size):
        accel = accels_mps2[j]
        stopping = speed_mps / accel
        on_left, square = accel * common[0], accel * accel * common[1]
        taken0, taken1 = accel * common[2], accel * common[3]
        if since_s > stopping:
            on_left, square, taken0, taken1 = _projected(
                seen, first, onset_s, accel, speed_mps, stopping
            )
        # What the regression takes up of the shape is off its residual.
        rest = square - taken0 * taken0 - taken1 * taken1
        out[j, 0], out[j, 1], out[j, 2] = on_left - 0.5 * rest, taken0, taken1


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
    seen, _, _ = _no_slowing(times_s, values, sigmas, is_speed)
    logs, weighed = np.empty(onsets_s.size * accels_mps2.size), np.empty((accels_mps2.size, 3))
    most, h = -math.inf, 0
    for onset in onsets_s:
        _weigh(seen, speed_mps, onset, accels_mps2, weighed)
        for j in range(accels_mps2.size):
            logs[h] = weighed[j, 0] + log_prior[j]
            most = max(most, logs[h])
            h += 1
    total = 0.0
    for one in logs:
        if one - most > NEGLIGIBLE_LOG:
            total += math.exp(one - most)
    return most + math.log(total)


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
    seen, inverse, fit = _no_slowing(times_s, values, sigmas, is_speed)
    inverse11, inverse12, inverse22 = inverse
    c00 = inverse11 * inverse11 + inverse12 * inverse12
    c01, c11 = inverse12 * inverse22, inverse22 * inverse22
    table = np.empty((8, onsets_s.size * accels_mps2.size))
    weighed = np.empty((accels_mps2.size, 3))
    h = 0
    for onset in onsets_s:
        begun = onset - times_s[-1]
        _weigh(seen, speed_mps, onset, accels_mps2, weighed)
        for j in range(accels_mps2.size):
            accel = accels_mps2[j]
            weight, taken0, taken1 = weighed[j]
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


@lru_cache(maxsize=8)
def decelerations(accel_prior: AccelPrior) -> tuple[FloatArray, FloatArray]:
    """Return a prior's ``grid``. A cruise asks for the same again and again; not to be changed."""
    return accel_prior.grid()


@compiled("UniTuple(float64[::1], 2)(UniTuple(float64, 2), float64[::1])")
def first_grid(
    onset_range_s: tuple[float, float], log_weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return every onset of a range, and the log prior of each deceleration with any of them."""
    onsets = np.arange(onset_range_s[0], onset_range_s[1] + 1e-9, ONSET_STEP_S)
    return onsets, log_weights - math.log(onsets.size)


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
    accels, log_weights = decelerations(accel_prior)
    onsets, log_prior = first_grid(onset_range_s, log_weights)
    measured = (rows.times_s, rows.values, rows.sigmas, rows.is_speed, speed_mps)
    table = hypotheses(*measured, onsets, accels, log_prior)
    means, variances = moments(table).tolist()
    bayes = means[0]
    onset_step, accel_step = ONSET_STEP_S, math.log(accels[1] / accels[0])
    offsets = np.linspace(-1.0, 1.0, FINE_STEPS) if refinements else np.empty(0)
    for _ in range(refinements):
        onset_reach = max(3.0 * math.sqrt(variances[1]), onset_step)
        accel_reach = max(3.0 * math.sqrt(variances[2]), accel_step)
        onsets = np.clip(means[1] + onset_reach * offsets, *onset_range_s)
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
