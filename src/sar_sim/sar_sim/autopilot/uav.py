"""A kinematic aeroplane: bounded turn rate and acceleration, optional roll lag, wind."""

from __future__ import annotations

import math
from typing import NamedTuple

from sar_bridge.arduplane.l1_kernels import wrapped
from sar_estimator.common.compiled import compiled
from sar_estimator.common.states import Motion

TINY_RAD = 1e-9


class UavState(NamedTuple):
    """Position [m], heading [rad], airspeed [m/s] and turn rate [rad/s] at ``time_s``."""

    time_s: float
    x_m: float
    y_m: float
    heading_rad: float
    airspeed_mps: float
    turn_rate_radps: float = 0.0


class UavLimits(NamedTuple):
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
    x, y, heading, speed, rate = flown(
        state[1:],
        (turn_rate_radps, airspeed_mps),
        limits[:],
        wind_mps,
        dt_s,
    )
    time_s = state.time_s + (dt_s if clock_s is None else clock_s)
    return UavState(time_s, x, y, heading, speed, rate)


@compiled("UniTuple(f8, 5)(UniTuple(f8, 5), UniTuple(f8, 2), UniTuple(f8, 4), UniTuple(f8, 2), f8)")
def flown(
    state: tuple[float, ...],
    wanted: tuple[float, float],
    limits: tuple[float, ...],
    wind: tuple[float, float],
    dt: float,
) -> tuple[float, float, float, float, float]:
    """Return x, y [m], heading [rad], airspeed and turn rate after ``dt`` [s]: ``step``'s own.

    ``wanted``: turn rate and airspeed; ``limits``: in the order of ``UavLimits``.
    """
    x, y, heading, airspeed, turn_rate = state
    wanted_rate, wanted_speed = wanted
    min_radius, accel_limit, roll_lag, speed_lag = limits
    top = airspeed / min_radius
    rate = max(-top, min(top, wanted_rate))
    if roll_lag > 0.0:
        rate = turn_rate - math.expm1(-dt / roll_lag) * (rate - turn_rate)
    change = wanted_speed - airspeed
    if speed_lag > 0.0:
        change *= -math.expm1(-dt / speed_lag)
    speed = airspeed + max(-accel_limit * dt, min(accel_limit * dt, change))
    half_turn = 0.5 * rate * dt
    chord = 0.5 * (airspeed + speed) * dt
    if abs(half_turn) > TINY_RAD:
        chord *= math.sin(half_turn) / half_turn
    course = heading + half_turn
    return (
        x + chord * math.cos(course) + wind[0] * dt,
        y + chord * math.sin(course) + wind[1] * dt,
        wrapped(heading + rate * dt),
        speed,
        rate,
    )
