"""The phases of a helicopter that flies legs and corners, and the corner ahead of it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_estimator.estimation.corner_detector import Decelerations, StopPosterior, Watch
from sar_estimator.estimation.corner_prediction import predicted_corner, rolled_stop, stop_ahead
from sar_estimator.estimation.leg import LegRow
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_estimator.estimation.watched_leg import CONFIRMED_RAD, ONSET_REACH_S, WatchedLeg

STANDSTILL_MPS = 2.0
STANDSTILL_S = 5.0
MOVING_MPS = 3.0
LEFT_STOP_M = 8.0
STOP_CONFIRM_S = 2.0
STOPPED_SHARE = 0.4
MOVING_FIXES = 2
SLOW_FIXES = 2
HELD_RAD, ROLLED_OUT_S = math.radians(8.0), 6.0
YOUNG_S = 6.0
KNOWN_SPEED_SIGMA_MPS = 0.8
KNOWN_AFTER_S = 10.0
MISFIT_LIMIT = 5.0
NEWEST_S = 3.0
ONSET_SIGMA_S = 1.0
WITHDRAWN_SHARE = 0.2
STILL_ON_RAD = math.radians(15.0)
STILL_ON_MPS = 4.0
STRAIGHT_AGAIN_S = 4.0
TURNING_RAD = math.radians(20.0)
TURNED_RAD = math.radians(65.0)


class _Course(NamedTuple):
    """A course [rad] that is held, and since when [s]."""

    since_s: float
    course_rad: float

    def after(self, motion: Motion) -> _Course:
        """Return it, or the present one where that is another."""
        off = abs(wrap_angle(motion.course_rad - self.course_rad))
        held = off < HELD_RAD and math.isfinite(self.since_s)
        return self if held else _Course(motion.time_s, motion.course_rad)


class CornerTracker:
    """Follows cruise, decelerating, stopped, accelerating; predicts and refines the corner.

    ``phase``: the present phase (never ``LOST``: that is the fixes' matter). ``corner``: the
    predicted stop while decelerating, and as it was last refined until the next cruise. A corner
    that is rolled, turned without a stop, is told as the stop that would cost as much time where
    its legs' lines cross. ``leg``: the leg being flown, None while there is none. ``withdrawn``:
    how many predicted corners were taken back because the helicopter went on.
    """

    def __init__(self, parameters: EstimatorParameters) -> None:
        """Begin with nothing known."""
        self._p = parameters
        self._watched = WatchedLeg(parameters)
        self._seen = Decelerations(parameters.accel_prior_mps2, parameters.accel_prior_spread)
        self._prior = self._seen.expected
        self._posterior: StopPosterior | None = None
        self._detected_s = -math.inf
        self._turning_since_s: float | None = None
        self._rolled_out = _Course(-math.inf, 0.0)
        self._moving_fixes = self._slow_fixes = 0
        self._begins = False
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
        self.leg: LegEstimate | None = None
        self.withdrawn = 0

    @property
    def on_leg(self) -> bool:
        """Whether a leg is being flown and no corner is predicted."""
        return self.leg is not None and self.phase is Phase.CRUISE

    def restart(self) -> None:
        """Forget leg and corner; what was learnt of speed and deceleration stays."""
        self.corner = self.leg = self._posterior = None
        self._still_since_s = None
        self._cruise_after_s = -math.inf
        self._begins = False
        self.phase = Phase.ACCELERATING

    def update(self, rows: list[LegRow], motion: Motion) -> None:
        """Take the newest rows and the filtered motion at their time."""
        if self.phase in (Phase.CRUISE, Phase.DECELERATING):
            self._watched.add(rows)
        self._handlers[self.phase](rows, motion)

    # On a leg ----------------------------------------------------------------------------------

    def _cruise(self, _rows: list[LegRow], motion: Motion) -> None:
        if self.leg is None:
            self._begin_moving(motion)
            return
        self._still_since_s = None
        watched = self._watched
        watched.settle(motion.time_s - ONSET_REACH_S)
        seen = watched.watch(motion.time_s, self._prior)
        young = motion.time_s - watched.begun_s < YOUNG_S
        if watched.looks_left(seen, motion, watched.needed) and not young:
            self._detect(seen, motion)
        elif seen.misfit > MISFIT_LIMIT:
            # It is flown otherwise than was thought: what is to be learnt of it is learnt now.
            watched.settle(motion.time_s - NEWEST_S)
            watched.loosen()
        elif max(seen.slowing, seen.turning) < 0.0:
            self.leg = watched.leg(seen, motion.time_s)
        elif not young:
            self._doubt(seen, motion)

    def _doubt(self, seen: Watch, motion: Motion) -> None:
        """Take evidence that is not enough to detect a corner."""

    # A corner ahead ----------------------------------------------------------------------------

    def _detect(self, seen: Watch, motion: Motion) -> None:
        """Predict a corner."""
        self._detected_s = motion.time_s
        self._turning_since_s = None
        self._rolled_out = _Course(-math.inf, 0.0)
        self._slow_fixes = 0
        assert self.leg is not None
        self._cruise_speed_mps = self.leg.speed_mps
        self._posterior = self._show(seen, motion)
        if self._posterior is None:
            self._turning_since_s = motion.time_s

    def _show(self, seen: Watch, motion: Motion) -> StopPosterior | None:
        """Tell of a corner that begins; return what its stop is known by, None if it is rolled."""
        assert self.leg is not None
        self.phase = Phase.DECELERATING
        if seen.turning > seen.slowing and abs(self._watched.turned(motion)) > CONFIRMED_RAD:
            self._roll(seen, motion)
            return None
        posterior = self._watched.stop(motion, self._prior, motion.time_s)
        onset_s = posterior.stop_time_s - posterior.speed_mps / posterior.accel_mps2
        self.leg = self._watched.leg_before(onset_s - ONSET_SIGMA_S) or self.leg
        self._predict(posterior, motion)
        return posterior

    def _roll(self, seen: Watch, motion: Motion) -> None:
        assert self.leg is not None
        accel, slowest = self._prior.centre_mps2, self._p.min_cruise_mps
        stop = rolled_stop(self.leg, motion, seen.turn_mps2, accel_mps2=accel, slowest_mps=slowest)
        self.corner = predicted_corner(self.leg, motion.time_s, stop)

    def _predict(self, posterior: StopPosterior, motion: Motion) -> None:
        assert self.leg is not None
        stop = stop_ahead(self.leg, motion, self._watched.heading_rad, posterior)
        self.corner = predicted_corner(self.leg, motion.time_s, stop)

    def _decelerating(self, _rows: list[LegRow], motion: Motion) -> None:
        seen = self._watched.watch(motion.time_s, self._prior)
        turned = self._watched.turned(motion)
        if self._turning_since_s is None and (
            seen.turning > self._watched.needed
            and abs(turned) > TURNING_RAD
            and motion.speed_mps > self._p.min_cruise_mps
        ):
            self._turning_since_s = motion.time_s
        if self._turning_since_s is not None:
            self._turn(seen, motion, turned)
            return
        self._posterior = self._watched.stop(motion, self._prior, self._detected_s)
        self._predict(self._posterior, motion)
        cruise = self._posterior.speed_mps
        expected = self._expected_speed(motion.time_s)
        along = motion.speed_mps * math.cos(turned)
        overdue_s = motion.time_s - self._posterior.stop_time_s
        moving = along > STOPPED_SHARE * cruise
        if (
            self._posterior.log_bayes_factor < WITHDRAWN_SHARE * self._watched.needed
            or along > max(0.6 * cruise, expected + 0.4 * cruise)
            or (moving and overdue_s > STOP_CONFIRM_S)
        ):
            self._withdraw(motion)
        elif (overdue_s >= 0.0 or self._stands(motion)) and not moving:
            self.phase = Phase.STOPPED
            self.leg = None
            self._moving_fixes = 0
            self._seen.add(self._posterior.accel_mps2)
            self._prior = self._seen.expected

    def _stands(self, motion: Motion) -> bool:
        """Whether he has come to a stand, though the stop that is predicted still creeps ahead.

        The last of a deceleration is eased off.
        """
        slow = motion.speed_mps < STANDSTILL_MPS
        self._slow_fixes = self._slow_fixes + 1 if slow else 0
        return self._slow_fixes >= SLOW_FIXES

    def _turn(self, seen: Watch, motion: Motion, turned: float) -> None:
        """Follow a turn that is rolled: on its new leg once most of it is flown.

        Or once it is flown straight on, though less than a corner was turned.
        """
        assert self._turning_since_s is not None
        self._rolled_out = self._rolled_out.after(motion)
        is_out = motion.time_s - self._rolled_out.since_s > ROLLED_OUT_S
        elsewhere = is_out and abs(turned) > TURNING_RAD
        if abs(turned) > TURNED_RAD or motion.speed_mps < MOVING_MPS or elsewhere:
            self._begin_moving(motion)
        elif abs(turned) < TURNING_RAD and (
            motion.time_s - self._turning_since_s > STRAIGHT_AGAIN_S or seen.turning < 0.0
        ):
            self._withdraw(motion)
        else:
            self._roll(seen, motion)

    def _expected_speed(self, time_s: float) -> float:
        assert self._posterior is not None
        left = self._posterior.stop_time_s - time_s
        return max(0.0, min(self._posterior.speed_mps, left * self._posterior.accel_mps2))

    def _withdraw(self, motion: Motion) -> None:
        """Take a corner back; where the leg is still flown as before it goes on as if none was."""
        self.withdrawn += 1
        self.corner = self._posterior = None
        leg = self.leg
        assert leg is not None
        self._watched.settle(motion.time_s - NEWEST_S, leg.foot.heading_rad)
        turned = wrap_angle(motion.course_rad - leg.foot.heading_rad)
        if abs(turned) < STILL_ON_RAD and abs(motion.speed_mps - leg.speed_mps) < STILL_ON_MPS:
            self.phase = Phase.CRUISE
        else:
            self._begin_moving(motion)

    # Standing, and away again ------------------------------------------------------------------

    def _stopped(self, _rows: list[LegRow], motion: Motion) -> None:
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
        self.leg = None
        self._begins = False
        self._still_since_s = None
        speed = self._cruise_speed_mps or motion.speed_mps
        missing = max(0.0, speed - motion.speed_mps)
        self._cruise_after_s = motion.time_s + missing / self._prior.centre_mps2 + 1.0

    def _accelerating(self, rows: list[LegRow], motion: Motion) -> None:
        if motion.time_s < self._cruise_after_s:
            return
        if motion.speed_mps < self._p.min_cruise_mps:
            self._begins = False
            self._watch_standstill(motion)
            return
        if not self._begins:
            self._begins = True
            self._watched.begin(rows, motion)
            return
        self._watched.add(rows)
        self._watched.heading_rad = motion.course_rad
        seen = self._watched.watch(motion.time_s, self._prior)
        known = math.sqrt(seen.covariance[1, 1]) < KNOWN_SPEED_SIGMA_MPS
        if known or motion.time_s - self._watched.begun_s > KNOWN_AFTER_S:
            self.leg = self._watched.leg(seen, motion.time_s)
            if self.leg is not None:
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
            self._begins = False
            self.corner = self.leg = None
