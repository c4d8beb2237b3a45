"""The estimator's parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

VELOCITY_SIGMA_MPS = 0.07
"""Standard deviation of a receiver's velocity, of which its message says nothing [m/s]: a modern
receiver's."""


@dataclass(frozen=True, slots=True)
class EstimatorParameters:
    """Parameters of filter, screen, detector and phases (all SI).

    default_fix_sigma_m: of a fix without covariance. min_fix_sigma_m: floor on any fix's own.
    gate_chi2: innovation gate, 2 degrees of freedom. jump_after: consecutive outliers that agree
    with each other after which the filter starts again there. lost_after_s: without a usable fix.
    restart_after_s: gap after which the filter starts again. accel_tau_s, cruise_accel_sigma_mps2,
    turn_accel_sigma_mps2: Singer model on legs and in corners. wander_prior_mps: rms
    velocity with which a pilot is taken to wander before he was seen to fly, to a factor of three.
    detect_log_bayes: evidence for a corner that is called a detection.
    detect_positions_extra: how much more it takes without velocities. accel_prior_mps2,
    accel_prior_spread: deceleration expected before any corner was seen. min_cruise_mps: slowest
    speed taken for a leg. speed_noise_mps: pilot's own speed variation, added to Doppler noise.
    """

    default_fix_sigma_m: float = 3.0
    min_fix_sigma_m: float = 0.5
    gate_chi2: float = 25.0
    jump_after: int = 3
    lost_after_s: float = 5.0
    restart_after_s: float = 15.0
    accel_tau_s: float = 3.0
    cruise_accel_sigma_mps2: float = 0.3
    turn_accel_sigma_mps2: float = 3.0
    wander_prior_mps: float = 0.2
    detect_log_bayes: float = 5.25
    detect_positions_extra: float = 0.5
    accel_prior_mps2: float = 2.5
    accel_prior_spread: float = 0.3
    min_cruise_mps: float = 5.0
    speed_noise_mps: float = 0.05

    def __post_init__(self) -> None:
        """Refuse what is not a positive finite number, naming it."""
        for item in fields(self):
            value = getattr(self, item.name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{item.name} = {value}: expected a positive number")
