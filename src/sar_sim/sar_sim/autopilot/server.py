"""The simulated autopilot's MAVLink side: mission protocol, commands, telemetry. Pure.

The vehicle's half of https://mavlink.io/en/services/mission.html, as ArduPlane keeps it.
"""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import MissionItem
from sar_estimator.common.geodesy import Datum
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.presets import parameter_values

ITEM_TIMEOUT_S = 0.25
ITEM_RETRIES = 20
SETTLE_S = 0.2
POSITION_PERIOD_S = 0.1
HEARTBEAT_PERIOD_S = 1.0

LED = (FlightMode.AUTO, FlightMode.GUIDED)

Messages = list[mavlink.MAVLink_message]


class AutopilotServer:
    """Answers a ground station on behalf of a ``SimAutopilot``.

    Transfer times, and how long the ground station has been silent, are of a monotonic clock [s];
    telemetry is paced by the simulation's time.
    """

    def __init__(self, autopilot: SimAutopilot, datum: Datum) -> None:
        """Serve ``autopilot``, whose positions count from ``datum``."""
        self._autopilot, self._datum = autopilot, datum
        self._next = self._end = 0
        self._parameters = parameter_values(autopilot.uav)
        self._partner = (0, 0)
        self._asked_s = 0.0
        self._asked = 0
        self._next_position_s = 0.0
        self._told_s = math.nan
        self._next_heartbeat_s = 0.0
        self._settled_s = -math.inf
        self._heard_s = math.inf
        self._booted_s = 0.0

    @property
    def gcs_seen(self) -> bool:
        """Whether a ground station has been heard since the start."""
        return self._heard_s < math.inf

    def transferring(self, now_s: float) -> bool:
        """Whether a mission is on its way in, or was just taken and not yet made current."""
        return self._next < self._end or now_s < self._settled_s

    # Ground station to autopilot ---------------------------------------------------------------

    def handle(self, message: mavlink.MAVLink_message, now_s: float) -> Messages:
        """Take a message; return the answers."""
        if getattr(message, "target_system", 1) not in (0, 1):
            return []
        self._partner = (message.get_srcSystem(), message.get_srcComponent())
        handler = {
            "HEARTBEAT": self._heard,
            "MISSION_COUNT": self._count,
            "MISSION_WRITE_PARTIAL_LIST": self._partial,
            "MISSION_ITEM_INT": self._item,
            "PARAM_REQUEST_READ": self._parameter,
            "COMMAND_LONG": self._command,
            "MISSION_REQUEST_LIST": self._list,
            "MISSION_REQUEST_INT": self._download,
        }.get(message.get_type())
        return [] if handler is None else handler(message, now_s)

    def _heard(self, _message: mavlink.MAVLink_message, now_s: float) -> Messages:
        self._heard_s = now_s
        return []

    def restart(self, time_s: float) -> None:
        """Boot anew at the simulation's ``time_s`` [s]: mission and mode are kept, no transfer is.

        As ArduPilot after a watchdog reset in flight.
        """
        self._booted_s = time_s
        self._end = self._next
        self._settled_s = -math.inf

    def take(self) -> None:
        """Loiter: a human has chosen that mode."""
        self._autopilot.set_mode(FlightMode.LOITER)

    def _failsafe(self, now_s: float) -> None:
        """Return home when no ground station was heard for FS_LONG_TIMEOUT, as it is set up."""
        told = self._parameters
        acts = told.get("FS_GCS_ENABL", 0.0) == 1.0 and told.get("FS_LONG_ACTN", 0.0) == 1.0
        silent_s = now_s - self._heard_s
        if acts and self._autopilot.mode in LED and silent_s > told["FS_LONG_TIMEOUT"]:
            self._autopilot.set_mode(FlightMode.RTL)

    def _list(self, _message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        return [mavlink.MAVLink_mission_count_message(*self._partner, len(self._autopilot.items))]

    def _count(self, message: mavlink.MAVLink_message, now_s: float) -> Messages:
        if message.mission_type != mavlink.MAV_MISSION_TYPE_MISSION:
            return [self._ack(mavlink.MAV_MISSION_UNSUPPORTED)]
        # As ArduPilot: the mission is cut to its new length now, items are put in as they come.
        self._autopilot.truncate(message.count)
        self._next, self._end = 0, message.count
        if self._end == 0:
            return [self._ack(mavlink.MAV_MISSION_ACCEPTED)]
        return self._ask(now_s)

    def _partial(self, message: mavlink.MAVLink_message, now_s: float) -> Messages:
        if self._next < self._end:
            return [self._ack(mavlink.MAV_MISSION_DENIED)]
        held = len(self._autopilot.items)
        if not 0 <= message.start_index <= message.end_index <= held:
            return [self._ack(mavlink.MAV_MISSION_ERROR)]
        self._next, self._end = message.start_index, message.end_index + 1
        return self._ask(now_s)

    def _ask(self, now_s: float) -> Messages:
        self._asked_s, self._asked = now_s, 0
        return [mavlink.MAVLink_mission_request_int_message(*self._partner, self._next)]

    def _item(self, message: mavlink.MAVLink_message, now_s: float) -> Messages:
        if self._next >= self._end:
            return [self._ack(mavlink.MAV_MISSION_ERROR)]
        if message.seq != self._next:
            # As ArduPilot: the transfer goes on.
            return [self._ack(mavlink.MAV_MISSION_INVALID_SEQUENCE)]
        item = MissionItem(
            message.command,
            message.x,
            message.y,
            message.z,
            message.frame,
            (message.param1, message.param2, message.param3, message.param4),
        )
        self._autopilot.replace_item(self._next, item)
        self._next += 1
        if self._next < self._end:
            return self._ask(now_s)
        self._settled_s = now_s + SETTLE_S
        return [self._ack(mavlink.MAV_MISSION_ACCEPTED)]

    def _parameter(self, message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        value = self._parameters.get(message.param_id)
        if value is None:
            return []
        kind = mavlink.MAV_PARAM_TYPE_REAL32
        name = message.param_id.encode()
        return [mavlink.MAVLink_param_value_message(name, value, kind, len(self._parameters), 0)]

    def _ack(self, result: int) -> mavlink.MAVLink_message:
        return mavlink.MAVLink_mission_ack_message(*self._partner, result)

    def _download(self, message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        seq = message.seq
        if self._next < self._end:
            return [self._ack(mavlink.MAV_MISSION_DENIED)]
        if seq >= len(self._autopilot.items):
            return [self._ack(mavlink.MAV_MISSION_INVALID_SEQUENCE)]
        item = self._autopilot.items[seq]
        return [
            mavlink.MAVLink_mission_item_int_message(
                *self._partner,
                seq,
                item.frame,
                item.command,
                int(seq == self._autopilot.current),
                1,
                *item.params,
                item.latitude_e7,
                item.longitude_e7,
                item.altitude_m,
            )
        ]

    def _command(self, message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        result = mavlink.MAV_RESULT_ACCEPTED
        if message.command == mavlink.MAV_CMD_DO_SET_MISSION_CURRENT:
            self._settled_s = -math.inf
            if not self._autopilot.set_current(int(message.param1)):
                result = mavlink.MAV_RESULT_DENIED
        elif message.command == mavlink.MAV_CMD_DO_SET_MODE:
            result = self._set_mode(int(message.param2))
        elif message.command == mavlink.MAV_CMD_DO_CHANGE_SPEED:
            if message.param2 > 0.0:
                self._autopilot.airspeed_mps = message.param2
        elif message.command == mavlink.MAV_CMD_REQUEST_MESSAGE:
            return self._requested(int(message.param1))
        elif message.command != mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            result = mavlink.MAV_RESULT_UNSUPPORTED
        return [mavlink.MAVLink_command_ack_message(message.command, result)]

    def _requested(self, number: int) -> Messages:
        known = number == mavlink.MAVLINK_MSG_ID_HOME_POSITION
        result = mavlink.MAV_RESULT_ACCEPTED if known else mavlink.MAV_RESULT_UNSUPPORTED
        ack = mavlink.MAVLink_command_ack_message(mavlink.MAV_CMD_REQUEST_MESSAGE, result)
        if not known:
            return [ack]
        latitude, longitude, altitude = self._datum.to_geodetic(*self._autopilot.home, 0.0)
        place = round(latitude * 1e7), round(longitude * 1e7), round(altitude * 1e3)
        still = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        (x, y, z), attitude, approach = still
        return [ack, mavlink.MAVLink_home_position_message(*place, x, y, z, attitude, *approach)]

    def _set_mode(self, number: int) -> int:
        if number not in tuple(FlightMode):
            return int(mavlink.MAV_RESULT_DENIED)
        self._autopilot.set_mode(FlightMode(number))
        accepted = self._autopilot.mode == number
        return int(mavlink.MAV_RESULT_ACCEPTED if accepted else mavlink.MAV_RESULT_FAILED)

    # Autopilot to ground station ---------------------------------------------------------------

    def tick(self, now_s: float) -> Messages:
        """Ask again for an item that did not come; give the transfer up after many tries."""
        self._failsafe(now_s)
        if self._next >= self._end or now_s - self._asked_s < ITEM_TIMEOUT_S:
            return []
        if self._asked >= ITEM_RETRIES:
            self._end = self._next
            return [self._ack(mavlink.MAV_MISSION_OPERATION_CANCELLED)]
        tries = self._asked + 1
        out = self._ask(now_s)
        self._asked = tries
        return out

    def telemetry(self, time_s: float) -> Messages:
        """Return what is due at the simulation's ``time_s`` [s].

        While that stands the heartbeat is repeated until a ground station answers: it may have
        begun to listen only now.
        """
        out: Messages = []
        if time_s == self._told_s and not self.gcs_seen:
            out.append(self._heartbeat())
        self._told_s = time_s
        if time_s >= self._next_heartbeat_s - 1e-9:
            self._next_heartbeat_s = time_s + HEARTBEAT_PERIOD_S
            out += [self._heartbeat(), self._wind(), self._air_data()]
        if time_s >= self._next_position_s - 1e-9:
            self._next_position_s = time_s + POSITION_PERIOD_S
            out += [
                self._attitude(time_s),
                self._position(time_s),
                mavlink.MAVLink_mission_current_message(self._autopilot.current),
            ]
        out += [
            mavlink.MAVLink_mission_item_reached_message(seq) for seq in self._autopilot.reached
        ]
        self._autopilot.reached.clear()
        return out

    def _heartbeat(self) -> mavlink.MAVLink_message:
        armed = mavlink.MAV_MODE_FLAG_SAFETY_ARMED | mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        return mavlink.MAVLink_heartbeat_message(
            mavlink.MAV_TYPE_FIXED_WING,
            mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
            armed,
            int(self._autopilot.mode),
            mavlink.MAV_STATE_ACTIVE,
            3,
        )

    def _wind(self) -> mavlink.MAVLink_message:
        east, north = self._autopilot.wind_estimate_mps
        towards = math.degrees(math.atan2(north, east))
        return mavlink.MAVLink_wind_message((270.0 - towards) % 360.0, math.hypot(east, north), 0.0)

    def _air_data(self) -> mavlink.MAVLink_message:
        state, speed = self._autopilot.state, self._autopilot.motion.speed_mps
        indicated = state.airspeed_mps / self._autopilot.uav.airspeed_ratio
        heading = round(90.0 - math.degrees(state.heading_rad)) % 360
        return mavlink.MAVLink_vfr_hud_message(
            indicated, speed, heading, 50, self._autopilot.altitude_m, 0.0
        )

    def _attitude(self, time_s: float) -> mavlink.MAVLink_message:
        state = self._autopilot.state
        heading = math.remainder(math.pi / 2.0 - state.heading_rad, 2.0 * math.pi)
        return mavlink.MAVLink_attitude_message(
            round((time_s - self._booted_s) * 1e3),
            self._autopilot.roll_rad,
            0.0,
            heading,
            0.0,
            0.0,
            -state.turn_rate_radps,
        )

    def _position(self, time_s: float) -> mavlink.MAVLink_message:
        motion, state = self._autopilot.motion, self._autopilot.state
        height = self._autopilot.altitude_m
        latitude, longitude, altitude = self._datum.to_geodetic(motion.x_m, motion.y_m, height)
        heading = (90.0 - math.degrees(state.heading_rad)) % 360.0
        return mavlink.MAVLink_global_position_int_message(
            round((time_s - self._booted_s) * 1e3),
            round(latitude * 1e7),
            round(longitude * 1e7),
            round(altitude * 1e3),
            round(height * 1e3),
            round(motion.vy_mps * 100.0),
            round(motion.vx_mps * 100.0),
            0,
            round(heading * 100.0) % 36000,
        )
