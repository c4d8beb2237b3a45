"""The autopilots that can be simulated: which guidance, and how the airframe answers."""

from __future__ import annotations

import math

from sar_sim.autopilot.guidance import Guidance, L1Guidance, L1Parameters, PathFollower
from sar_sim.autopilot.uav import UavLimits
from sar_sim.scenario.scenario import Uav

BANKED_RADIUS_M = 1.0


def make_guidance(uav: Uav) -> tuple[Guidance, UavLimits, float]:
    """Return the guidance, the airframe's limits, and its share of a coordinated turn's rate."""
    if uav.autopilot == "ideal":
        limits = UavLimits(uav.min_radius_m, uav.accel_limit_mps2, uav.roll_lag_s, uav.speed_lag_s)
        follower = PathFollower(
            min_radius_m=uav.min_radius_m, lookahead_m=uav.lookahead_m, roll_lag_s=uav.roll_lag_s
        )
        return follower, limits, 1.0
    # Banked autopilots limit the bank, in the guidance, and so the turn rate.
    limits = UavLimits(BANKED_RADIUS_M, uav.accel_limit_mps2, uav.roll_lag_s, uav.speed_lag_s)
    l1 = L1Parameters(
        period_s=uav.l1_period_s,
        damping=uav.l1_damping,
        wp_radius_m=uav.wp_radius_m,
        roll_limit_rad=math.radians(uav.roll_limit_deg),
        turn_share=uav.turn_share,
        believed_radius_m=uav.believed_radius_m,
    )
    return L1Guidance(l1), limits, uav.turn_share


def parameter_values(uav: Uav) -> dict[str, float]:
    """Return the parameters that the autopilot tells when asked; only ArduPlane has any."""
    if uav.autopilot != "arduplane":
        return {}
    return {
        "NAVL1_PERIOD": uav.l1_period_s,
        "NAVL1_DAMPING": uav.l1_damping,
        "WP_RADIUS": uav.wp_radius_m,
        "WP_MAX_RADIUS": 0.0,
        "WP_LOITER_RAD": uav.loiter_radius_m,
        "ROLL_LIMIT_DEG": uav.roll_limit_deg,
        "AIRSPEED_CRUISE": 20.0,
        "AIRSPEED_MIN": uav.airspeed_min_mps,
        "AIRSPEED_MAX": uav.airspeed_max_mps,
        "FS_GCS_ENABL": 1.0,
        "FS_LONG_TIMEOUT": 10.0,
        "FS_LONG_ACTN": 1.0,
    }
