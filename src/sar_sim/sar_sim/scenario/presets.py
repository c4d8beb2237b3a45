"""Presets of a scenario: autopilots, pilots and receivers by name, as defaults of their keys."""

from __future__ import annotations

# What a preset of the autopilot changes of the defaults.
AUTOPILOTS: dict[str, dict[str, float]] = {
    "ideal": {},
    "arduplane": {"roll_lag_s": 0.35, "speed_lag_s": 3.5, "item_s": 0.02},
    # Turns with R = 163 m and leaves its legs for one of 30 m: its turn rate is overestimated.
    "piccolo2005": {
        "roll_lag_s": 1.0,
        "speed_lag_s": 3.5,
        "roll_limit_deg": 14.0,
        "believed_radius_m": 30.0,
        "l1_period_s": 20.0,
        "turn_share": 1.0,
    },
}


# What a kind of pilot changes of the defaults. ``robot`` is the paper's model. The others wander
# about their line and their speed; ``human`` by what gentle pilots show, ``rough`` by three times
# that, which is what recorded rescue helicopters show (0.1 to 0.3 m/s^2 over 40 s, 2 to 16 m).
PILOTS: dict[str, dict[str, float]] = {
    "robot": {},
    "steady": {
        "wander_along_mps": 0.15,
        "wander_across_mps": 0.1,
        "gust_mps2": 0.02,
        "heading_sigma_deg": 0.3,
        "speed_sigma_mps": 0.1,
        "corner_sigma_m": 5.0,
        "accel_spread": 0.1,
        "buildup_s": 1.0,
        "accel_wobble": 0.05,
        "flare_mps": 2.0,
        "yaw_rate_dps": 30.0,
        "leave_early_deg": 10.0,
    },
    "human": {
        "wander_along_mps": 0.5,
        "wander_across_mps": 0.3,
        "gust_mps2": 0.05,
        "heading_sigma_deg": 1.0,
        "speed_sigma_mps": 0.3,
        "corner_sigma_m": 15.0,
        "accel_spread": 0.2,
        "buildup_s": 1.5,
        "accel_wobble": 0.15,
        "flare_mps": 4.0,
        "yaw_rate_dps": 20.0,
        "leave_early_deg": 30.0,
        "hover_spread_s": 3.0,
        "pass_share": 0.3,
        "pass_mps": 4.0,
    },
    "rough": {
        "wander_along_mps": 1.5,
        "wander_across_mps": 0.9,
        "gust_mps2": 0.15,
        "heading_sigma_deg": 2.0,
        "speed_sigma_mps": 0.6,
        "corner_sigma_m": 30.0,
        "accel_spread": 0.3,
        "buildup_s": 2.0,
        "accel_wobble": 0.25,
        "flare_mps": 5.0,
        "yaw_rate_dps": 15.0,
        "leave_early_deg": 40.0,
        "hover_spread_s": 8.0,
        "pass_share": 0.3,
        "pass_mps": 5.0,
    },
}
# What makes a pilot fly otherwise than in stretches of constant acceleration on straight lines.
HUMAN = (
    "wander_along_mps",
    "wander_across_mps",
    "gust_mps2",
    "heading_sigma_deg",
    "buildup_s",
    "accel_wobble",
    "flare_mps",
    "yaw_rate_dps",
    "leave_early_deg",
    "pass_share",
    "roll_share",
)
# What a kind of receiver changes of the defaults. ``modern``: u-blox M8 and later by their data
# sheets (0.05 m/s, 2 to 2.5 m CEP); ``old``: a first-generation receiver without Doppler output.
RECEIVERS: dict[str, dict[str, float]] = {
    "plain": {},
    "white": {"sigma_m": 3.0},
    "modern": {
        "sigma_m": 0.4,
        "bias_sigma_m": 2.0,
        "bias_time_s": 60.0,
        "correlated_sigma_m": 0.3,
        "correlated_time_s": 4.0,
        "doppler_sigma_mps": 0.07,
        "latency_s": 0.1,
        "latency_per_mps_s": 0.002,
        "dropout": 0.005,
    },
    "old": {
        "sigma_m": 1.5,
        "bias_sigma_m": 4.0,
        "bias_time_s": 120.0,
        "correlated_sigma_m": 1.5,
        "correlated_time_s": 6.0,
        "latency_s": 0.2,
        "latency_per_mps_s": 0.01,
        "dropout": 0.02,
    },
}
