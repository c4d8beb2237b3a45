"""Where and when a corner will be stopped in, from what is seen of its beginning."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion
from sar_estimator.estimation.corner_detector import StopPosterior

LEAST_STOP_M = 3.0
RIGHT_ANGLE_RAD = 0.5 * math.pi


class Stop(NamedTuple):
    """A stop to come: where, heading as it comes, and when [s]; the speed and deceleration before.

    ``along_sigma_m``, ``time_sigma_s``: standard deviations along the leg, and of the time.
    """

    pose: Pose
    time_s: float
    speed_mps: float
    accel_mps2: float
    along_sigma_m: float
    time_sigma_s: float


def stop_ahead(
    leg: LegEstimate, motion: Motion, heading_rad: float, posterior: StopPosterior
) -> Stop:
    """Return the stop that is inferred from a deceleration, on the leg's line."""
    here = Pose(motion.x_m, motion.y_m, heading_rad)
    off = leg.foot.across(here.x_m, here.y_m)
    return Stop(
        here.offset(posterior.stop_along_m, -off),
        posterior.stop_time_s,
        posterior.speed_mps,
        posterior.accel_mps2,
        posterior.stop_along_sigma_m,
        posterior.stop_time_sigma_s,
    )


def rolled_stop(
    leg: LegEstimate, motion: Motion, turn_mps2: float, *, accel_mps2: float, slowest_mps: float
) -> Stop:
    """Return, of a corner that is rolled, the stop that costs as much time.

    It is where its legs' lines cross. Turning by the angle t so far, at v with the radius r, the
    helicopter is on its new leg after r (pi / 2 - t) more, r (1 - sin t) ahead. ``turn_mps2``: the
    acceleration across. ``accel_mps2``: with which it speeds up. ``slowest_mps``: of a leg.
    """
    line, cruise = leg.foot, leg.speed_mps
    v = max(motion.speed_mps, slowest_mps)
    turned = min(abs(wrap_angle(motion.course_rad - line.heading_rad)), RIGHT_ANGLE_RAD)
    radius = v**2 / max(abs(turn_mps2), 1.0)
    ahead = line.along(motion.x_m, motion.y_m) + radius * (1.0 - math.sin(turned))
    passed_s = leg.time_s + ahead / cruise
    on_leg_s = motion.time_s + radius * (RIGHT_ANGLE_RAD - turned) / v
    missing = max(0.0, cruise - v)
    ramp_m = (cruise**2 - min(v, cruise) ** 2) / (2.0 * accel_mps2)
    lost_s = on_leg_s + missing / accel_mps2 - (radius + ramp_m) / cruise - passed_s
    equal_m = min(max(0.5 * cruise * lost_s, LEAST_STOP_M), cruise**2 / (2.0 * accel_mps2))
    return Stop(
        line.offset(ahead),
        passed_s + equal_m / cruise,
        cruise,
        cruise**2 / (2.0 * equal_m),
        0.3 * radius,
        0.3 * radius / v,
    )


def predicted_corner(leg: LegEstimate, time_s: float, stop: Stop) -> CornerEstimate:
    """Return a stop as a corner, as sure across as the leg's line is where it is."""
    ahead_s = stop.time_s - leg.time_s
    across = math.hypot(leg.position_sigma_m, leg.speed_sigma_mps * ahead_s)
    c, s = math.cos(stop.pose.heading_rad), math.sin(stop.pose.heading_rad)
    axes = np.array([[c, -s], [s, c]])
    variances = np.diag([stop.along_sigma_m**2, max(across**2, 1e-6)])
    return CornerEstimate(
        time_s=time_s,
        stop=stop.pose,
        stop_time_s=stop.time_s,
        speed_mps=stop.speed_mps,
        accel_mps2=stop.accel_mps2,
        covariance=axes @ variances @ axes.T,
        heading_sigma_rad=leg.heading_sigma_rad,
        stop_time_sigma_s=stop.time_sigma_s,
    )
