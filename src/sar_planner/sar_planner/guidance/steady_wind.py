"""The wind over minutes, and how much it comes and goes. Pure."""

from __future__ import annotations

import math
from dataclasses import dataclass

TIME_CONSTANT_S = 120.0
EXPECTED_SHARE = 0.1
"""The standard deviation of gusts over the wind, as it is over the sea, where none were seen."""


@dataclass(frozen=True, slots=True)
class SteadyWind:
    """What was told of the wind until ``time_s``, what is older counting the less.

    ``mean_mps``: where it blows to, x and y. ``gusts_mps``: the standard deviation along an axis.
    """

    time_s: float
    mean_mps: tuple[float, float]
    gusts_mps: float

    @classmethod
    def after(
        cls, before: SteadyWind | None, wind_mps: tuple[float, float], time_s: float
    ) -> SteadyWind:
        """Return what is believed once a wind is told [m/s], after what was believed before.

        First-order, with ``TIME_CONSTANT_S``; begun anew where the clock went back.
        """
        if before is None or time_s < before.time_s:
            return cls(time_s, wind_mps, EXPECTED_SHARE * math.hypot(*wind_mps))
        share = -math.expm1((before.time_s - time_s) / TIME_CONSTANT_S)
        (x, y), (new_x, new_y) = before.mean_mps, wind_mps
        off_x, off_y = new_x - x, new_y - y
        square = before.gusts_mps**2 + 0.5 * share * (off_x**2 + off_y**2)
        gusts_mps = math.sqrt((1.0 - share) * square)
        return cls(time_s, (x + share * off_x, y + share * off_y), gusts_mps)
