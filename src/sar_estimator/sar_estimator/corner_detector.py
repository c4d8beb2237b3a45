"""Detection of a deceleration, its onset and strength, and the stop it leads to.

Along a leg the helicopter flies u(t) = u0 + V t; from an unknown onset tau it slows with an unknown
constant a until it stands. A grid over (tau, a) is compared with "no deceleration" by the exact
Gaussian likelihood ratio with u0 and V profiled out (generalised likelihood ratio; Basseville &
Nikiforov 1993, chapter 4), weighted with a prior on a learnt from earlier corners. The same grid
gives the detection statistic and, afterwards, the posterior of the stop point and time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

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

    def since(self, time_s: float) -> TrackRows:
        """Return the rows from the first that is not older on."""
        begin = int(np.searchsorted(self.times_s, time_s))
        return TrackRows(
            self.times_s[begin:], self.values[begin:], self.sigmas[begin:], self.is_speed[begin:]
        )


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


def deviations(
    rows: TrackRows, onsets_s: FloatArray, accels_mps2: FloatArray, speed_mps: float
) -> FloatArray:
    """Return departures from constant speed, shape (hypotheses, n), of slowing to a stand."""
    slowing = rows.times_s[None, :] - onsets_s[:, None]
    a = accels_mps2[:, None]
    until_stop = np.clip(slowing, 0.0, speed_mps / a)
    standing = np.maximum(slowing - speed_mps / a, 0.0)
    shift = -0.5 * a * until_stop**2 - speed_mps * standing
    return np.asarray(np.where(rows.is_speed[None, :], -a * until_stop, shift))


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
    taus = np.arange(first, last + 1e-9, ONSET_STEP_S)
    accels, log_weights = accel_prior.grid()
    onsets = np.repeat(taus, accels.size)
    log_prior = np.tile(log_weights, taus.size) - math.log(taus.size)
    design = _Design(rows, speed_mps)
    coarse = design.posterior(onsets, np.tile(accels, taus.size), log_prior)
    if refinements == 0:
        return coarse.summary()
    bayes = coarse.log_bayes_factor
    spread = math.log(accels[1] / accels[0])
    steps = (ONSET_STEP_S, spread)
    for _ in range(refinements):
        coarse, steps = design.refined(coarse, steps, accel_prior, (first, last))
    return replace(coarse.summary(), log_bayes_factor=bayes)


@dataclass(frozen=True)
class _Grid:
    """Hypotheses, their posterior weights, and what each says of the stop."""

    onsets_s: FloatArray
    accels_mps2: FloatArray
    weights: FloatArray
    log_bayes_factor: float
    speeds_mps: FloatArray
    stops_m: FloatArray
    stop_variances_m2: FloatArray

    def moments(self, values: FloatArray) -> tuple[float, float]:
        """Return the weighted mean and standard deviation."""
        mean = float(self.weights @ values)
        return mean, math.sqrt(float(self.weights @ (values - mean) ** 2))

    def summary(self) -> StopPosterior:
        """Return the moments that are reported."""
        stop, stop_sigma = self.moments(self.stops_m)
        stop_time, stop_time_sigma = self.moments(
            self.onsets_s + self.speeds_mps / self.accels_mps2
        )
        accel, accel_sigma = self.moments(self.accels_mps2)
        return StopPosterior(
            log_bayes_factor=self.log_bayes_factor,
            stop_along_m=stop,
            stop_along_sigma_m=math.sqrt(
                stop_sigma**2 + float(self.weights @ self.stop_variances_m2)
            ),
            stop_time_s=stop_time,
            stop_time_sigma_s=math.hypot(stop_time_sigma, MIN_TIME_SIGMA_S),
            speed_mps=float(self.weights @ self.speeds_mps),
            accel_mps2=accel,
            accel_sigma_mps2=accel_sigma,
        )


class _Design:
    """The constant-speed regression that every hypothesis is compared with."""

    def __init__(self, rows: TrackRows, speed_mps: float) -> None:
        self._rows, self._speed_mps = rows, speed_mps
        self._reference = float(rows.times_s[-1])
        self._q, self._r_inverse = constant_velocity(
            rows.times_s - self._reference, rows.is_speed, rows.sigmas
        )
        y = rows.values / rows.sigmas
        self._fit = self._q.T @ y
        self._free = y - self._q @ self._fit

    def posterior(
        self, onsets_s: FloatArray, accels_mps2: FloatArray, log_prior: FloatArray
    ) -> _Grid:
        """Weigh hypotheses, all arrays of shape (h,), by their likelihood ratio."""
        # Before the first onset nothing deviates; what the regression takes up is off its residual.
        late = self._rows.since(float(onsets_s.min()))
        shapes = deviations(late, onsets_s, accels_mps2, self._speed_mps)
        shapes /= late.sigmas
        skipped = len(self._free) - len(late.sigmas)
        shapes_q = shapes @ self._q[skipped:]
        left = np.einsum("ij,ij->i", shapes, shapes) - np.einsum("ij,ij->i", shapes_q, shapes_q)
        log_ratio = shapes @ self._free[skipped:] - 0.5 * left
        log_weights = log_ratio + log_prior
        peak = float(log_weights.max())
        weights = np.exp(log_weights - peak)
        total = float(weights.sum())

        fits = (self._fit[None, :] - shapes_q) @ self._r_inverse.T
        speeds = np.maximum(fits[:, 1], 0.5)
        slowing_s = speeds / accels_mps2
        begun_s = onsets_s - self._reference
        slopes = begun_s + slowing_s
        c = self._r_inverse @ self._r_inverse.T
        return _Grid(
            onsets_s,
            accels_mps2,
            weights / total,
            peak + math.log(total),
            speeds,
            fits[:, 0] + speeds * begun_s + 0.5 * speeds * slowing_s,
            c[0, 0] + 2.0 * slopes * c[0, 1] + slopes**2 * c[1, 1],
        )

    def refined(
        self,
        grid: _Grid,
        steps: tuple[float, float],
        accel_prior: AccelPrior,
        onset_range_s: tuple[float, float],
    ) -> tuple[_Grid, tuple[float, float]]:
        """Return a finer grid about the posterior of a coarser one, and its steps."""
        onset, onset_sigma = grid.moments(grid.onsets_s)
        log_accel, log_accel_sigma = grid.moments(np.log(grid.accels_mps2))
        offsets = np.linspace(-1.0, 1.0, FINE_STEPS)
        onset_reach = max(3.0 * onset_sigma, steps[0])
        accel_reach = max(3.0 * log_accel_sigma, steps[1])
        taus = np.clip(onset + onset_reach * offsets, *onset_range_s)
        log_accels = log_accel + accel_reach * offsets
        log_prior = np.tile(accel_prior.log_density(log_accels), FINE_STEPS)
        finer = self.posterior(
            np.repeat(taus, FINE_STEPS), np.tile(np.exp(log_accels), FINE_STEPS), log_prior
        )
        step = 2.0 / (FINE_STEPS - 1)
        return finer, (onset_reach * step, accel_reach * step)
