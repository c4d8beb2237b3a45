"""The phases of a helicopter that flies legs and corners, and the corner ahead of it."""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.corner_detector import AccelPrior, StopPosterior, stop_posterior
from sar_estimator.leg import LegFit, LegRow, LegTracker
from sar_estimator.leg_watch import watch_leg
from sar_estimator.parameters import EstimatorParameters
from sar_estimator.states import CornerEstimate, LegEstimate, Motion, Phase

ONSET_REACH_S = 10.0
REFINEMENTS = 2
STANDSTILL_MPS = 2.0
STANDSTILL_S = 5.0
MOVING_MPS = 3.0
LEFT_STOP_M = 8.0
LEARNT_SPREAD_FLOOR = 0.1
LEARNT_RANGE = 1.8
STOP_CONFIRM_S = 2.0
STOPPED_SHARE = 0.4
MOVING_FIXES = 2


class CornerTracker:
    """Follows cruise, decelerating, stopped, accelerating; predicts and refines the corner.

    ``phase``: the present phase (never ``LOST``: that is the fixes' matter). ``corner``: the
    predicted stop while decelerating, and as it was last refined until the next cruise. ``leg``:
    the leg being flown, None while there is none. ``withdrawn``: how many predicted corners were
    taken back because the helicopter went on.
    """

    def __init__(self, parameters: EstimatorParameters) -> None:
        """Begin with nothing known."""
        self._p = parameters
        self._tracker = LegTracker(parameters.leg_window_s)
        self._prior = AccelPrior(parameters.accel_prior_mps2, parameters.accel_prior_spread)
        self._settled: LegFit | None = None
        self._told: LegFit | None = None
        self._leg: tuple[LegFit, LegEstimate] | None = None
        self._posterior: StopPosterior | None = None
        self._detected_s = -math.inf
        self._moving_fixes = 0
        self._still_since_s: float | None = None
        self._cruise_after_s = -math.inf
        self._cruise_speed_mps: float | None = None
        self._handlers = {
            Phase.CRUISE: self._cruise,
            Phase.DECELERATING: self._decelerating,
            Phase.STOPPED: self._stopped,
            Phase.ACCELERATING: self._accelerating,
        }
        self.phase = Phase.ACCELERATING
        self.corner: CornerEstimate | None = None
        self.withdrawn = 0

    @property
    def leg(self) -> LegEstimate | None:
        """The leg being flown."""
        if self._told is None:
            return None
        if self._leg is None or self._leg[0] is not self._told:
            self._leg = self._told, self._told.estimate()
        return self._leg[1]

    @property
    def on_leg(self) -> bool:
        """Whether a leg is being flown and nothing else is foreseen."""
        return self._told is not None and self.phase is Phase.CRUISE

    def restart(self) -> None:
        """Forget leg and corner; what was learnt of speed and deceleration stays."""
        self._tracker.clear()
        self.corner = self._told = self._settled = self._posterior = None
        self._still_since_s = None
        self._cruise_after_s = -math.inf
        self.phase = Phase.ACCELERATING

    def update(self, rows: list[LegRow], motion: Motion) -> None:
        """Take the newest rows and the filtered motion at their time."""
        collects = self.phase in (Phase.CRUISE, Phase.DECELERATING)
        if collects or motion.time_s >= self._cruise_after_s:
            for row in rows:
                self._tracker.add(row)
        self._handlers[self.phase](motion)

    def _fit(self) -> LegFit | None:
        """Refresh the leg being flown."""
        fit = self._tracker.fit()
        if fit is not None and fit.speed_mps < self._p.min_cruise_mps:
            fit = None
        self._settled = self._told = fit
        return fit

    def _cruise(self, motion: Motion) -> None:
        fit = self._fit()
        if fit is None:
            self._watch_standstill(motion)
            return
        self._still_since_s = None
        seen = watch_leg(
            self._tracker.rows,
            fit,
            onset_range_s=_onset_range_s(fit, motion.time_s),
            accel_prior=self._prior,
        )
        if seen.log_bayes is not None and seen.log_bayes > self._p.detect_log_bayes:
            self._detected_s = motion.time_s
            self.phase = Phase.DECELERATING
            self._publish(self._infer(), motion.time_s)
        elif seen.steady is not None:
            self._told = seen.steady

    def _infer(self) -> StopPosterior:
        assert self._settled is not None
        return stop_posterior(
            self._settled.project(self._tracker.rows),
            onset_range_s=_onset_range_s(self._settled, self._detected_s),
            speed_mps=self._settled.speed_mps,
            accel_prior=self._prior,
            refinements=REFINEMENTS,
        )

    def _publish(self, posterior: StopPosterior, time_s: float) -> None:
        settled = self._settled
        assert settled is not None
        self._posterior = posterior
        line = settled.line
        stop = line.offset(posterior.stop_along_m)
        age = posterior.stop_time_s - settled.time_s
        across = math.sqrt(max(1e-6, settled.variance_m2(age)))
        c, s = math.cos(line.heading_rad), math.sin(line.heading_rad)
        axes = np.array([[c, -s], [s, c]])
        variances = np.diag([posterior.stop_along_sigma_m**2, across**2])
        self.corner = CornerEstimate(
            time_s=time_s,
            stop=stop,
            stop_time_s=posterior.stop_time_s,
            speed_mps=posterior.speed_mps,
            accel_mps2=posterior.accel_mps2,
            covariance=axes @ variances @ axes.T,
            heading_sigma_rad=settled.estimate().heading_sigma_rad,
            stop_time_sigma_s=posterior.stop_time_sigma_s,
        )

    def _decelerating(self, motion: Motion) -> None:
        assert self._settled is not None
        assert self._posterior is not None
        self._publish(self._infer(), motion.time_s)
        cruise = self._posterior.speed_mps
        expected = self._expected_speed(motion.time_s)
        along = motion.speed_mps * math.cos(motion.course_rad - self._settled.heading_rad)
        overdue_s = motion.time_s - self._posterior.stop_time_s
        moving = along > STOPPED_SHARE * cruise
        if (
            self._posterior.log_bayes_factor < 0.0
            or along > max(0.6 * cruise, expected + 0.4 * cruise)
            or (moving and overdue_s > STOP_CONFIRM_S)
        ):
            self._withdraw(motion)
        elif overdue_s >= 0.0 and not moving:
            self.phase = Phase.STOPPED
            self._told = None
            self._moving_fixes = 0
            self._learn(self._posterior)

    def _expected_speed(self, time_s: float) -> float:
        assert self._posterior is not None
        left = self._posterior.stop_time_s - time_s
        return max(0.0, min(self._posterior.speed_mps, left * self._posterior.accel_mps2))

    def _withdraw(self, motion: Motion) -> None:
        self.withdrawn += 1
        self.corner = None
        self._begin_moving(motion)

    def _learn(self, posterior: StopPosterior) -> None:
        """Sharpen the prior on a with a corner that was flown to its stop, within reason."""
        spread = max(LEARNT_SPREAD_FLOOR, posterior.accel_sigma_mps2 / posterior.accel_mps2)
        old, new = 1.0 / self._prior.spread**2, 1.0 / spread**2
        centre = math.exp(
            (old * math.log(self._prior.centre_mps2) + new * math.log(posterior.accel_mps2))
            / (old + new)
        )
        first = self._p.accel_prior_mps2
        centre = min(first * LEARNT_RANGE, max(first / LEARNT_RANGE, centre))
        self._prior = AccelPrior(centre, max(LEARNT_SPREAD_FLOOR, math.sqrt(1.0 / (old + new))))
        self._cruise_speed_mps = posterior.speed_mps

    def _stopped(self, motion: Motion) -> None:
        if self.corner is None:
            moving = motion.speed_mps > self._p.min_cruise_mps
        else:
            stop = self.corner.stop
            away = math.hypot(motion.x_m - stop.x_m, motion.y_m - stop.y_m)
            spread = math.sqrt(float(np.trace(self.corner.covariance)))
            moving = motion.speed_mps > MOVING_MPS and away > max(LEFT_STOP_M, 4.0 * spread)
        self._moving_fixes = self._moving_fixes + 1 if moving else 0
        if self._moving_fixes >= MOVING_FIXES:
            self._begin_moving(motion)

    def _begin_moving(self, motion: Motion) -> None:
        self.phase = Phase.ACCELERATING
        self._told = self._settled = None
        self._tracker.clear()
        self._still_since_s = None
        speed = self._cruise_speed_mps or motion.speed_mps
        missing = max(0.0, speed - motion.speed_mps)
        self._cruise_after_s = motion.time_s + missing / self._prior.centre_mps2 + 1.0

    def _accelerating(self, motion: Motion) -> None:
        if motion.time_s < self._cruise_after_s:
            return
        if self._fit() is None:
            self._watch_standstill(motion)
            return
        self.phase = Phase.CRUISE
        self.corner = None

    def _watch_standstill(self, motion: Motion) -> None:
        """Call it stopped when it stands without a deceleration having been recognised."""
        if motion.speed_mps > STANDSTILL_MPS:
            self._still_since_s = None
        elif self._still_since_s is None:
            self._still_since_s = motion.time_s
        elif motion.time_s - self._still_since_s >= STANDSTILL_S:
            self.phase = Phase.STOPPED
            self._moving_fixes = 0
            self.corner = self._told = None
            self._tracker.clear()


def _onset_range_s(fit: LegFit, until_s: float) -> tuple[float, float]:
    """Return when a slowing on a leg may have begun [s], as seen at ``until_s`` [s]."""
    return max(fit.since_s, until_s - ONSET_REACH_S), until_s
