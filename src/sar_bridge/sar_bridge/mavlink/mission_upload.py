"""Mission upload by the MAVLink mission protocol, as a pure state machine.

https://mavlink.io/en/services/mission.html: COUNT, then the autopilot asks for every item, then
ACK. The sender repeats what was not answered; a newer list supersedes one under way. A part of the
mission that is held is written with WRITE_PARTIAL_LIST in the place of COUNT. Where the last item
is repeated and the autopilot expects none any more, its ACK was lost: the item is asked for.
"""

from __future__ import annotations

import enum

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.mission_items import MissionItem

COUNT_TIMEOUT_S = 1.5
ITEM_TIMEOUT_S = 0.25
COUNT_RETRIES = 8
ITEM_RETRIES = 20  # five seconds without progress: 40 % may get lost either way
SAME_ALTITUDE_M = 0.1
# ArduPilot says INVALID_SEQUENCE to an item it has already, and CANCELLED of a superseded list.
GOES_ON = (mavlink.MAV_MISSION_INVALID_SEQUENCE, mavlink.MAV_MISSION_OPERATION_CANCELLED)


class UploadState(enum.StrEnum):
    """How far an upload is."""

    IDLE = "idle"
    COUNTING = "counting"
    SENDING = "sending"
    ACCEPTED = "accepted"
    FAILED = "failed"


