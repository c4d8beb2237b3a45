"""The estimator's parameters."""

from __future__ import annotations

from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import CHECKED, Count, Positive

VELOCITY_SIGMA_MPS = 0.07
"""Standard deviation of a receiver's velocity, of which its message says nothing [m/s]: a modern
receiver's."""


@dataclass(frozen=True, slots=True, config=CHECKED)
class EstimatorParameters:
    """Parameters of filter, screen, detector and phases (all SI).

    default_fix_sigma_m: standard deviation of a fix that comes without covariance (10 for
        recorded tracks).
    min_fix_sigma_m: floor on what a receiver says of itself.
    gate_chi2: innovation gate, chi-square with 2 degrees of freedom.
    jump_after: outliers that agree with each other after which the filter starts again there.
    lost_after_s: without a usable fix: phase `lost`.
    restart_after_s: gap after which the filter starts again, where the helicopter can have
        flown to; elsewhere as after a jump.
    accel_tau_s: time constant of the Singer model.
    cruise_accel_sigma_mps2: acceleration expected on legs.
    turn_accel_sigma_mps2: acceleration expected in corners.
    wander_prior_mps: rms velocity with which a pilot is taken to wander before he was seen to
        fly, to a factor of three.
    detect_log_bayes: evidence (log Bayes factor) that is called a corner.
    detect_positions_extra: how much more it takes without velocities.
    accel_prior_mps2: deceleration expected before a corner was seen.
    accel_prior_spread: relative spread of that expectation.
    min_cruise_mps: slowest speed taken for a leg.
    speed_noise_mps: what moves faster than the pilot wanders, added to Doppler noise.
    expected_legs_m: lengths of the pattern's legs from corner to corner, as far as they are
        known beforehand: about their ends less evidence will do; none for no expectation.
    """

    default_fix_sigma_m: Positive = 3.0
    min_fix_sigma_m: Positive = 0.5
    gate_chi2: Positive = 25.0
    jump_after: Count = 3
    lost_after_s: Positive = 5.0
    restart_after_s: Positive = 15.0
    accel_tau_s: Positive = 3.0
    cruise_accel_sigma_mps2: Positive = 0.3
    turn_accel_sigma_mps2: Positive = 3.0
    wander_prior_mps: Positive = 0.2
    detect_log_bayes: Positive = 5.25
    detect_positions_extra: Positive = 0.5
    accel_prior_mps2: Positive = 2.5
    accel_prior_spread: Positive = 0.3
    min_cruise_mps: Positive = 5.0
    speed_noise_mps: Positive = 0.05
    expected_legs_m: tuple[Positive, ...] = ()
