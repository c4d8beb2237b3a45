"""The leg being flown, and whether it still looks like one."""

from __future__ import annotations

import math
from collections.abc import Iterable

from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import LegEstimate, Motion
from sar_estimator.estimation.corner_detector import (
    AccelPrior,
    StopPosterior,
    Watch,
    filtered,
    stop_posterior,
    watch,
)
from sar_estimator.estimation.leg import LegRow, LegTracker, leg_estimate
from sar_estimator.estimation.leg_process import TIME, LegProcess
from sar_estimator.estimation.parameters import EstimatorParameters

ONSET_REACH_S = 10.0
REFINEMENTS = 2
CONFIRMED_RAD = math.radians(12.0)


class WatchedLeg:
    """Keeps a leg's newest measurements, and weighs whether they are those of a corner.

    ``heading_rad``: of the leg.
    """

    def __init__(self, parameters: EstimatorParameters) -> None:
        """Begin with no leg; what is learnt of the pilot outlives it."""
        self._p = parameters
        self._tracker = LegTracker(LegProcess(parameters.wander_prior_mps))
        self.heading_rad = 0.0

    @property
    def begun_s(self) -> float:
        """When the leg was begun [s]."""
        return self._tracker.begun_s

    def begin(self, rows: list[LegRow], motion: Motion) -> None:
        """Begin a leg with its first rows; there is at least one."""
        position, velocity = (motion.x_m, motion.y_m), (motion.vx_mps, motion.vy_mps)
        self._tracker.begin(rows[0].time_s, position, velocity)
        self.add(rows)

    def add(self, rows: Iterable[LegRow]) -> None:
        """Take measurements."""
        for row in rows:
            self._tracker.add(row)

    def settle(self, until_s: float, heading_rad: float | None = None) -> None:
        """Take what is older than ``until_s`` [s] for the leg's, which has a heading [rad]."""
        self._tracker.settle(until_s, self.heading_rad if heading_rad is None else heading_rad)

    def loosen(self) -> None:
        """Take the pilot for one who wanders more than was thought."""
        self._tracker.process.loosen()

    @property
    def needed(self) -> float:
        """The evidence that is called a detection: more without velocities.

        The errors of positions are alike from one to the next, and not white as they are taken for.
        """
        p = self._p
        measured = self._tracker.has_velocities
        return p.detect_log_bayes if measured else p.detect_log_bayes + p.detect_positions_extra

    def turned(self, motion: Motion) -> float:
        """Return by how much a course has turned from the leg [rad]."""
        return wrap_angle(motion.course_rad - self.heading_rad)

    def looks_left(self, seen: Watch, motion: Motion, needed: float) -> bool:
        """Whether the evidence of a corner is more than is needed."""
        # One wrong velocity looks like a turn for a moment, and none comes without a slow-down.
        turns = seen.turning > needed and abs(self.turned(motion)) > CONFIRMED_RAD
        return seen.slowing > needed or turns

    def watch(self, time_s: float, accel_prior: AccelPrior) -> Watch:
        """Weigh the newest rows, at ``time_s`` [s]."""
        return watch(
            self._tracker.rows,
            self._tracker.belief,
            self.heading_rad,
            onset_range_s=self._onset_range_s(time_s),
            accel_prior=accel_prior,
        )

    def _onset_range_s(self, until_s: float) -> tuple[float, float]:
        """Return when a corner may have begun [s], as seen at ``until_s`` [s]."""
        return max(self.begun_s, until_s - ONSET_REACH_S), until_s

    def stop(self, motion: Motion, accel_prior: AccelPrior, detected_s: float) -> StopPosterior:
        """Infer the stop of a corner that was detected at ``detected_s`` [s]."""
        return stop_posterior(
            self._tracker.rows,
            self._tracker.belief,
            self.heading_rad,
            onset_range_s=self._onset_range_s(detected_s),
            accel_prior=accel_prior,
            origin_m=(motion.x_m, motion.y_m),
            refinements=REFINEMENTS,
        )

    def leg(self, seen: Watch, time_s: float) -> LegEstimate | None:
        """Return the leg as it is known by all rows, None where it is too slow for one."""
        means = seen.means
        if math.hypot(means[0, 1], means[1, 1]) < self._p.min_cruise_mps:
            return None
        self.heading_rad = math.atan2(means[1, 1], means[0, 1])
        return leg_estimate(time_s, means, seen.covariance, self.heading_rad)

    def leg_before(self, onset_s: float) -> LegEstimate | None:
        """Return the leg as it was before a corner began, whose rows bend it; None without any."""
        rows = self._tracker.rows
        rows = rows[rows[:, TIME] < onset_s]
        if not len(rows):
            return None
        *_, means, spread = filtered(rows, *self._tracker.belief.start, self.heading_rad)
        return leg_estimate(float(rows[-1, TIME]), means, spread, self.heading_rad)
