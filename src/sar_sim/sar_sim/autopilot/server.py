"""The simulated autopilot's MAVLink side: mission, commands, parameters, telemetry. Pure."""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_estimator.common.geodesy import Datum
from sar_sim.autopilot import telemetry
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.mission_server import Messages, MissionServer
from sar_sim.autopilot.presets import parameter_values

POSITION_PERIOD_S = 0.1
HEARTBEAT_PERIOD_S = 1.0

NO_NUMBER = 65535
"""The index of a parameter that was asked for by its name."""
LED = (FlightMode.AUTO, FlightMode.GUIDED)


class AutopilotServer:
    """Answers a ground station on behalf of a ``SimAutopilot``.

    Transfer times, and how long the ground station has been silent, are of a monotonic clock [s];
    telemetry is paced by the simulation's time.
    """

    def __init__(self, autopilot: SimAutopilot, datum: Datum, *, system: int = 1) -> None:
        """Serve ``autopilot``, whose positions count from ``datum``, as a MAVLink ``system``."""
        self._system = system
        self._autopilot, self._datum = autopilot, datum
        self._mission = MissionServer(autopilot)
        self._parameters = parameter_values(autopilot.uav)
        self._next_position_s = 0.0
        self._told_s = math.nan
        self._next_heartbeat_s = 0.0
        self._heard_s = math.inf
        self._booted_s = 0.0

    @property
    def gcs_seen(self) -> bool:
        """Whether a ground station has been heard since the start."""
        return self._heard_s < math.inf

    def transferring(self, now_s: float) -> bool:
        """Whether a mission is on its way in, or was just taken and not yet made current."""
        return self._mission.transferring(now_s)

    # Ground station to autopilot ---------------------------------------------------------------

    def handle(self, message: mavlink.MAVLink_message, now_s: float) -> Messages:
        """Take a message; return the answers."""
        if getattr(message, "target_system", 0) not in (0, self._system):
            return []
        handler = {
            "HEARTBEAT": self._heard,
            "PARAM_REQUEST_READ": self._parameter,
            "PARAM_REQUEST_LIST": self._all_parameters,
            "COMMAND_LONG": self._command,
        }.get(message.get_type(), self._mission.handle)
        return handler(message, now_s)

    def _heard(self, _message: mavlink.MAVLink_message, now_s: float) -> Messages:
        self._heard_s = now_s
        return []

    def restart(self, time_s: float) -> None:
        """Boot anew at the simulation's ``time_s`` [s]: mission and mode are kept, no transfer is.

        As ArduPilot after a watchdog reset in flight.
        """
        self._booted_s = time_s
        self._mission.restart()

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

    def _parameter(self, message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        names, number = list(self._parameters), message.param_index
        if number < 0:
            return self._told(message.param_id, NO_NUMBER)
        return self._told(names[number], number) if number < len(names) else []

    def _all_parameters(self, _message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        return [one for n, name in enumerate(self._parameters) for one in self._told(name, n)]

    def _told(self, name: str, number: int) -> Messages:
        """Return a parameter's value; nothing, as ArduPilot, where there is no such name."""
        value, count = self._parameters.get(name), len(self._parameters)
        if value is None:
            return []
        kind = mavlink.MAV_PARAM_TYPE_REAL32
        return [mavlink.MAVLink_param_value_message(name.encode(), value, kind, count, number)]

    def _command(self, message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        result, told = self._obeyed(message)
        asking = message.get_srcSystem(), message.get_srcComponent()
        return [mavlink.MAVLink_command_ack_message(message.command, result, 0, 0, *asking), *told]

    def _obeyed(self, message: mavlink.MAVLink_message) -> tuple[int, Messages]:
        """Do what a command says; return the result, and what was asked for."""
        result = mavlink.MAV_RESULT_ACCEPTED
        if message.command == mavlink.MAV_CMD_DO_SET_MISSION_CURRENT:
            self._mission.settle()
            if not self._autopilot.set_current(int(message.param1)):
                result = mavlink.MAV_RESULT_DENIED
        elif message.command == mavlink.MAV_CMD_DO_SET_MODE:
            result = self._set_mode(int(message.param2))
        elif message.command == mavlink.MAV_CMD_DO_CHANGE_SPEED:
            if message.param2 > 0.0:
                self._autopilot.airspeed_mps = message.param2
        elif message.command == mavlink.MAV_CMD_REQUEST_MESSAGE:
            if int(message.param1) == mavlink.MAVLINK_MSG_ID_HOME_POSITION:
                return result, [self._home()]
            result = mavlink.MAV_RESULT_UNSUPPORTED
        elif message.command != mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            result = mavlink.MAV_RESULT_UNSUPPORTED
        return result, []

    def _home(self) -> mavlink.MAVLink_message:
        latitude, longitude, altitude = self._datum.to_geodetic(*self._autopilot.home, 0.0)
        place = round(latitude * 1e7), round(longitude * 1e7), round(altitude * 1e3)
        still = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        (x, y, z), attitude, approach = still
        return mavlink.MAVLink_home_position_message(*place, x, y, z, attitude, *approach)

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
        return self._mission.tick(now_s)

    def telemetry(self, time_s: float) -> Messages:
        """Return what is due at the simulation's ``time_s`` [s].

        While that stands the heartbeat is repeated until a ground station answers: it may have
        begun to listen only now.
        """
        autopilot, boot_s = self._autopilot, time_s - self._booted_s
        out: Messages = []
        if time_s == self._told_s and not self.gcs_seen:
            out.append(telemetry.heartbeat(autopilot))
        self._told_s = time_s
        if time_s >= self._next_heartbeat_s - 1e-9:
            self._next_heartbeat_s = time_s + HEARTBEAT_PERIOD_S
            out += [
                telemetry.heartbeat(autopilot),
                telemetry.wind(autopilot),
                telemetry.air_data(autopilot),
            ]
        if time_s >= self._next_position_s - 1e-9:
            self._next_position_s = time_s + POSITION_PERIOD_S
            out += [
                telemetry.attitude(autopilot, boot_s),
                telemetry.position(autopilot, self._datum, boot_s),
                mavlink.MAVLink_mission_current_message(
                    autopilot.current, max(len(autopilot.items) - 1, 0)
                ),
            ]
        out += [mavlink.MAVLink_mission_item_reached_message(seq) for seq in autopilot.reached]
        autopilot.reached.clear()
        return out
