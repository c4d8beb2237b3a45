"""Whether a corner has begun: slow-down, rolled turn, change of speed or course, and wander.

They are weighed against each other in one place. Along a leg the helicopter goes on as its
``LegProcess`` says; from an unknown onset tau on something is added to that: a deceleration a until
it stands, an acceleration across (a turn that is rolled), or a small acceleration for good (a
change of speed or course). Each is a *signature* in the measurements; what the leg's Kalman filter
leaves of it, against what it leaves of the measurements, gives the exact likelihood ratio with all
that is not known of the leg integrated out (Willsky & Jones 1976, "A generalized likelihood ratio
approach to the detection and estimation of jumps in linear systems"). They are averaged over grids
of onsets and strengths with their priors, which gives Bayes factors; and, of a slow-down, the
posterior of the stop point and time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sar_estimator.common.compiled import compiled
from sar_estimator.common.states import FloatArray
from sar_estimator.estimation.leg_process import (
    IS_VELOCITY,
    TIME,
    Belief,
    predict,
    update,
    wander_transition,
)

ONSET_STEP_S = 0.25
ACCEL_STEPS = 9
ACCEL_SIGMAS = 2.2
FINE_STEPS = 17
MIN_TIME_SIGMA_S = 0.05
PRIOR_CORNERS = 1.0  # that the expectation before any was seen is worth
SPREAD_RANGE = (0.1, 0.5)
LEARNT_RANGE = 1.8
FINE_S, COARSE_STEP_S = 4.0, 0.5
NEGLIGIBLE_LOG = -45.0  # less than a double's rounding, 10,000 times over
TURN_ACCELS_MPS2 = np.array([2.0, 2.8, 4.0])
CHANGE_ACCELS_MPS2 = np.array([0.3, 0.7])
LOG_CHANGE = math.log(0.004)  # how often a small change is under way, over nothing
# What ``filtered`` keeps of every row: its time, whether a velocity, the time since the row before,
# the wander's transition, the gain, the innovations' variance, and both innovations.
SEEN, KIND, STEP, TURN, GAIN, VARIANCE, ALONG, ACROSS = 0, 1, 2, 3, 7, 11, 12, 13
COLUMNS = 14


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


class Decelerations:
    """What the corners of a flight tell of the decelerations to come.

    Their logarithms are normal, of a mean and a variance that are both learnt (conjugate prior,
    normal and inverse gamma; Gelman et al. 2013, *Bayesian Data Analysis*, section 3.3): of a pilot
    who always slows alike the next is known well, of another it is not.
    """

    def __init__(self, centre_mps2: float, spread: float) -> None:
        """Expect a harmonic mean [m/s^2] and a relative spread before any corner was seen."""
        self._count, self._shape = PRIOR_CORNERS, 0.5 * PRIOR_CORNERS + 0.5
        self._mean = math.log(centre_mps2) + 0.5 * spread**2
        self._scale = spread**2 * self._shape * self._count / (self._count + 1.0)
        self._first = centre_mps2

    def add(self, accel_mps2: float) -> None:
        """Take a corner's deceleration [m/s^2]."""
        off = math.log(accel_mps2) - self._mean
        self._scale += 0.5 * self._count / (self._count + 1.0) * off**2
        self._shape += 0.5
        self._count += 1.0
        self._mean += off / self._count

    @property
    def expected(self) -> AccelPrior:
        """What is expected of the next, within reason."""
        variance = self._scale / self._shape * (self._count + 1.0) / self._count
        spread = min(max(math.sqrt(variance), SPREAD_RANGE[0]), SPREAD_RANGE[1])
        centre = math.exp(self._mean - 0.5 * spread**2)
        centre = min(max(centre, self._first / LEARNT_RANGE), self._first * LEARNT_RANGE)
        return AccelPrior(centre, spread)


