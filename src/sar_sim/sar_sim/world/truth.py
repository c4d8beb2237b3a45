"""The simulated helicopter's true state in the place of the estimator's."""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common import topics
from sar_estimator.common.component import Component, Outputs
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate, MotionEstimate, Phase
from sar_estimator.estimation.component import (
    EstimatorComponent,
    leg_outputs,
    motion_outputs,
)
from sar_sim.world.helicopter import CornerTruth, Helicopter


def corner_estimate(truth: CornerTruth) -> CornerEstimate:
    """Return a true corner as an estimate without error."""
    return CornerEstimate(
        time_s=truth.onset_time_s,
        stop=truth.stop,
        stop_time_s=truth.stop_time_s,
        speed_mps=truth.speed_mps,
        accel_mps2=truth.accel_mps2,
        covariance=np.zeros((2, 2)),
        heading_sigma_rad=0.0,
        stop_time_sigma_s=0.0,
    )


class TrueEstimates:
    """Knows everything at once; set ``time_s`` before use."""

    def __init__(self, helicopter: Helicopter, datum: Datum) -> None:
        """Know every corner of the flight, and tell of each when it begins."""
        self._helicopter = helicopter
        self._corners = [corner_estimate(corner) for corner in helicopter.corners]
        self.datum = datum
        self.time_s = 0.0

    def predict(self, time_s: float) -> MotionEstimate:
        """Return the true motion."""
        return MotionEstimate(self._helicopter.motion(time_s), np.zeros((6, 6)))

    def phase(self, time_s: float) -> Phase:
        """Return the true phase."""
        motion = self._helicopter.motion(time_s)
        along = motion.ax_mps2 * motion.vx_mps + motion.ay_mps2 * motion.vy_mps
        if motion.speed_mps < 1e-6:
            return Phase.STOPPED
        if along < -1e-9:
            return Phase.DECELERATING
        return Phase.ACCELERATING if along > 1e-9 else Phase.CRUISE

    @property
    def corner(self) -> CornerEstimate | None:
        """The corner whose deceleration has begun last, until the helicopter cruises again."""
        begun = [corner for corner in self._corners if corner.onset_time_s <= self.time_s]
        if not begun or self.phase(self.time_s) is Phase.CRUISE:
            return None
        return begun[-1]

    @property
    def leg(self) -> LegEstimate | None:
        """The leg being flown, on cruise."""
        if self.phase(self.time_s) is not Phase.CRUISE:
            return None
        motion = self._helicopter.motion(self.time_s)
        foot = Pose(motion.x_m, motion.y_m, math.atan2(motion.vy_mps, motion.vx_mps))
        return LegEstimate(self.time_s, foot, motion.speed_mps, 0.0, 0.0, 0.0)


class TruthComponent(Component):
    """Tells the true state on the estimator's topics."""

    name = "estimator"
    outputs = EstimatorComponent.outputs

    def __init__(self, helicopter: Helicopter, datum: Datum) -> None:
        """Know every corner of the flight."""
        super().__init__()
        self.estimator = TrueEstimates(helicopter, datum)
        self._phase: Phase | None = None

    def start(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Tell of the map's origin."""
        return [(topics.DATUM, self.estimator.datum)]

    def tick(self, now_s: float) -> Outputs:
        """Tell everything."""
        known = self.estimator
        known.time_s = now_s
        found: Outputs = []
        phase = known.phase(now_s)
        if phase is not self._phase:
            self._phase = phase
            found.append((topics.PHASE, phase))
        return [*found, *leg_outputs(known, now_s), *motion_outputs(known, now_s)]
