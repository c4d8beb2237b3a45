"""A kinematic aeroplane: bounded turn rate and acceleration, optional roll lag, wind."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from sar_estimator.plane import wrap_angle
from sar_estimator.states import Motion

G_MPS2 = 9.80665


class UavState(NamedTuple):
    """Position [m], heading [rad], airspeed [m/s] and turn rate [rad/s] at ``time_s``."""

    time_s: float
    x_m: float
    y_m: float
    heading_rad: float
    airspeed_mps: float
    turn_rate_radps: float = 0.0


@dataclass(frozen=True, slots=True)
class UavLimits:
    """What the airframe can do, with its speed control: time constants of turn rate and speed."""

    min_radius_m: float
    accel_limit_mps2: float
    roll_lag_s: float
    speed_lag_s: float = 0.0


def ground_motion(state: UavState, wind_mps: tuple[float, float]) -> Motion:
    """Return the motion over ground in a wind blowing towards ``wind_mps`` (east, north)."""
    vx = state.airspeed_mps * math.cos(state.heading_rad) + wind_mps[0]
    vy = state.airspeed_mps * math.sin(state.heading_rad) + wind_mps[1]
    return Motion(state.time_s, state.x_m, state.y_m, vx, vy)


def step(
    state: UavState,
    dt_s: float,
    *,
    turn_rate_radps: float,
    airspeed_mps: float,
    limits: UavLimits,
    wind_mps: tuple[float, float] = (0.0, 0.0),
    clock_s: float | None = None,
) -> UavState:
    """Fly ``dt_s`` [s] towards a commanded turn rate and airspeed: an exact arc in the air.

    ``clock_s``: how much time passes meanwhile, where not as much as is flown.
    """
    top = state.airspeed_mps / limits.min_radius_m
    wanted = max(-top, min(top, turn_rate_radps))
    if limits.roll_lag_s > 0.0:
        share = -math.expm1(-dt_s / limits.roll_lag_s)
        wanted = state.turn_rate_radps + share * (wanted - state.turn_rate_radps)
    limit = limits.accel_limit_mps2 * dt_s
    change = airspeed_mps - state.airspeed_mps
    if limits.speed_lag_s > 0.0:
        change *= -math.expm1(-dt_s / limits.speed_lag_s)
    speed = state.airspeed_mps + max(-limit, min(limit, change))
    run = 0.5 * (state.airspeed_mps + speed) * dt_s
    half_turn = 0.5 * wanted * dt_s
    chord = run * (math.sin(half_turn) / half_turn if abs(half_turn) > 1e-9 else 1.0)
    course = state.heading_rad + half_turn
    return UavState(
        state.time_s + (dt_s if clock_s is None else clock_s),
        state.x_m + chord * math.cos(course) + wind_mps[0] * dt_s,
        state.y_m + chord * math.sin(course) + wind_mps[1] * dt_s,
        wrap_angle(state.heading_rad + wanted * dt_s),
        speed,
        wanted,
    )
