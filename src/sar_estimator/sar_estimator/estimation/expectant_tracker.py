"""Corners that are told of early, on less evidence, where a leg is expected to end."""

from __future__ import annotations

from typing import NamedTuple

from sar_estimator.common.states import LegEstimate, Motion, Phase
from sar_estimator.estimation.corner_detector import Watch
from sar_estimator.estimation.corner_tracker import WITHDRAWN_SHARE, CornerTracker
from sar_estimator.estimation.expected_legs import ExpectedLegs
from sar_estimator.estimation.leg import LegRow
from sar_estimator.estimation.parameters import EstimatorParameters

LONGEST_EARLY_S = 6.0


class _Early(NamedTuple):
    """A corner that is told of early: since when [s], and the leg as it is without."""

    since_s: float
    leg: LegEstimate


class ExpectantTracker(CornerTracker):
    """A tracker that knows how long the legs are expected to be.

    What it tells of early is only shown: every update begins as if it had not been, so that no
    other detection can suffer. It is shown for some seconds at most, and once on a leg.
    """

    def __init__(self, parameters: EstimatorParameters) -> None:
        """Begin with nothing known but the lengths."""
        super().__init__(parameters)
        self._expected = ExpectedLegs(parameters.expected_legs_m)
        self._early: _Early | None = None
        self._from_m: tuple[float, float] | None = None

    def restart(self) -> None:
        """Forget leg and corner; which leg of the pattern it was stays."""
        super().restart()
        self._early = self._from_m = None

    def update(self, rows: list[LegRow], motion: Motion) -> None:
        """Take the newest rows and the filtered motion at their time."""
        early = self._early
        if early is not None:
            self.phase, self.corner, self.leg = Phase.CRUISE, None, early.leg
        self._from_m = self._from_m or (motion.x_m, motion.y_m)
        was = self.phase
        super().update(rows, motion)
        if was is Phase.ACCELERATING and self.phase is Phase.CRUISE:
            self._expected.begin(self._from_m, self._watched.heading_rad)
        if early is not None and self._early is early:
            self._early = None
            if self.phase is Phase.CRUISE:
                self.withdrawn += 1
                self._expected.spend()

    def _begin_moving(self, motion: Motion) -> None:
        super()._begin_moving(motion)
        self._from_m = self.corner.stop[:2] if self.corner else (motion.x_m, motion.y_m)

    def _doubt(self, seen: Watch, motion: Motion) -> None:
        """Show a corner where one is expected."""
        assert self.leg is not None
        leg, since_s = self.leg, self._early.since_s if self._early else motion.time_s
        place, needed = (motion.x_m, motion.y_m), self._watched.needed
        gain = self._expected.gain(place, leg.speed_mps, self._prior.centre_mps2)
        enough = WITHDRAWN_SHARE * needed if self._early else needed - gain
        too_long = motion.time_s - since_s > LONGEST_EARLY_S
        if gain > 0.0 and not too_long and self._watched.looks_left(seen, motion, enough):
            self._show(seen, motion)
            self._early = _Early(since_s, leg)