class Watch(NamedTuple):
    """What the newest rows say of a leg.

    ``slowing``, ``turning``: log Bayes factors of a slow-down and of a rolled turn, against all
    else that is no corner. ``turn_mps2``: the turn's acceleration across, left positive.
    ``misfit``: how badly the leg alone predicts the rows, in standard deviations. ``means``,
    ``covariance``: the leg's belief at the last row, as if no corner had begun.
    """

    slowing: float
    turning: float
    turn_mps2: float
    misfit: float
    means: FloatArray
    covariance: FloatArray


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
    "Tuple((float64[:, ::1], float64[:, ::1], float64[:, ::1]))(float64[:, ::1], float64,"
    " float64[:, ::1], float64[:, ::1], float64, float64, float64)"
)
def filtered(
    rows: FloatArray,
    time_s: float,
    means: FloatArray,
    covariance: FloatArray,
    size_mps: float,
    scale: float,
    heading_rad: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Run a leg's filter over rows, shape (n, 5), from a belief at ``time_s``.

    Returns what is kept of every row, shape (n, ``COLUMNS``), innovations along and across a
    heading; and the belief at the last row.
    """
    means, covariance = means.copy(), covariance.copy()
    out = np.empty((rows.shape[0], COLUMNS))
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    for i in range(rows.shape[0]):
        dt = max(0.0, rows[i, TIME] - time_s)
        turn = wander_transition(dt)
        predict(means, covariance, dt, turn, size_mps)
        x, y, variance, gains = update(means, covariance, rows[i], scale)
        out[i, SEEN], out[i, KIND], out[i, STEP] = rows[i, TIME], rows[i, IS_VELOCITY], dt
        for k in range(4):
            out[i, TURN + k], out[i, GAIN + k] = turn[k], gains[k]
        out[i, VARIANCE] = variance
        out[i, ALONG], out[i, ACROSS] = x * c + y * s, y * c - x * s
        time_s = max(time_s, rows[i, TIME])
    return out, means, covariance


@compiled("UniTuple(float64, 7)(float64[:, ::1], int64, float64, float64, float64, float64)")
def _projected(
    seen: FloatArray,
    first: int,
    onset_s: float,
    accel_mps2: float,
    speed_mps: float,
    stopping_s: float,
) -> tuple[float, float, float, float, float, float, float]:
    """Return what the filter leaves of a slow-down's signature, times what it leaves of the rows.

    Along, across, and times itself; and what of the signature the filter took for the leg's own: p,
    v, w, u. ``first``: the first row after the onset.
    """
    p = v = w = u = along = across = square = 0.0
    for i in range(first, seen.shape[0]):
        row = seen[i]
        p += row[STEP] * v
        w, u = row[TURN] * w + row[TURN + 1] * u, row[TURN + 2] * w + row[TURN + 3] * u
        is_speed = row[KIND] > 0.0
        left = deviation(row[SEEN] - onset_s, is_speed, accel_mps2, speed_mps, stopping_s)
        left -= v + u if is_speed else p + w
        weighed = left / row[VARIANCE]
        along += weighed * row[ALONG]
        across += weighed * row[ACROSS]
        square += weighed * left
        p, v = p + row[GAIN] * left, v + row[GAIN + 1] * left
        w, u = w + row[GAIN + 2] * left, u + row[GAIN + 3] * left
    return along, across, square, p, v, w, u


@compiled("int64(float64[:, ::1], float64)")
def _first_after(seen: FloatArray, time_s: float) -> int:
    """Return the number of the first row later than a time [s]."""
    first: int = seen.shape[0]
    while first > 0 and seen[first - 1, SEEN] > time_s:
        first -= 1
    return first


@compiled("float64(float64[::1])")
def _log_sum(logs: FloatArray) -> float:
    """Return log(sum(exp(logs)))."""
    most, total = float(logs.max()), 0.0
    for one in logs:
        if one - most > NEGLIGIBLE_LOG:
            total += math.exp(one - most)
    return most + math.log(total)


@compiled("float64(float64)")
def _or_nothing(log_change: float) -> float:
    """Return the log likelihood ratio of a small change, as seldom as it is, or nothing."""
    change = LOG_CHANGE + log_change
    return max(0.0, change) + math.log1p(math.exp(-abs(change)))


@compiled(
    "UniTuple(float64, 3)(float64[:, ::1], float64, float64[::1], float64[::1], float64[::1],"
    " float64[::1], float64[::1], float64, float64)"
)
def _weighed(
    seen: FloatArray,
    speed_mps: float,
    onsets_s: FloatArray,
    accels_mps2: FloatArray,
    log_weights: FloatArray,
    turns_mps2: FloatArray,
    changes_mps2: FloatArray,
    excess_along: float,
    excess_across: float,
) -> tuple[float, float, float]:
    """Return log Bayes factors of slowing and turning, and the turn's acceleration, left positive.

    Slowing is held against the leg alone or a small change of speed, turning against the leg alone
    or a small change of course: both can happen at once, and along and across are independent.
    ``excess_along``, ``excess_across``: by how much the innovations' variances are larger than the
    filter has them. In one piece: it is compiled, and all of it shares what is worked out for an
    onset.
    """
    count = onsets_s.size
    slowing = np.empty((count, accels_mps2.size))
    turning = np.empty((count, 2 * turns_mps2.size))
    slower = np.empty((count, 2 * changes_mps2.size))
    aside = np.empty((count, 2 * changes_mps2.size))
    for i in range(count):
        onset = onsets_s[i]
        first = _first_after(seen, onset)
        common = _projected(seen, first, onset, 1.0, speed_mps, math.inf)
        along, across = common[0] / excess_along, common[1] / excess_across
        square_along, square_across = common[2] / excess_along, common[2] / excess_across
        since_s = seen[-1, SEEN] - onset
        for j in range(accels_mps2.size):
            a = accels_mps2[j]
            fit = a * along - 0.5 * a * a * square_along
            if since_s > speed_mps / a:
                whole = _projected(seen, first, onset, a, speed_mps, speed_mps / a)
                fit = (whole[0] - 0.5 * whole[2]) / excess_along
            slowing[i, j] = fit + log_weights[j]
        for j in range(turns_mps2.size):
            # The signature is of falling behind: to the left is its negative.
            a = turns_mps2[j]
            turning[i, 2 * j] = -a * across - 0.5 * a * a * square_across
            turning[i, 2 * j + 1] = a * across - 0.5 * a * a * square_across
        for j in range(changes_mps2.size):
            a = changes_mps2[j]
            slower[i, 2 * j] = a * along - 0.5 * a * a * square_along
            slower[i, 2 * j + 1] = -a * along - 0.5 * a * a * square_along
            aside[i, 2 * j] = a * across - 0.5 * a * a * square_across
            aside[i, 2 * j + 1] = -a * across - 0.5 * a * a * square_across
    turn = total = 0.0
    most = turning.max()
    for i in range(count):
        for j in range(turns_mps2.size):
            for side in range(2):
                if turning[i, 2 * j + side] - most > NEGLIGIBLE_LOG:
                    weight = math.exp(turning[i, 2 * j + side] - most)
                    turn += (1.0 - 2.0 * side) * weight * turns_mps2[j]
                    total += weight
    spread = math.log(count * 2.0 * changes_mps2.size)
    return (
        _log_sum(slowing.ravel())
        - math.log(count)
        - _or_nothing(_log_sum(slower.ravel()) - spread),
        most
        + math.log(total)
        - math.log(count * 2.0 * turns_mps2.size)
        - _or_nothing(_log_sum(aside.ravel()) - spread),
        turn / total,
    )


@compiled(
    "Tuple((UniTuple(float64, 4), float64[:, ::1], float64[:, ::1]))(float64[:, ::1], float64,"
    " float64[:, ::1], float64[:, ::1], float64, float64, float64, float64, float64,"
    " float64[::1], float64[::1], float64[::1], float64[::1], float64[::1])"
)
def _watched(
    rows: FloatArray,
    time_s: float,
    means: FloatArray,
    covariance: FloatArray,
    size_mps: float,
    scale: float,
    excess_along: float,
    excess_across: float,
    heading_rad: float,
    onsets_s: FloatArray,
    accels_mps2: FloatArray,
    log_weights: FloatArray,
    turns_mps2: FloatArray,
    changes_mps2: FloatArray,
) -> tuple[tuple[float, float, float, float], FloatArray, FloatArray]:
    """Return slowing, turning, the turn and the misfit, and the belief at the last row."""
    seen, last, spread = filtered(rows, time_s, means, covariance, size_mps, scale, heading_rad)
    speed = math.hypot(last[0, 1] + last[0, 3], last[1, 1] + last[1, 3])
    slowing, turning, turn = _weighed(
        seen,
        max(speed, 1.0),
        onsets_s,
        accels_mps2,
        log_weights,
        turns_mps2,
        changes_mps2,
        excess_along,
        excess_across,
    )
    chi_square, dof = 0.0, 2.0 * max(1, seen.shape[0])
    for i in range(seen.shape[0]):
        along = seen[i, ALONG] ** 2 / excess_along
        chi_square += (along + seen[i, ACROSS] ** 2 / excess_across) / seen[i, VARIANCE]
    # As standard deviations of a normal (Wilson & Hilferty 1931).
    variance = 2.0 / (9.0 * dof)
    misfit = (float(np.cbrt(chi_square / dof)) - 1.0 + variance) / math.sqrt(variance)
    return (slowing, turning, turn, misfit), last, spread


def onsets(from_s: float, until_s: float) -> FloatArray:
    """Return the onsets that are weighed, shape (n,): close for the newest, then farther apart.

    There is always one, ``until_s``. They are laid out from there, since a time may be of the
    epoch, where a double is no finer than 0.2 us.
    """
    ago_s = until_s - from_s
    near = ONSET_STEP_S * np.arange(_steps(min(ago_s, FINE_S), ONSET_STEP_S) + 1)
    far = FINE_S + COARSE_STEP_S * np.arange(1, _steps(ago_s - FINE_S, COARSE_STEP_S) + 1)
    return until_s - np.concatenate((near, far))


def _steps(length: float, step: float) -> int:
    """Return how many whole steps a length has room for, but for rounding."""
    return max(0, math.floor(length / step + 1e-5))


def watch(
    rows: FloatArray,
    belief: Belief,
    heading_rad: float,
    *,
    onset_range_s: tuple[float, float],
    accel_prior: AccelPrior,
) -> Watch:
    """Weigh the rows, shape (n, 5), that came after a belief of a leg.

    ``onset_range_s``: when a corner may have begun; ``heading_rad``: of the leg.
    """
    figures, means, covariance = _watched(
        rows,
        *belief,
        heading_rad,
        onsets(*onset_range_s),
        *decelerations(accel_prior),
        TURN_ACCELS_MPS2,
        CHANGE_ACCELS_MPS2,
    )
    return Watch(*figures, means, covariance)


@compiled(
    "float64[:, ::1](float64[:, ::1], float64[:, ::1], float64[:, ::1], float64, UniTuple(float64,"
    " 2), float64[::1], float64[::1], float64[::1])"
)
def hypotheses(
    seen: FloatArray,
    means: FloatArray,
    covariance: FloatArray,
    heading_rad: float,
    origin_m: tuple[float, float],
    onsets_s: FloatArray,
    accels_mps2: FloatArray,
    log_prior: FloatArray,
) -> FloatArray:
    """Weigh every onset, shape (m,), with every deceleration, shape (n,), whose log prior is given.

    ``seen``, ``means``, ``covariance``: of ``filtered``. Returns a table, shape (8, m n): log
    weight, onset, log deceleration, deceleration, stop along the heading from ``origin_m``, stop
    time, cruise speed, variance of the stop.
    """
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    p0 = (means[0, 0] - origin_m[0]) * c + (means[1, 0] - origin_m[1]) * s
    v0 = means[0, 1] * c + means[1, 1] * s
    w0 = means[0, 2] * c + means[1, 2] * s
    u0 = means[0, 3] * c + means[1, 3] * s
    table = np.empty((8, onsets_s.size * accels_mps2.size))
    now_s = seen[-1, SEEN]
    h = 0
    for onset in onsets_s:
        first = _first_after(seen, onset)
        common = _projected(seen, first, onset, 1.0, 1.0, math.inf)
        for j in range(accels_mps2.size):
            a = accels_mps2[j]
            along, square = a * common[0], a * a * common[2]
            p, v = p0 - a * common[3], v0 - a * common[4]
            w, u = w0 - a * common[5], u0 - a * common[6]
            speed = max(v + u, 0.5)
            stopping = speed / a
            if now_s - onset > stopping:
                along, _, square, dp, dv, dw, du = _projected(
                    seen, first, onset, a, speed, stopping
                )
                p, v, w, u = p0 - dp, v0 - dv, w0 - dw, u0 - du
                speed = max(v + u, 0.5)
                stopping = speed / a
            # The line is known for the last row; it goes on as it was at the onset.
            begun = onset - now_s
            slope = begun + stopping
            table[0, h] = along - 0.5 * square + log_prior[j]
            table[1, h], table[2, h], table[3, h] = onset, math.log(a), a
            table[4, h] = p + w + (v + u) * begun + 0.5 * speed * stopping
            table[5, h], table[6, h] = onset + stopping, max(v, 0.5)
            place = covariance[0, 0] + 2.0 * covariance[0, 2] + covariance[2, 2]
            both = covariance[0, 1] + covariance[0, 3] + covariance[2, 1] + covariance[2, 3]
            rate = covariance[1, 1] + 2.0 * covariance[1, 3] + covariance[3, 3]
            table[7, h] = max(0.0, place + 2.0 * slope * both + slope * slope * rate)
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


def stop_posterior(
    rows: FloatArray,
    belief: Belief,
    heading_rad: float,
    *,
    onset_range_s: tuple[float, float],
    accel_prior: AccelPrior,
    origin_m: tuple[float, float],
    refinements: int = 0,
) -> StopPosterior:
    """Return the posterior over the grid of onsets in ``onset_range_s`` and decelerations.

    ``rows``, ``belief``: as for ``watch``. ``origin_m``: from where the stop is told along the
    heading. ``refinements``: how often the grid is laid again, finer, about the posterior.
    ``log_bayes_factor`` is that of "slowing" against the leg alone.
    """
    accels, log_weights = decelerations(accel_prior)
    from_s, until_s = onset_range_s
    count = _steps(until_s - from_s, ONSET_STEP_S) + 1
    grid: FloatArray = from_s + ONSET_STEP_S * np.arange(count, dtype=np.float64)
    seen, means, covariance = filtered(rows, *belief.start, heading_rad)
    seen[:, VARIANCE] *= belief.along
    measured = (seen, means, covariance, heading_rad, origin_m)
    table = hypotheses(*measured, grid, accels, log_weights - math.log(grid.size))
    found, variances = moments(table).tolist()
    bayes = found[0]
    onset_step, accel_step = ONSET_STEP_S, math.log(accels[1] / accels[0])
    offsets = np.linspace(-1.0, 1.0, FINE_STEPS) if refinements else np.empty(0)
    for _ in range(refinements):
        onset_reach = max(3.0 * math.sqrt(variances[1]), onset_step)
        accel_reach = max(3.0 * math.sqrt(variances[2]), accel_step)
        grid = np.clip(found[1] + onset_reach * offsets, *onset_range_s)
        log_accels = found[2] + accel_reach * offsets
        log_prior = accel_prior.log_density(log_accels)
        table = hypotheses(*measured, grid, np.exp(log_accels), log_prior)
        found, variances = moments(table).tolist()
        step = 2.0 / (FINE_STEPS - 1)
        onset_step, accel_step = onset_reach * step, accel_reach * step
    return StopPosterior(
        log_bayes_factor=bayes,
        stop_along_m=found[4],
        stop_along_sigma_m=math.sqrt(variances[4] + found[7]),
        stop_time_s=found[5],
        stop_time_sigma_s=math.hypot(math.sqrt(variances[5]), MIN_TIME_SIGMA_S),
        speed_mps=found[6],
        accel_mps2=found[3],
        accel_sigma_mps2=math.sqrt(variances[3]),
    )
