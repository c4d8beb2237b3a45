"""A waypoint list on its way to the autopilot: uploaded, led over to, made current. Pure.

Times are of a monotonic clock [s], but for ``ros_s``, which the UAV flies by.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.mavlink.autopilot_state import AutopilotState
from sar_bridge.mavlink.commands import Command, CommandQueue
from sar_bridge.mavlink.mission_items import FloatArray, first_ahead, waypoint_items
from sar_bridge.mavlink.mission_upload import MissionUpload, UploadState
from sar_bridge.mission.mission_slots import CAPTURE_ITEMS, CaptureWaypoints, MissionSlots, Write
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.states import Motion

RETRY_LIST_S = 1.0
TAKEN_UP_S = 0.3  # by the autopilot, two capture waypoints included
OTHER_TRIPS = 3  # beside the items' own: request, acknowledgement, what is made current
LATEST_S = 3.0
NO_COUNT = 65535

Messages = list[mavlink.MAVLink_message]


@dataclass(frozen=True)
class Accepted:
    """A list the autopilot has accepted: its identity, size, and how long the upload took."""

    list_id: int
    items: int
    duration_s: float


@dataclass(frozen=True)
class Wanted:
    """The list that is to be flown: ``points``, shape (n, 2) [m]; ``climb_m``: above the usual."""

    points: FloatArray
    list_id: int
    datum: Datum
    climb_m: float = 0.0


@dataclass(frozen=True)
class Sent:
    """The list whose upload was begun last, when it was, and by which time of the UAV's."""

    points: FloatArray
    begun_s: float
    ros_s: float


