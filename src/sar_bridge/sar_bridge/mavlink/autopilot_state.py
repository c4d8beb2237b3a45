"""What the autopilot says of itself: mode, arming, position, attitude, mission progress."""

from __future__ import annotations

import math
import statistics
from collections import deque
from dataclasses import dataclass

from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_estimator.common.geodesy import Datum, valid_position
from sar_estimator.common.pose import blown_mps
from sar_estimator.common.states import Motion

CLOCK_WINDOW = 50
WIND_SILENCE_S = 10.0
WIND_TIME_S = 15.0
LEAST_AIRSPEED_MPS = 5.0
RATIO_TIME_S = 20.0
RATIO_STEP_S = 1.0
RATIOS = (0.9, 1.35)


@dataclass(frozen=True, slots=True)
class UavTelemetry:
    """The UAV's motion in the map frame, its altitude above mean sea level, its attitude [rad].

    Attitude is ENU / base_link (REP-103): roll to the right, pitch nose *down*, yaw
    counter-clockwise from east, all positive.
    """

    motion: Motion
    altitude_m: float
    climb_mps: float
    roll_rad: float
    pitch_rad: float
    yaw_rad: float


class BootClock:
    """Maps the autopilot's time since boot to the node's clock.

    The offset is the median of (receipt - boot time) of late: one delayed message does not move it,
    nor does a simulated clock that this process hears of late. A step back of the boot time is a
    reboot.
    """

    def __init__(self) -> None:
        """Begin with no offset."""
        self._offsets: deque[float] = deque(maxlen=CLOCK_WINDOW)
        self._last_boot_s = -math.inf
        self.reboots = 0

    def stamp(self, boot_s: float, received_s: float) -> float:
        """Return when a message was sent, on the receiver's clock [s]."""
        stepped = bool(self._offsets) and abs(received_s - boot_s - self._offsets[-1]) > 5.0
        if boot_s < self._last_boot_s - 1.0:
            self.reboots += 1
        if boot_s < self._last_boot_s - 1.0 or stepped:
            self._offsets.clear()
        self._last_boot_s = boot_s
        self._offsets.append(received_s - boot_s)
        return boot_s + statistics.median(self._offsets)


class WindState:
    """The wind: as the autopilot's WIND message tells it, else from track against heading.

    ``vector_mps``: where it blows to, x and y [m/s], None while nothing is known. ``airspeed_mps``:
    the indicated airspeed. ``airspeed_ratio``: the true one over it, some 1.05 at 1,000 m and 1.16
    at 3,000 m in the standard atmosphere; learnt where the autopilot tells the wind, else 1. It
    is kept within ``RATIOS``: a sensor that reads too low must not slow the UAV down.
    """

    def __init__(self) -> None:
        """Nothing is known yet."""
        self.vector_mps: tuple[float, float] | None = None
        self.airspeed_mps = 0.0
        self.airspeed_ratio = 1.0
        self._told_s = self._seen_s = -math.inf

    def told(self, from_deg: float, speed_mps: float, monotonic_s: float) -> None:
        """Take the autopilot's own estimate: direction it blows from [deg from north], speed."""
        if not (math.isfinite(from_deg) and math.isfinite(speed_mps)):
            return
        self.vector_mps = blown_mps(speed_mps, from_deg)
        self._told_s = monotonic_s

    def seen(self, motion: Motion, yaw_rad: float, monotonic_s: float) -> None:
        """Take a velocity over ground and a heading.

        While the autopilot tells nothing they give the wind, else the airspeed ratio.
        """
        since_s = max(0.0, monotonic_s - self._seen_s)
        self._seen_s = monotonic_s
        if not self.airspeed_mps > LEAST_AIRSPEED_MPS:
            return
        if monotonic_s - self._told_s <= WIND_SILENCE_S:
            self._learn_ratio(motion, since_s)
            return
        east = motion.vx_mps - self.airspeed_mps * math.cos(yaw_rad)
        north = motion.vy_mps - self.airspeed_mps * math.sin(yaw_rad)
        share = -math.expm1(-since_s / WIND_TIME_S)
        was = self.vector_mps or (east, north)
        self.vector_mps = (was[0] + share * (east - was[0]), was[1] + share * (north - was[1]))

    def _learn_ratio(self, motion: Motion, since_s: float) -> None:
        assert self.vector_mps is not None
        east, north = motion.vx_mps - self.vector_mps[0], motion.vy_mps - self.vector_mps[1]
        ratio = min(max(math.hypot(east, north) / self.airspeed_mps, RATIOS[0]), RATIOS[1])
        share = -math.expm1(-min(since_s, RATIO_STEP_S) / RATIO_TIME_S)
        self.airspeed_ratio += share * (ratio - self.airspeed_ratio)


