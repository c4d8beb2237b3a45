"""What corners cost the helicopter in time, learnt from corner to corner."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from sar_estimator.common.pose import wrap_angle
from sar_estimator.common.states import CornerEstimate, LegEstimate

MOVING_MPS = 3.0
LEAST_TURN_RAD = math.radians(40.0)
LEARNT_SIGMA_MPS = 0.6
LOST_S = (0.0, 25.0)
LOST_GAIN = 0.5
LEAST_LOST_S = 0.5
ROLLED_SHARE = 0.85
SLOW_SHARE = 0.4


def passed_s(corner: CornerEstimate) -> float:
    """Return when the helicopter would have passed a corner's stop at cruise [s]."""
    return corner.stop_time_s - 0.5 * corner.speed_mps / corner.accel_mps2


@dataclass(frozen=True)
class CornerCost:
    """How much later than at cruise the last corners were left: ``lost_s`` [s], None before any.

    ``learnt_k``: the number of the corner that it was learnt from last.
    """

    lost_s: float | None = None
    learnt_k: int = 0

    def learnt(self, k: int, corner: CornerEstimate, leg: LegEstimate) -> CornerCost:
        """Return what is known once the leg after corner ``k`` is."""
        if self.learnt_k == k:
            return self
        turned = wrap_angle(leg.foot.heading_rad - corner.stop.heading_rad)
        if abs(turned) < LEAST_TURN_RAD or leg.speed_mps < MOVING_MPS:
            return self
        if leg.speed_sigma_mps > LEARNT_SIGMA_MPS or leg.time_s < corner.stop_time_s:
            return self
        away = -leg.foot.along(corner.stop.x_m, corner.stop.y_m)
        lost_s = leg.time_s - away / leg.speed_mps - passed_s(corner)
        known = self.lost_s
        if not LOST_S[0] <= lost_s <= LOST_S[1]:
            return CornerCost(known, k)
        return CornerCost(lost_s if known is None else known + LOST_GAIN * (lost_s - known), k)

    def expected(self, estimate: CornerEstimate, speed_mps: float) -> CornerEstimate:
        """Return a corner as a pilot will fly it who has not stopped at the last ones.

        A corner that is rolled costs less time than the stop that its beginning looks like: it is
        planned as a stop, at the same place, that costs as much as the last ones did, until he is
        too slow for that. ``speed_mps``: how fast he is now.
        """
        lost_s = self.lost_s
        if lost_s is None:
            return estimate
        rolled = lost_s < ROLLED_SHARE * estimate.speed_mps / estimate.accel_mps2
        if not rolled or speed_mps < SLOW_SHARE * estimate.speed_mps:
            return estimate
        accel = estimate.speed_mps / max(lost_s, LEAST_LOST_S)
        stop_s = passed_s(estimate) + 0.5 * estimate.speed_mps / accel
        return replace(estimate, accel_mps2=accel, stop_time_s=stop_s)