class ListTransfer:
    """Takes the newest list to the autopilot: into a slot of its mission, or as a whole one.

    ``wanted``: the list that is to be flown, None for none. ``accepted``: the newest one that was
    taken. ``held``: lists wait, somebody else writes a mission. ``ros_s``: the time by which the
    UAV flies, to be set.
    """

    def __init__(self, state: AutopilotState, *, altitude_m: float) -> None:
        """Fly lists at ``altitude_m`` above home; ``state``: what the autopilot says of itself."""
        self._state = state
        self._altitude_m = altitude_m
        self._slots = MissionSlots(altitude_m=altitude_m)
        self._link: tuple[MissionUpload, CommandQueue] | None = None
        self.wanted: Wanted | None = None
        self.accepted: Accepted | None = None
        self.held = False
        self._total: int | None = None
        self.ros_s = 0.0
        self._sent = Sent(np.empty((0, 2)), 0.0, 0.0)
        self._joining: Write | None = None
        self._trip_s = 0.0
        self._later = False

    @property
    def upload(self) -> MissionUpload | None:
        """The mission protocol with the autopilot, None before it was heard."""
        return None if self._link is None else self._link[0]

    @property
    def active(self) -> bool:
        """Whether a list is on its way to the autopilot."""
        return self.upload is not None and self.upload.active

    @property
    def failure(self) -> str:
        """Why the newest upload failed, empty where it did not."""
        failed = self.upload is not None and self.upload.state is UploadState.FAILED
        return self.upload.failure if failed and self.upload is not None else ""

    def connect(self, upload: MissionUpload, commands: CommandQueue, now_s: float) -> Messages:
        """Begin with an autopilot that was heard: it gets the list that is wanted."""
        self._link = upload, commands
        return self.start(now_s)

    def want(self, wanted: Wanted, now_s: float) -> Messages:
        """Upload a list, at once or when what is under way is done."""
        self.wanted = wanted
        return self.start(now_s)

    def forget(self) -> None:
        """Want no list any more, and break off what is under way for it."""
        self.wanted = None
        self._later, self._joining = False, None
        self._slots.forget()
        if self.upload is not None:
            self.upload.cancel()

    def forget_mission(self) -> None:
        """Count on nothing that the autopilot held."""
        self._slots.forget()
        self._total = None

    def start(self, now_s: float) -> Messages:
        """Upload the newest list: into a slot of the mission being flown, or as a whole mission."""
        upload, wanted = self.upload, self.wanted
        if upload is None or wanted is None:
            return []
        if upload.active or self.held:
            # ArduPilot denies a part while it receives another, and begins a whole one anew.
            self._later = True
            return []
        if upload.state is UploadState.FAILED:
            self._slots.forget()
        self._later, self._joining = False, None
        self._sent = Sent(wanted.points, now_s, self.ros_s)
        if not self._state.ardupilot:
            altitude_m = self._altitude_m + wanted.climb_m
            items = waypoint_items(wanted.points, wanted.datum, altitude_m)[1:]
            return upload.start(items, wanted.list_id, now_s)
        given = {"climb_m": wanted.climb_m}
        if self._state.mode == "AUTO" and self._slots.takes(wanted.points):
            current = self._state.current_item
            write = self._slots.fill(wanted.points, wanted.datum, current, **given)
            return self._write(upload, wanted, write, now_s)
        whole = self._slots.whole(wanted.points, wanted.datum, **given)
        self._total = len(whole) - 1  # home is not counted
        return upload.start(whole, wanted.list_id, now_s)

    def handle(
        self, message: mavlink.MAVLink_message, parameters: dict[str, float], now_s: float
    ) -> tuple[Messages, bool]:
        """Take a message; return what to send, and whether a list has just been taken whole.

        ``parameters``: the autopilot's, as far as known.
        """
        upload = self.upload
        if upload is None:
            return [], False
        before = upload.state
        out: Messages = list(upload.handle(message, now_s))
        if upload.state is not UploadState.ACCEPTED or before is UploadState.ACCEPTED:
            return out, False
        more, whole = self._go_on(parameters, now_s)
        return out + more, whole

    def tick(self, now_s: float) -> Messages:
        """Return what is due: repeats, and a list that failed before."""
        upload = self.upload
        if upload is None:
            return []
        out: Messages = list(upload.tick(now_s))
        failed = upload.state is UploadState.FAILED
        if failed and now_s - upload.finished_s > RETRY_LIST_S:
            out += self.start(now_s)
        return out

    def is_ours(self, total: int) -> bool:
        """Whether a mission of so many items, home not counted, may be what was uploaded.

        True while that is not known; 0 and 65535 are no counts.
        """
        accepted = self.upload is not None and self.upload.state is UploadState.ACCEPTED
        return not accepted or self._total is None or total in (0, NO_COUNT, self._total)

    def _write(self, upload: MissionUpload, wanted: Wanted, write: Write, now_s: float) -> Messages:
        token = wanted.list_id if self._joining is None else upload.token
        return upload.start(list(write.items), token, now_s, at=write.start)

    def _go_on(self, parameters: dict[str, float], now_s: float) -> tuple[Messages, bool]:
        """Go on after an upload: lead over to the list, or make it current."""
        assert self._link is not None
        upload, commands = self._link
        wanted, telemetry = self.wanted, self._state.telemetry
        if wanted is None:
            return [], False
        motion = None if telemetry is None else telemetry.motion
        if upload.partial and self._joining is None and motion is not None:
            trips = len(self._sent.points) + OTHER_TRIPS
            self._trip_s = max(self.ros_s - self._sent.ros_s, 0.0) / trips
            self._joining = self._slots.join(
                self._state.current_item,
                motion,
                wanted.datum,
                within_s=self._joined_in_s(motion),
                tuning=FollowerTuning.read(parameters),
            )
            return self._write(upload, wanted, self._joining, now_s), False
        out: Messages = []
        if isinstance(self._joining, CaptureWaypoints):
            out += _make_current(commands, self._joining.start, now_s)
        elif not upload.partial:
            ahead = first_ahead(self._sent.points, motion)
            out += _make_current(commands, ahead + (1 if self._state.ardupilot else 0), now_s)
        self._joining = None
        if self.accepted is None or self.accepted.list_id != upload.token:
            took_s = now_s - self._sent.begun_s
            self.accepted = Accepted(upload.token, len(self._sent.points), took_s)
        return out, True

    def hold(self, held: bool, now_s: float) -> Messages:  # noqa: FBT001
        """Keep lists back while ``held``; send the newest one after that."""
        self.held = held
        return [] if held else self.start_later(now_s)

    def start_later(self, now_s: float) -> Messages:
        """Upload the list that came while another was under way, if any did."""
        return self.start(now_s) if self._later and not self.active else []

    def _joined_in_s(self, motion: Motion) -> float:
        """Return how long after a motion was told the UAV will be led over by what is sent now.

        The link's pace is that of the list sent last, in the time that the UAV flies by: that of
        a simulation may run faster than this node's clock.
        """
        trips_s = (CAPTURE_ITEMS + OTHER_TRIPS) * self._trip_s
        age_s = max(self.ros_s - motion.time_s, 0.0)
        return min(age_s + trips_s + TAKEN_UP_S, LATEST_S)

    def watch_jump(self, now_s: float) -> Messages:
        """Lead over to the new list after all where the UAV was past the jump before it was there.

        Not while something is written: what is, leads over to a list itself.
        """
        upload, wanted, telemetry = self.upload, self.wanted, self._state.telemetry
        if wanted is None or telemetry is None or upload is None or upload.active:
            return []
        motion = telemetry.motion
        self._joining = self._slots.missed(
            self._state.current_item, motion, wanted.datum, within_s=self._joined_in_s(motion)
        )
        if self._joining is None:
            return []
        return self._write(upload, wanted, self._joining, now_s)


def _make_current(commands: CommandQueue, seq: int, now_s: float) -> Messages:
    number = mavlink.MAV_CMD_DO_SET_MISSION_CURRENT
    return list(commands.send(Command(number, (float(seq),)), now_s))