class AutopilotState:
    """Folds telemetry messages into what the rest needs to know.

    ``mode``: the flight mode's name, empty before the first heartbeat. ``heartbeat_s``: when the
    last one came, by the caller's monotonic clock. ``boot_s``: the newest time since its boot.
    ``mission_total``: how many items its mission has, home not counted; 0 where it tells not.
    """

    def __init__(self) -> None:
        """Begin with nothing known."""
        self.mode = ""
        self.armed = False
        self.ardupilot = True
        self.heartbeat_s = -math.inf
        self.current_item = self.mission_total = 0
        self.clock = BootClock()
        self.boot_s = 0.0
        self.telemetry: UavTelemetry | None = None
        self.position_s = -math.inf
        self._vehicle = mavlink.MAV_TYPE_FIXED_WING
        self._attitude = (0.0, 0.0)
        self.wind = WindState()

    def handle(
        self,
        message: mavlink.MAVLink_message,
        *,
        monotonic_s: float,
        ros_s: float,
        datum: Datum | None,
    ) -> bool:
        """Take a message; return whether it brought a new position in the map frame."""
        kind = message.get_type()
        if kind == "HEARTBEAT":
            self._heartbeat(message, monotonic_s)
        elif kind == "ATTITUDE":
            self._attitude = (message.roll, message.pitch)
        elif kind == "WIND":
            self.wind.told(message.direction, message.speed, monotonic_s)
        elif kind == "VFR_HUD":
            self.wind.airspeed_mps = message.airspeed
        elif kind == "MISSION_CURRENT":
            self.current_item, self.mission_total = message.seq, message.total
        elif kind == "GLOBAL_POSITION_INT":
            self.boot_s = message.time_boot_ms * 1e-3
            if datum is None:
                return False
            self.position_s = monotonic_s
            moved = self._position(message, ros_s, datum)
            if moved and self.telemetry is not None:
                self.wind.seen(self.telemetry.motion, self.telemetry.yaw_rad, monotonic_s)
            return moved
        return False

    def _heartbeat(self, message: mavlink.MAVLink_message, monotonic_s: float) -> None:
        if message.autopilot == mavlink.MAV_AUTOPILOT_INVALID:
            return
        self.heartbeat_s = monotonic_s
        self.ardupilot = message.autopilot == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
        self._vehicle = message.type
        self.armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
        self.mode = mavutil.mode_string_v10(message)

    def mode_number(self, name: str) -> int:
        """Return the autopilot's number of a flight mode. Raises ``KeyError`` when it has none.

        Types without a table of their own (quadplanes) fly ArduPlane's modes.
        """
        mapping = mavutil.mode_mapping_byname(self._vehicle)
        fallback = mavutil.mode_mapping_byname(mavlink.MAV_TYPE_FIXED_WING)
        return int((mapping or fallback)[name])

    def _position(self, message: mavlink.MAVLink_message, ros_s: float, datum: Datum) -> bool:
        latitude, longitude = message.lat / 1e7, message.lon / 1e7
        if not valid_position(latitude, longitude) or (message.lat == 0 and message.lon == 0):
            return False
        stamp = self.clock.stamp(message.time_boot_ms / 1e3, ros_s)
        altitude = message.alt / 1e3
        east, north, _ = datum.to_local(latitude, longitude, altitude)
        motion = Motion(stamp, east, north, message.vy / 100.0, message.vx / 100.0)
        yaw = math.radians(90.0 - message.hdg / 100.0) if message.hdg != 65535 else math.nan
        if math.isnan(yaw):
            yaw = motion.course_rad
        roll, pitch = self._attitude
        self.telemetry = UavTelemetry(motion, altitude, -message.vz / 100.0, roll, -pitch, yaw)
        return True
