"""A GPS fix."""

from __future__ import annotations

from dataclasses import dataclass

from sar_estimator.common.states import FloatArray


@dataclass(frozen=True, slots=True)
class Fix:
    """One GPS fix. ``covariance_m2``: east-north, shape (2, 2), None when the receiver has none."""

    time_s: float
    latitude_deg: float
    longitude_deg: float
    altitude_m: float = 0.0
    covariance_m2: FloatArray | None = None
    has_fix: bool = True
