"""What a receiver says at one epoch."""

from __future__ import annotations

from dataclasses import dataclass

from sar_estimator.common.states import FloatArray


@dataclass(frozen=True, slots=True)
class Reading:
    """One epoch's position and velocity, as the receiver has them.

    ``utc_s``: the receiver's time since 1970 [s], or since midnight where ``has_date`` is not set.
    ``altitude_m``: above mean sea level. ``covariance_m2``: east-north, shape (2, 2).
    ``velocity_mps``: east and north, None without one; ``velocity_sigma_mps``: of one axis, None
    where the receiver does not say.
    """

    utc_s: float
    latitude_deg: float
    longitude_deg: float
    altitude_m: float
    is_valid: bool
    covariance_m2: FloatArray | None = None
    velocity_mps: tuple[float, float] | None = None
    velocity_sigma_mps: float | None = None
    has_date: bool = True