class MissionUpload:
    """Uploads one list at a time. Times are of any monotonic clock [s].

    ``state`` tells how far it is, ``failure`` why it ended in ``FAILED``, ``token`` the
    identity of the list.
    """

    def __init__(self, target: Address) -> None:
        """Upload to ``target``."""
        self.target = target
        self.state = UploadState.IDLE
        self.failure = ""
        self.token = 0
        self.started_s = 0.0
        self.finished_s = 0.0
        self._items: list[MissionItem] = []
        self._first = 0
        self.partial = False
        self._last: mavlink.MAVLink_message | None = None
        self._sent_s = 0.0
        self._tries = 0
        self._highest_asked = -1
        self._checking = False

    @property
    def active(self) -> bool:
        """Whether an upload is under way."""
        return self.state in (UploadState.COUNTING, UploadState.SENDING)

    @property
    def _end(self) -> int:
        return self._first + len(self._items)

    def start(
        self, items: list[MissionItem], token: int, now_s: float, *, at: int | None = None
    ) -> list[mavlink.MAVLink_message]:
        """Begin to upload ``items``, superseding any other; return what to send.

        A whole mission, or with ``at`` in the place of the items that are held from there on.
        """
        self._items, self.token = items, token
        self.partial, self._first = at is not None, at or 0
        self.state, self.failure = UploadState.COUNTING, ""
        self.started_s = now_s
        self._checking = False
        self._highest_asked = self._first - 1
        if at is not None:
            part = mavlink.MAVLink_mission_write_partial_list_message(
                self.target.system,
                self.target.component,
                at,
                at + len(items) - 1,
                mavlink.MAV_MISSION_TYPE_MISSION,
            )
            return self._send(part, now_s)
        count = mavlink.MAVLink_mission_count_message(
            self.target.system,
            self.target.component,
            len(items),
            mavlink.MAV_MISSION_TYPE_MISSION,
        )
        return self._send(count, now_s)

    def cancel(self) -> None:
        """Forget the upload under way."""
        self.state = UploadState.IDLE

    def _send(
        self, message: mavlink.MAVLink_message, now_s: float
    ) -> list[mavlink.MAVLink_message]:
        self._last, self._sent_s, self._tries = message, now_s, 0
        return [message]

    def handle(
        self, message: mavlink.MAVLink_message, now_s: float
    ) -> list[mavlink.MAVLink_message]:
        """Take a message of the target's; return what to send."""
        if not self.active:
            return []
        kind = message.get_type()
        if kind in ("MISSION_REQUEST_INT", "MISSION_REQUEST"):
            return self._request(message, now_s)
        if kind == "MISSION_ACK":
            return self._acknowledged(message, now_s)
        if kind == "MISSION_ITEM_INT" and self._checking:
            self._check(message, now_s)
        return []

    def _request(
        self, message: mavlink.MAVLink_message, now_s: float
    ) -> list[mavlink.MAVLink_message]:
        seq = message.seq
        if getattr(message, "mission_type", 0) != mavlink.MAV_MISSION_TYPE_MISSION:
            return []
        if not self._first <= seq < self._end or seq > self._highest_asked + 1:
            # Left over from a list that this one superseded: to answer would mix the two.
            return []
        self.state, self._checking = UploadState.SENDING, False
        self._highest_asked = max(self._highest_asked, seq)
        item = self._items[seq - self._first]
        sent = mavlink.MAVLink_mission_item_int_message(
            self.target.system,
            self.target.component,
            seq,
            item.frame,
            item.command,
            0,
            1,
            *item.params,
            item.latitude_e7,
            item.longitude_e7,
            item.altitude_m,
            mavlink.MAV_MISSION_TYPE_MISSION,
        )
        return self._send(sent, now_s)

    def _acknowledged(
        self, message: mavlink.MAVLink_message, now_s: float
    ) -> list[mavlink.MAVLink_message]:
        if getattr(message, "mission_type", 0) != mavlink.MAV_MISSION_TYPE_MISSION:
            return []
        complete = self._highest_asked == self._end - 1
        if message.type == mavlink.MAV_MISSION_ACCEPTED:
            if complete:
                self.state, self.finished_s = UploadState.ACCEPTED, now_s
            # An early ACCEPTED answers an earlier upload: keep on.
        elif complete and message.type == mavlink.MAV_MISSION_ERROR:
            # Of the last item repeated, by this side or by the link: it was accepted before.
            return self._ask_for_last(now_s)
        elif self._checking and message.type == mavlink.MAV_MISSION_DENIED:
            pass  # it still waits for the item, and will ask for it
        elif message.type not in GOES_ON:
            name = mavlink.enums["MAV_MISSION_RESULT"].get(message.type)
            self._fail(f"autopilot refused: {name.name if name else message.type}", now_s)
        return []

    def _ask_for_last(self, now_s: float) -> list[mavlink.MAVLink_message]:
        """Ask for the last item: an autopilot that still expects items denies it."""
        if self._checking:
            return []
        self._checking = True
        asked = mavlink.MAVLink_mission_request_int_message(
            self.target.system,
            self.target.component,
            self._end - 1,
            mavlink.MAV_MISSION_TYPE_MISSION,
        )
        return self._send(asked, now_s)

    def _check(self, message: mavlink.MAVLink_message, now_s: float) -> None:
        """Take the last item as the autopilot holds it."""
        last = self._items[-1]
        if message.seq != self._end - 1:
            return
        same = (message.command, message.x, message.y) == (
            last.command,
            last.latitude_e7,
            last.longitude_e7,
        )
        same = same and round(message.param1) == round(last.params[0])  # where a jump leads
        if same and abs(message.z - last.altitude_m) < SAME_ALTITUDE_M:
            self.state, self.finished_s = UploadState.ACCEPTED, now_s
        else:
            self._fail(f"item {message.seq} is not the one sent", now_s)

    def _fail(self, why: str, now_s: float) -> None:
        self.state, self.failure, self.finished_s = UploadState.FAILED, why, now_s

    def tick(self, now_s: float) -> list[mavlink.MAVLink_message]:
        """Repeat what was not answered in time; give up after so many tries."""
        if not self.active or self._last is None:
            return []
        limit = COUNT_TIMEOUT_S if self.state is UploadState.COUNTING else ITEM_TIMEOUT_S
        retries = COUNT_RETRIES if self.state is UploadState.COUNTING else ITEM_RETRIES
        if self._highest_asked == self._end - 1:
            limit, retries = COUNT_TIMEOUT_S, COUNT_RETRIES
        if now_s - self._sent_s < limit:
            return []
        if self._tries >= retries:
            self._fail(f"no answer after {retries} retries in state {self.state}", now_s)
            return []
        self._tries += 1
        self._sent_s = now_s
        return [self._last]
