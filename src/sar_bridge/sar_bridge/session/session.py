"""A session with one autopilot: telemetry in, waypoint lists and few commands out. Pure.

It never arms, never takes off, and changes the mode only from GUIDED to AUTO, once an operator has
engaged, and to RTL when an operator asks for it. Times are of a monotonic clock [s].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.mavlink.autopilot_state import AutopilotState
from sar_bridge.mavlink.commands import Command, CommandQueue, ground_heartbeat
from sar_bridge.mavlink.mission_items import FloatArray, first_ahead, waypoint_items
from sar_bridge.mavlink.mission_upload import Address, MissionUpload, UploadState
from sar_bridge.mavlink.parameter_reader import ParameterReader
from sar_bridge.mission.mission_slots import RUN_IN_ITEMS, MissionBanks, RunIn, Write
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import UavStatus
from sar_estimator.common.states import Motion

HEARTBEAT_PERIOD_S = 1.0
LINK_TIMEOUT_S = 3.0
RETRY_LIST_S = 1.0
LATE_POSITION_S = 0.5
STREAM_RETRY_S = 2.0
SPEED_STEP_MPS = 0.2
SPEED_PERIOD_S = 1.0
STREAMS = {
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 5.0,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: 5.0,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 5.0,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: 2.0,
    mavlink.MAVLINK_MSG_ID_WIND: 1.0,
}
TAKEN_UP_S = 0.3  # by the autopilot, two waypoints of a run-in included
OTHER_TRIPS = 3  # beside the items' own: request, acknowledgement, what is made current
LATEST_S = 3.0

Messages = list[mavlink.MAVLink_message]


@dataclass(frozen=True)
class Uploaded:
    """A list the autopilot has accepted: its identity, size, and how long the upload took."""

    list_id: int
    items: int
    duration_s: float


class AutopilotSession:
    """Talks to the first autopilot heard, or to the configured system.

    ``released``: somebody changed the mode while the list was flown; nothing is sent until a new
    engagement. ``taken_to``: the mode chosen then, told until another list is to be flown: the
    planner withdraws its list within milliseconds. ``uploaded``: the newest accepted list.
    ``silent``: the node that leads the UAV or watches over it and is not heard any more: while it
    is named and a list is flown there are no heartbeats, so that the autopilot's own failsafe acts.
    """

    def __init__(self, *, altitude_m: float, target_system: int = 0) -> None:
        """Fly lists at ``altitude_m`` above home; ``target_system`` 0 takes the first heard."""
        self.altitude_m = altitude_m
        self.state = AutopilotState()
        self.address: Address | None = None
        self.released = False
        self.taken_to = ""
        self.uploaded: Uploaded | None = None
        self.silent = ""
        self._wanted_system = target_system
        self._upload: MissionUpload | None = None
        self._reader: ParameterReader | None = None
        self._banks = MissionBanks(altitude_m=altitude_m)
        self._joining: Write | None = None
        self._begun_s = self._ros_s = self._begun_ros_s = 0.0
        self._trip_s = 0.0
        self._later = False
        self._reboots = 0
        self._commands: CommandQueue | None = None
        self._points: FloatArray | None = None
        self._list_id = 0
        self._sent: FloatArray = np.empty((0, 2))
        self._climb_m = 0.0
        self._datum: Datum | None = None
        self._engaging = False
        self._returning = False
        self._mode_flown = ""
        self._streams_asked_s = float("-inf")
        self._speed_wanted_mps = 0.0
        self._speed_sent_mps = 0.0
        self._speed_sent_s = float("-inf")
        self._heartbeat_sent_s = float("-inf")

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
            self.released = self._returning = False
            return []
        if self.released or self._returning:
            return []
        self.taken_to = ""
        if self._points is None:
            self._engaging = may_engage
            self._mode_flown = self.state.mode
        self._points, self._list_id, self._datum = points, list_id, datum
        self._climb_m = climb_m
        return self._start_upload(now_s)

    def set_speed(self, speed_mps: float, now_s: float) -> Messages:
        """Ask for an airspeed [m/s] while a list is flown; small changes and many are kept back."""
        self._speed_wanted_mps = speed_mps
        return self._send_speed(now_s)

    def _send_speed(self, now_s: float) -> Messages:
        wanted = self._speed_wanted_mps
        if self._commands is None or self._points is None or self.released or self._returning:
            return []
        if self.state.mode != "AUTO" or not wanted > 0.0:
            return []
        small = abs(wanted - self._speed_sent_mps) < SPEED_STEP_MPS
        if small or now_s - self._speed_sent_s < SPEED_PERIOD_S:
            return []
        self._speed_sent_mps, self._speed_sent_s = wanted, now_s
        airspeed = float(mavlink.SPEED_TYPE_AIRSPEED)
        return self._commands.send(
            Command(mavlink.MAV_CMD_DO_CHANGE_SPEED, (airspeed, wanted, -1.0)), now_s
        )

    def return_home(self, now_s: float) -> Messages:
        """Command RTL and take no more lists until the planner has withdrawn its own.

        Returns nothing when the autopilot has no such mode or none was heard yet.
        """
        self._let_go()
        self._returning, self.taken_to = True, ""
        return self._mode_command("RTL", now_s)

    def _let_go(self) -> None:
        """Forget the list, and whatever is under way for it."""
        self._points = None
        self._engaging = self._later = False
        self._joining = None
        self._banks.forget()
        self._speed_wanted_mps = self._speed_sent_mps = 0.0
        if self._upload is not None:
            self._upload.cancel()
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
        self._ros_s = ros_s
        out: Messages = []
        if self.address is None:
            if not self._is_autopilot(message, sender):
                return [], False
            out += self._connect(sender, now_s)
        if sender != self.address or self._upload is None or self._commands is None:
            return out, False
        moved = self.state.handle(message, monotonic_s=now_s, ros_s=ros_s, datum=datum)
        self._commands.handle(message)
        if self._reader is not None:
            self._reader.handle(message)
        before = self._upload.state
        out += self._upload.handle(message, now_s)
        if self._upload.state is UploadState.ACCEPTED and before is not UploadState.ACCEPTED:
            out += self._accepted(now_s)
        if message.get_type() == "HEARTBEAT":
            self._watch_mode()
        elif message.get_type() == "MISSION_CURRENT":
            out += self._watch_jump(now_s)
        self._watch_reboots()
        return out, moved

    def _is_autopilot(self, message: mavlink.MAVLink_message, sender: Address) -> bool:
        if message.get_type() != "HEARTBEAT" or self._wanted_system not in (0, sender.system):
            return False
        return bool(message.autopilot != mavlink.MAV_AUTOPILOT_INVALID)

    def _connect(self, address: Address, now_s: float) -> Messages:
        self.address = address
        self._upload = MissionUpload(address)
        self._commands = CommandQueue(address)
        self._reader = ParameterReader(address)
        self._mode_flown = ""
        return self._start_upload(now_s)

    def tick(self, now_s: float) -> Messages:
        """Return what is due: heartbeats, repeats, and a list that failed before."""
        out: Messages = []
        due = now_s - self._heartbeat_sent_s >= HEARTBEAT_PERIOD_S
        if due and not (self.leading and self.silent):
            self._heartbeat_sent_s = now_s
            out.append(ground_heartbeat())
        if self._upload is not None and self._commands is not None:
            if self.state.mode != "GUIDED" and not self._returning:
                self._commands.cancel(mavlink.MAV_CMD_DO_SET_MODE)  # never AUTO against a human
            out += (
                self._ask_for_streams(now_s) + self._upload.tick(now_s) + self._commands.tick(now_s)
            )
            out += self._send_speed(now_s)
            if self._reader is not None and self.state.ardupilot:
                out += self._reader.tick(now_s)
            failed = self._upload.state is UploadState.FAILED
            if failed and now_s - self._upload.finished_s > RETRY_LIST_S:
                out += self._start_upload(now_s)
        return out

    def _ask_for_streams(self, now_s: float) -> Messages:
        """Ask for telemetry, again whenever positions are late (lost request, reboot)."""
        late = now_s - self.state.position_s > LATE_POSITION_S
        if self.address is None or not late or now_s - self._streams_asked_s < STREAM_RETRY_S:
            return []
        self._streams_asked_s = now_s
        return [
            Command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, (number, 1e6 / rate)).message(
                self.address, 0
            )
            for number, rate in STREAMS.items()
        ]

    # What is known -----------------------------------------------------------------------------

    @property
    def leading(self) -> bool:
        """Whether a list is to be flown, and nobody has taken the UAV since."""
        return self._points is not None and not self.released

    def connected(self, now_s: float) -> bool:
        """Whether the autopilot's heartbeat is fresh."""
        return now_s - self.state.heartbeat_s < LINK_TIMEOUT_S

    def status(self, now_s: float) -> UavStatus:
        """Return what the graph is to know of the autopilot at any time."""
        return UavStatus(
            self.state.mode,
            armed=self.state.armed,
            connected=self.connected(now_s),
            led=self.leading,
            airspeed_ratio=round(self.state.wind.airspeed_ratio, 3),
        )

    def problem(self, now_s: float) -> str:
        """Return what is wrong, empty when nothing is."""
        if self.address is None:
            return "no autopilot heard"
        if not self.connected(now_s):
            return "autopilot's heartbeat lost"
        if self.silent and self.leading:
            return f"no heartbeats to the autopilot: node {self.silent} is silent"
        if self.taken_to:
            return f"released: mode {self.taken_to} was chosen by somebody else"
        if self._upload is not None and self._upload.state is UploadState.FAILED:
            return f"mission upload: {self._upload.failure}"
        return self._commands.refusal if self._commands is not None else ""

    # Steps -------------------------------------------------------------------------------------

    def _start_upload(self, now_s: float) -> Messages:
        """Upload the newest list: into a bank of the mission being flown, or as a whole mission."""
        if self._upload is None or self._points is None or self._datum is None:
            return []
        if self._upload.active:
            # ArduPilot denies a part while it receives another, and begins a whole one anew.
            self._later = True
            return []
        if self._upload.state is UploadState.FAILED:
            self._banks.forget()
        self._later, self._joining = False, None
        self._begun_s, self._begun_ros_s, self._sent = now_s, self._ros_s, self._points
        if not self.state.ardupilot:
            altitude = self.altitude_m + self._climb_m
            items = waypoint_items(self._points, self._datum, altitude)[1:]
            return self._upload.start(items, self._list_id, now_s)
        if self.state.mode == "AUTO" and self._banks.takes(self._points):
            current, climb = self.state.current_item, self._climb_m
            write = self._banks.fill(self._points, self._datum, current, climb_m=climb)
            return self._write(write, now_s)
        whole = self._banks.whole(self._points, self._datum, climb_m=self._climb_m)
        return self._upload.start(whole, self._list_id, now_s)

    def _write(self, write: Write, now_s: float) -> Messages:
        assert self._upload is not None
        token = self._list_id if self._joining is None else self._upload.token
        return self._upload.start(list(write.items), token, now_s, at=write.start)

    def _accepted(self, now_s: float) -> Messages:
        """Go on after an upload: lead over to the list, or make it current and begin to fly it."""
        assert self._upload is not None
        if self._points is None or self._datum is None:
            return []
        telemetry = self.state.telemetry
        motion = None if telemetry is None else telemetry.motion
        if self._upload.partial and self._joining is None and motion is not None:
            tuning = FollowerTuning.read(self.parameters)
            trips = len(self._sent) + OTHER_TRIPS
            self._trip_s = max(self._ros_s - self._begun_ros_s, 0.0) / trips
            self._joining = self._banks.join(
                self.state.current_item,
                motion,
                self._datum,
                within_s=self._joined_in_s(motion),
                tuning=tuning,
            )
            return self._write(self._joining, now_s)
        out: Messages = []
        if isinstance(self._joining, RunIn):
            out += self._make_current(self._joining.start, now_s)
        elif not self._upload.partial:
            ahead = first_ahead(self._sent, motion)
            out += self._make_current(ahead + (1 if self.state.ardupilot else 0), now_s)
        self._joining = None
        token = self._upload.token
        if self.uploaded is None or self.uploaded.list_id != token:
            self.uploaded = Uploaded(token, len(self._sent), now_s - self._begun_s)
        if self._engaging and self.state.mode == "GUIDED":
            out += self._mode_command("AUTO", now_s)
        self._engaging = False
        return out + (self._start_upload(now_s) if self._later else [])

    def _joined_in_s(self, motion: Motion) -> float:
        """Return how long after a motion was told the UAV will be led over by what is sent now.

        The link's pace is that of the list sent last, in the time that the UAV flies by: that of
        a simulation may run faster than this node's clock.
        """
        trips_s = (RUN_IN_ITEMS + OTHER_TRIPS) * self._trip_s
        age_s = max(self._ros_s - motion.time_s, 0.0)
        return min(age_s + trips_s + TAKEN_UP_S, LATEST_S)

    def _make_current(self, seq: int, now_s: float) -> Messages:
        assert self._commands is not None
        number = mavlink.MAV_CMD_DO_SET_MISSION_CURRENT
        return self._commands.send(Command(number, (float(seq),)), now_s)

    def _watch_jump(self, now_s: float) -> Messages:
        """Lead over to the new list after all where the UAV was past the jump before it was there.

        Not while something is written: what is, leads over to a list itself.
        """
        telemetry = self.state.telemetry
        if self._points is None or telemetry is None or self._datum is None:
            return []
        assert self._upload is not None
        if self._upload.active:
            return []
        current, motion = self.state.current_item, telemetry.motion
        within_s = self._joined_in_s(motion)
        self._joining = self._banks.missed(current, motion, self._datum, within_s=within_s)
        return [] if self._joining is None else self._write(self._joining, now_s)

    def _watch_reboots(self) -> None:
        """Count on nothing that the autopilot held before it was restarted."""
        if self.state.clock.reboots != self._reboots:
            self._reboots = self.state.clock.reboots
            self._banks.forget()
            if self._reader is not None:
                self._reader.again()

    @property
    def parameters(self) -> dict[str, float]:
        """What is known of the autopilot's parameters."""
        return {} if self._reader is None else self._reader.values

    @property
    def parameters_told(self) -> bool:
        """Whether all that will be known of the parameters is known."""
        return self._reader is not None and (self._reader.done or not self.state.ardupilot)

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
        if self._points is None:
            return
        was, mode = self._mode_flown, self.state.mode
        self._mode_flown = mode
        if mode == "AUTO" or (mode == "GUIDED" and was != "AUTO"):
            return
        self._let_go()
        self.released, self.taken_to = True, mode
