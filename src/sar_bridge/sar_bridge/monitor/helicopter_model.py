"""How the helicopter is taken to be flown, whatever it is seen to do."""

from __future__ import annotations

import math

from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import CHECKED, Positive, Side


@dataclass(frozen=True, slots=True, config=CHECKED)
class HelicopterModel:
    """How the helicopter is flown.

    speed_mps: the speed V at which it cruises. accel_mps2: the acceleration a with which it brakes
    and speeds up. turn_side: the side it turns to, 1 right, -1 left.
    """

    speed_mps: Positive = 20.0
    accel_mps2: Positive = 2.0
    turn_side: Side = 1

    @property
    def inside_rad(self) -> float:
        """The turn of a right angle to the pattern's side [rad]."""
        return -self.turn_side * 0.5 * math.pi
