"""How the helicopter is taken to be flown, whatever it is seen to do."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import CHECKED, Positive, Side


@dataclass(frozen=True, slots=True, config=CHECKED)
class HelicopterModel:
    """How the helicopter is flown.

    speed_mps: the speed V at which it cruises. accel_mps2: the acceleration a with which it brakes
    and speeds up. turn_side: the side it turns to, 1 right, -1 left. turn_deg: by how much.
    """

    speed_mps: Positive = 20.0
    accel_mps2: Positive = 2.0
    turn_side: Side = 1
    turn_deg: Annotated[float, Field(gt=0.0, le=180.0)] = 90.0

    @property
    def turn_rad(self) -> float:
        """The size of its turns [rad]."""
        return math.radians(self.turn_deg)

    @property
    def inside_rad(self) -> float:
        """The turn to the pattern's side, left positive [rad]."""
        return -self.turn_side * self.turn_rad
