"""The helicopter's estimator: fixes in; motion, leg, phase and corner out."""

from __future__ import annotations

import math
from collections import deque
from itertools import pairwise

import numpy as np

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.states import (
    CornerEstimate,
    LegEstimate,
    MotionEstimate,
    Phase,
)
from sar_estimator.estimation.expectant_tracker import ExpectantTracker
from sar_estimator.estimation.fix_screen import FixScreen, Verdict
from sar_estimator.estimation.leg import LegRow
from sar_estimator.estimation.motion_filter import MotionFilters, Spread
from sar_estimator.estimation.parameters import EstimatorParameters

UNKNOWN_SPEED_SIGMA_MPS = 40.0
TOP_SPEED_MPS = 100.0
SURPRISE_CHI2 = 9.0
MAX_COAST_S = 3600.0
TOP_ACCEL_MPS2 = 4.0
NOISE_GAIN = 0.05
NOISY_SCALE = 2.0
MAX_NOISE_SCALE = 50.0
KNOWN_SPEED_MPS = 0.3
UNSETTLED_SPEED_MPS = 10.0
MAX_VELOCITIES = 100
LONGEST_SINCE_S = 1.0  # what is believed of an acceleration without a velocity between


class HelicopterEstimator:
    """One aircraft's estimator. Feed it in time order; it reads no clock of its own.

    Two filters run side by side: an agile one that can follow a manoeuvre, which fixes are gated
    with, and a steady one that smooths better, which is published while a leg is flown.

    ``datum`` is the map's origin, taken from the first usable fix when None was given.
    ``refused_velocities``: how many Doppler velocities were not believed.
    """

    def __init__(self, parameters: EstimatorParameters, datum: Datum | None = None) -> None:
        """Begin with nothing known."""
        self.parameters = parameters
        self.datum = datum
        self.screen = FixScreen()
        self._tracker = ExpectantTracker(parameters)
        self._filters: MotionFilters | None = None
        self._accepted_s = -math.inf
        self._altitude_m = math.nan
        self._outliers: list[tuple[float, float, float]] = []
        self._velocities: deque[LegRow] = deque(maxlen=MAX_VELOCITIES)
        self._velocity_s = self._believed_s = -math.inf
        self._noise_scale = 1.0
        self.refused_velocities = 0

    @property
    def counts(self) -> dict[Verdict, int]:
        """How many fixes had each verdict."""
        return dict(self.screen.counts)

    @property
    def corner(self) -> CornerEstimate | None:
        """The predicted corner, None while none is foreseen."""
        return self._tracker.corner

    @property
    def leg(self) -> LegEstimate | None:
        """The leg being flown, None while there is none."""
        return self._tracker.leg

    @property
    def withdrawn_corners(self) -> int:
        """How many predicted corners were taken back."""
        return self._tracker.withdrawn

    def phase(self, time_s: float) -> Phase:
        """Return the phase at ``time_s``: lost when the last usable fix is too old."""
        if time_s - self._accepted_s > self.parameters.lost_after_s:
            return Phase.LOST
        return self._tracker.phase

    def predict(self, time_s: float) -> MotionEstimate | None:
        """Return the motion at ``time_s``, an hour after the last fix at most; None before any."""
        if self._filters is None:
            return None
        until_s = min(time_s, self._accepted_s + MAX_COAST_S)
        carried = self._filters.steady if self._tracker.on_leg else self._filters.agile
        return carried(until_s, self._altitude_m)

    def add_fix(self, fix: Fix) -> Verdict:
        """Take a fix; return what became of it."""
        refusal = self.screen.refusal(fix)
        if refusal is Verdict.OUT_OF_ORDER and self.screen.set_back(fix.time_s):
            self.restart_clock()
            refusal = None
        if refusal not in (None, Verdict.REPEATED):
            return self.screen.note(fix, refusal)
        if self.datum is None:
            altitude = fix.altitude_m if math.isfinite(fix.altitude_m) else 0.0
            self.datum = Datum(fix.latitude_deg, fix.longitude_deg, altitude)
        east, north, _ = self.datum.to_local(fix.latitude_deg, fix.longitude_deg)
        position, spread = (east, north), self._fix_spread(fix)
        filters, since_s = self._filters, fix.time_s - self._accepted_s
        if filters is None or since_s > self.parameters.restart_after_s:
            if refusal is Verdict.REPEATED:
                return self.screen.note(fix, refusal)
            return self.screen.note(fix, self._found(fix.time_s, position, spread))
        if refusal is Verdict.REPEATED and not self._stands(fix.time_s, position, spread):
            return self.screen.note(fix, refusal)
        _, surprise = filters.surprises(fix.time_s, position, spread)
        if fix.covariance_m2 is None:
            self._learn_noise(surprise)
        if surprise > self.parameters.gate_chi2:
            return self.screen.note(fix, self._outlier(fix.time_s, position, spread))
        self._accept(filters, fix.time_s, position, spread)
        if math.isfinite(fix.altitude_m):
            self._altitude_m = fix.altitude_m
        return self.screen.note(fix, Verdict.ACCEPTED)

    def add_velocity(self, time_s: float, vx_mps: float, vy_mps: float, sigma_mps: float) -> bool:
        """Take a Doppler velocity, in time order; return whether it may be used.

        It is used with the next fix that is not older, so that it never runs ahead of the fixes; at
        once where it is of the last one's time, and came after it, as from most receivers' drivers.
        """
        values = (time_s, vx_mps, vy_mps, sigma_mps)
        usable = (
            all(math.isfinite(value) for value in values)
            and sigma_mps > 0.0
            and math.hypot(vx_mps, vy_mps) <= TOP_SPEED_MPS
            and time_s > max(self._accepted_s - 1e-6, self._velocity_s)
        )
        if not usable:
            self.refused_velocities += 1
            return False
        self._velocity_s = time_s
        sigma = math.hypot(sigma_mps, self.parameters.speed_noise_mps)
        self._velocities.append(LegRow(time_s, vx_mps, vy_mps, sigma, is_velocity=True))
        if self._filters is not None and time_s <= self._accepted_s + 1e-6:
            believed = self._use_velocities(self._filters, self._accepted_s)
            if believed:
                self._tracker.update(believed, self._filters.agile(self._accepted_s).motion)
        return True

    def _use_velocities(self, filters: MotionFilters, until_s: float) -> list[LegRow]:
        """Update with the velocities not newer than a fix; return those that were believed."""
        believed = []
        while self._velocities and self._velocities[0].time_s <= until_s + 1e-6:
            row = self._velocities.popleft()
            dt = row.time_s - filters.time_s
            if dt < -1e-6:
                continue
            estimate = filters.agile(row.time_s)
            known = estimate.covariance[1, 1] + estimate.covariance[4, 4]
            # As predicted, or as it was: after a wrong one the filter expects an acceleration.
            error = min(
                math.hypot(row.x - motion.vx_mps, row.y - motion.vy_mps)
                for motion in (estimate.motion, filters.agile(filters.time_s).motion)
            )
            since_s = max(dt, min(row.time_s - self._believed_s, LONGEST_SINCE_S))
            steady_sigma = math.sqrt(row.sigma**2 + min(known, KNOWN_SPEED_MPS**2))
            most = 5.0 * steady_sigma + TOP_ACCEL_MPS2 * since_s
            if known < UNSETTLED_SPEED_MPS**2 and error > most:
                self.refused_velocities += 1
                continue
            self._believed_s = row.time_s
            filters.advance(row.time_s)
            filters.update_velocity((row.x, row.y), row.sigma)
            believed.append(row)
        return believed

    def restart_clock(self) -> None:
        """Begin again after time was set back: nothing is carried over but what was learnt."""
        self.screen.forget()
        self._filters = None
        self._accepted_s = self._velocity_s = self._believed_s = -math.inf
        self._outliers.clear()
        self._velocities.clear()
        self._tracker.restart()

    def _fix_spread(self, fix: Fix) -> Spread:
        """Return the covariance that a fix is taken to have [m^2]."""
        floor = self.parameters.min_fix_sigma_m**2
        if fix.covariance_m2 is not None:
            (xx, xy), (yx, yy) = fix.covariance_m2.tolist()
            if math.isfinite(xx + xy + yx + yy) and xx + yy > 0.0:
                xy = 0.5 * (xy + yx)
                if 0.5 * (xx + yy) - math.hypot(0.5 * (xx - yy), xy) >= floor:
                    return xx, xy, yy
                values, axes = np.linalg.eigh(((xx, xy), (xy, yy)))
                (xx, xy), (_, yy) = ((axes * np.maximum(values, floor)) @ axes.T).tolist()
                return xx, xy, yy
        variance = max(floor, self._believed_scale * self.parameters.default_fix_sigma_m**2)
        return variance, 0.0, variance

    @property
    def _believed_scale(self) -> float:
        """How much worse than taken for fixes without covariance are used: as learnt, if much."""
        return self._noise_scale if self._noise_scale > NOISY_SCALE else 1.0

    def _learn_noise(self, surprise: float) -> None:
        """Learn how much worse fixes without covariance are than they are taken for.

        The normalised innovation's mean is 2 where they are right; what is used is its slow average
        in units of that, once it is well beyond.
        """
        seen = self._believed_scale * min(surprise, self.parameters.gate_chi2) / 2.0
        self._noise_scale += NOISE_GAIN * (seen - self._noise_scale)
        self._noise_scale = min(self._noise_scale, MAX_NOISE_SCALE)

    def _stands(self, time_s: float, position: tuple[float, float], spread: Spread) -> bool:
        """Whether a repeated position is believable: the helicopter has hardly moved since."""
        prediction = self.predict(time_s)
        assert prediction is not None
        motion = prediction.motion
        moved = math.hypot(motion.x_m - position[0], motion.y_m - position[1])
        return moved <= max(1.5, min(_sigma_m(spread), 3.0)) and motion.speed_mps < 3.0

    def _accept(
        self, filters: MotionFilters, time_s: float, position: tuple[float, float], spread: Spread
    ) -> None:
        """Update both filters; the steady one begins again where it cannot follow."""
        self._outliers.clear()
        velocities = self._use_velocities(filters, time_s)
        surprise, _ = filters.surprises(time_s, position, spread)
        filters.advance(time_s)
        filters.update_position(position, spread)
        if surprise > SURPRISE_CHI2 or not self._tracker.on_leg:
            filters.settle()
        self._accepted_s = time_s
        row = LegRow(time_s, *position, _sigma_m(spread), is_velocity=False)
        self._tracker.update([*velocities, row], filters.agile(time_s).motion)

    def _found(self, time_s: float, position: tuple[float, float], spread: Spread) -> Verdict:
        """Begin again where the helicopter can have flown to since; elsewhere as after a jump."""
        if self._filters is not None:
            there = self._filters.position
            reach_m = TOP_SPEED_MPS * (time_s - self._accepted_s)
            if math.hypot(position[0] - there[0], position[1] - there[1]) > reach_m:
                return self._outlier(time_s, position, spread)
        self._restart(time_s, position, spread)
        return Verdict.ACCEPTED

    def _outlier(self, time_s: float, position: tuple[float, float], spread: Spread) -> Verdict:
        """Refuse a fix outside the gate, unless the last few agree that the aircraft is there."""
        self._outliers.append((time_s, *position))
        if len(self._outliers) < self.parameters.jump_after:
            return Verdict.OUTLIER
        recent = self._outliers[-self.parameters.jump_after :]
        sigma = math.sqrt(2.0) * _sigma_m(spread)
        for (t0, x0, y0), (t1, x1, y1) in pairwise(recent):
            if math.hypot(x1 - x0, y1 - y0) > TOP_SPEED_MPS * (t1 - t0) + 3.0 * sigma:
                return Verdict.OUTLIER
        self._restart(time_s, position, spread)
        return Verdict.JUMP

    def _restart(self, time_s: float, position: tuple[float, float], spread: Spread) -> None:
        p = self.parameters
        self._filters = MotionFilters(
            time_s,
            position,
            spread,
            tau_s=p.accel_tau_s,
            speed_sigma_mps=UNKNOWN_SPEED_SIGMA_MPS,
            accel_sigmas_mps2=(p.cruise_accel_sigma_mps2, p.turn_accel_sigma_mps2),
        )
        self._accepted_s = time_s
        self._outliers.clear()
        self._velocities.clear()
        self._tracker.restart()


def _sigma_m(spread_m2: Spread) -> float:
    """Return the standard deviation of one axis [m], the mean of both."""
    return math.sqrt(0.5 * (spread_m2[0] + spread_m2[2]))
