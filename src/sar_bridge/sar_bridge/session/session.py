"""A session with one autopilot: telemetry in, waypoint lists and few commands out. Pure.

It never arms, never takes off, and changes the mode only from GUIDED to AUTO, once an operator has
engaged, and to RTL when an operator asks for it. Times are of a monotonic clock [s].
"""

from __future__ import annotations

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.autopilot_state import AutopilotState
from sar_bridge.mavlink.commands import Command, CommandQueue
from sar_bridge.mavlink.mission_items import FloatArray
from sar_bridge.mavlink.mission_upload import MissionUpload
from sar_bridge.mavlink.parameter_reader import ParameterReader
from sar_bridge.session.heartbeats import Heartbeats
from sar_bridge.session.list_transfer import Accepted, ListTransfer, Messages, Wanted
from sar_bridge.session.mode_guard import ModeGuard
from sar_bridge.session.speed_command import SpeedCommand
from sar_bridge.session.telemetry_streams import TelemetryStreams
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import UavStatus

FOREIGN_S = 3.0


class AutopilotSession:
    """Talks to the first autopilot heard, or to the configured system.

    ``state``: what the autopilot says of itself. ``transfer``: lists on their way to it. ``guard``:
    who has the UAV. ``streams``: the telemetry that is asked for. ``heartbeats``: the ground
    station's, that tell the autopilot that it is led.
    """

    def __init__(
        self, *, altitude_m: float, target_system: int = 0, link_timeout_s: float = 3.0
    ) -> None:
        """Fly lists at ``altitude_m`` above home; ``target_system`` 0 takes the first heard.

        ``link_timeout_s``: without a heartbeat, after which the autopilot is not heard any more.
        """
        self.state = AutopilotState()
        self.transfer = ListTransfer(self.state, altitude_m=altitude_m)
        self.guard = ModeGuard()
        self.address: Address | None = None
        self.heartbeats = Heartbeats()
        self._wanted_system = target_system
        self._link_timeout_s = link_timeout_s
        self._speed = SpeedCommand()
        self.streams = TelemetryStreams()
        self._commands: CommandQueue | None = None
        self._reader: ParameterReader | None = None
        self._reboots = 0
        self._ours_s = float("inf")

    # What is asked of the session --------------------------------------------------------------

    def set_list(
        self,
        points: FloatArray,
        list_id: int,
        datum: Datum,
        now_s: float,
        *,
        climb_m: float = 0.0,
        may_engage: bool = True,
    ) -> Messages:
        """Upload a list and fly it; an empty one withdraws whatever is under way.

        ``climb_m``: how far above the usual altitude it is flown. ``may_engage``: whether a first
        list may change the mode from GUIDED to AUTO (not one that was published before this session
        began).
        """
        if len(points) == 0:
            self._let_go()
            self.guard.withdraw()
            return []
        if not self.guard.takes_lists:
            return []
        self.guard.taken = ""
        if self.transfer.wanted is None:
            self.guard.begin(self.state.mode, may_engage=may_engage)
        return self.transfer.want(Wanted(points, list_id, datum, climb_m), now_s)

    def set_speed(self, speed_mps: float, now_s: float) -> Messages:
        """Ask for an airspeed [m/s] while a list is flown; small changes and many are kept back."""
        self._speed.wanted_mps = speed_mps
        return self._send_speed(now_s)

    def _send_speed(self, now_s: float) -> Messages:
        flown = self.transfer.wanted is not None and self.guard.takes_lists
        if self._commands is None or not flown or self.state.mode != "AUTO":
            return []
        command = self._speed.due(now_s)
        return [] if command is None else self._commands.send(command, now_s)

    def take_away(self, by: str) -> None:
        """Let go: somebody leads the UAV otherwise, ``by`` what, while a list is to be flown."""
        if self.leading:
            self._let_go()
            self.guard.take(by)

    def return_home(self, now_s: float) -> Messages:
        """Command RTL and take no more lists until the planner has withdrawn its own.

        Returns nothing when the autopilot has no such mode or none was heard yet.
        """
        self._let_go()
        self.guard.send_home()
        return self._mode_command("RTL", now_s)

    def _let_go(self) -> None:
        """Forget the list, and whatever is under way for it."""
        self.transfer.forget()
        self._speed.forget()
        if self._commands is not None:
            self._commands.clear()

    # Messages ----------------------------------------------------------------------------------

    def handle(
        self,
        message: mavlink.MAVLink_message,
        *,
        now_s: float,
        ros_s: float,
        datum: Datum | None,
    ) -> tuple[Messages, bool]:
        """Take a message; return what to send, and whether there is a new position."""
        sender = Address(message.get_srcSystem(), message.get_srcComponent())
        self.transfer.ros_s = ros_s
        out: Messages = []
        if self.address is None:
            if not self._is_autopilot(message, sender):
                return [], False
            out += self._connect(sender, now_s)
        if sender != self.address or self._commands is None or self._reader is None:
            return out, False
        moved = self.state.handle(message, monotonic_s=now_s, ros_s=ros_s, datum=datum)
        self._commands.handle(message)
        self._reader.handle(message)
        sent, taken = self.transfer.handle(message, self.parameters, now_s)
        out += sent
        if taken:
            if self.guard.may_start(self.state.mode):
                out += self._mode_command("AUTO", now_s)
            out += self.transfer.start_later(now_s)
        if message.get_type() == "HEARTBEAT":
            self._watch_mode()
        elif message.get_type() == "MISSION_CURRENT":
            self._watch_mission(now_s)
            out += self.transfer.watch_jump(now_s)
        self._watch_reboots()
        return out, moved

    def _is_autopilot(self, message: mavlink.MAVLink_message, sender: Address) -> bool:
        if message.get_type() != "HEARTBEAT" or self._wanted_system not in (0, sender.system):
            return False
        return bool(message.autopilot != mavlink.MAV_AUTOPILOT_INVALID)

    def _connect(self, address: Address, now_s: float) -> Messages:
        self.address = address
        self._commands = CommandQueue(address)
        self._reader = ParameterReader(address)
        self.guard.connect()
        return self.transfer.connect(MissionUpload(address), self._commands, now_s)

    def tick(self, now_s: float) -> Messages:
        """Return what is due: heartbeats, repeats, and a list that failed before."""
        out = self.heartbeats.due(now_s, leading=self.leading)
        if self.address is None or self._commands is None or self._reader is None:
            return out
        if self.state.mode != "GUIDED" and not self.guard.returning:
            self._commands.cancel(mavlink.MAV_CMD_DO_SET_MODE)  # never AUTO against a human
        for command in self.streams.due(self.state.position_s, now_s):
            out.append(command.message(self.address, 0))
        out += self.transfer.tick(now_s) + self._commands.tick(now_s) + self._send_speed(now_s)
        if self.state.ardupilot:
            out += self._reader.tick(now_s)
        return out

    # What is known -----------------------------------------------------------------------------

    @property
    def accepted(self) -> Accepted | None:
        """The newest list that the autopilot has accepted."""
        return self.transfer.accepted

    @property
    def leading(self) -> bool:
        """Whether a list is to be flown, and nobody has taken the UAV since."""
        return self.transfer.wanted is not None and not self.guard.released

    def connected(self, now_s: float) -> bool:
        """Whether the autopilot's heartbeat is fresh."""
        return now_s - self.state.heartbeat_s < self._link_timeout_s

    def status(self, now_s: float) -> UavStatus:
        """Return what the graph is to know of the autopilot at any time."""
        return UavStatus(
            self.state.mode,
            armed=self.state.armed,
            connected=self.connected(now_s),
            tracking_list=self.leading,
            taken=self.guard.taken if self.guard.released else "",
            airspeed_ratio=round(self.state.wind.airspeed_ratio, 3),
        )

    def problem(self, now_s: float) -> str:
        """Return what is wrong, empty when nothing is."""
        if self.address is None:
            return "no autopilot heard"
        if not self.connected(now_s):
            return "autopilot's heartbeat lost"
        if withheld := self.heartbeats.withheld(leading=self.leading):
            return withheld
        if self.guard.taken:
            return f"released: {self.guard.taken}"
        if self.transfer.failure:
            return f"mission upload: {self.transfer.failure}"
        return self._commands.refusal if self._commands is not None else ""

    @property
    def parameters(self) -> dict[str, float]:
        """What is known of the autopilot's parameters."""
        return {} if self._reader is None else self._reader.values

    @property
    def parameters_complete(self) -> bool:
        """Whether all that will be known of the parameters is known."""
        return self._reader is not None and (self._reader.done or not self.state.ardupilot)

    # Steps -------------------------------------------------------------------------------------

    def _mode_command(self, name: str, now_s: float) -> Messages:
        if self._commands is None:
            return []
        try:
            number = self.state.mode_number(name)
        except KeyError:
            return []
        custom = float(mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)
        return self._commands.send(
            Command(mavlink.MAV_CMD_DO_SET_MODE, (custom, float(number))), now_s
        )

    def _watch_mode(self) -> None:
        """Let go at once when somebody else chose a mode while a list is to be flown."""
        if self.transfer.wanted is not None and self.guard.is_taken(self.state.mode):
            self._let_go()

    def _watch_mission(self, now_s: float) -> None:
        """Let go of a UAV whose mission is not ours any more: another radio may have written it."""
        if self.transfer.is_ours(self.state.mission_total):
            self._ours_s = now_s
        elif now_s - self._ours_s > FOREIGN_S:
            self.transfer.forget_mission()
            self.take_away("another mission was written by somebody else")

    def _watch_reboots(self) -> None:
        """Count on nothing that the autopilot held before it was restarted."""
        if self.state.clock.reboots != self._reboots:
            self._reboots = self.state.clock.reboots
            self.transfer.forget_mission()
            if self._reader is not None:
                self._reader.again()
