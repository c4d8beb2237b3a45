"""The telemetry of a simulated autopilot, as ArduPlane sends it. Pure."""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_estimator.common.geodesy import Datum
from sar_sim.autopilot.autopilot import SimAutopilot


def heartbeat(autopilot: SimAutopilot) -> mavlink.MAVLink_message:
    """Return HEARTBEAT: armed, in its mode."""
    armed = mavlink.MAV_MODE_FLAG_SAFETY_ARMED | mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_FIXED_WING,
        mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
        armed,
        int(autopilot.mode),
        mavlink.MAV_STATE_ACTIVE,
        3,
    )


def wind(autopilot: SimAutopilot) -> mavlink.MAVLink_message:
    """Return WIND: the wind that it estimates."""
    east, north = autopilot.wind_estimate_mps
    towards = math.degrees(math.atan2(north, east))
    return mavlink.MAVLink_wind_message((270.0 - towards) % 360.0, math.hypot(east, north), 0.0)


def air_data(autopilot: SimAutopilot) -> mavlink.MAVLink_message:
    """Return VFR_HUD: indicated airspeed, ground speed, heading, height."""
    state, speed = autopilot.state, autopilot.motion.speed_mps
    indicated = state.airspeed_mps / autopilot.uav.airspeed_ratio
    heading = round(90.0 - math.degrees(state.heading_rad)) % 360
    return mavlink.MAVLink_vfr_hud_message(indicated, speed, heading, 50, autopilot.altitude_m, 0.0)


def attitude(autopilot: SimAutopilot, boot_s: float) -> mavlink.MAVLink_message:
    """Return ATTITUDE at ``boot_s`` [s] since boot."""
    state = autopilot.state
    heading = math.remainder(math.pi / 2.0 - state.heading_rad, 2.0 * math.pi)
    return mavlink.MAVLink_attitude_message(
        round(boot_s * 1e3),
        autopilot.roll_rad,
        0.0,
        heading,
        0.0,
        0.0,
        -state.turn_rate_radps,
    )


def position(autopilot: SimAutopilot, datum: Datum, boot_s: float) -> mavlink.MAVLink_message:
    """Return GLOBAL_POSITION_INT at ``boot_s`` [s] since boot."""
    motion, state = autopilot.motion, autopilot.state
    height = autopilot.altitude_m
    latitude, longitude, altitude = datum.to_geodetic(motion.x_m, motion.y_m, height)
    heading = (90.0 - math.degrees(state.heading_rad)) % 360.0
    return mavlink.MAVLink_global_position_int_message(
        round(boot_s * 1e3),
        round(latitude * 1e7),
        round(longitude * 1e7),
        round(altitude * 1e3),
        round(height * 1e3),
        round(motion.vy_mps * 100.0),
        round(motion.vx_mps * 100.0),
        0,
        round(heading * 100.0) % 36000,
    )
