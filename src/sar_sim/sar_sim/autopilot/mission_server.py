"""The vehicle's half of the mission protocol, as ArduPlane keeps it. Pure.

https://mavlink.io/en/services/mission.html
"""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import MissionItem
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot

ITEM_TIMEOUT_S = 0.25
ITEM_RETRIES = 20
SETTLE_S = 0.2

Messages = list[mavlink.MAVLink_message]


class MissionServer:
    """Takes and gives a simulated autopilot's mission; times are of a monotonic clock [s].

    Several may ask; one at a time may write. Each is answered under its own address.
    """

    def __init__(self, autopilot: SimAutopilot) -> None:
        """Begin with no transfer."""
        self._autopilot = autopilot
        self._next = self._end = 0
        self._asked_s = 0.0
        self._asked = 0
        self._settled_s = -math.inf
        self._asking = self._writing = (0, 0)

    def transferring(self, now_s: float) -> bool:
        """Whether a mission is on its way in, or was just taken and not yet made current."""
        return self._next < self._end or now_s < self._settled_s

    def handle(self, message: mavlink.MAVLink_message, now_s: float) -> Messages:
        """Take a message of the protocol; return the answers, none to another message."""
        self._asking = (message.get_srcSystem(), message.get_srcComponent())
        handler = {
            "MISSION_COUNT": self._count,
            "MISSION_WRITE_PARTIAL_LIST": self._partial,
            "MISSION_ITEM_INT": self._item,
            "MISSION_REQUEST_LIST": self._list,
            "MISSION_REQUEST_INT": self._download,
            "MISSION_CLEAR_ALL": self._clear,
        }.get(message.get_type())
        return [] if handler is None else handler(message, now_s)

    def tick(self, now_s: float) -> Messages:
        """Ask again for an item that did not come; give the transfer up after many tries."""
        if self._next >= self._end or now_s - self._asked_s < ITEM_TIMEOUT_S:
            return []
        if self._asked >= ITEM_RETRIES:
            self._end, self._asking = self._next, self._writing
            return [self._ack(mavlink.MAV_MISSION_OPERATION_CANCELLED)]
        tries = self._asked + 1
        out = self._ask(now_s)
        self._asked = tries
        return out

    def settle(self) -> None:
        """Take the mission for current: it was asked for."""
        self._settled_s = -math.inf

    def restart(self) -> None:
        """Give a transfer up: the autopilot boots anew."""
        self._end = self._next
        self.settle()

    def _list(self, _message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        if self._next < self._end:
            return [self._ack(mavlink.MAV_MISSION_DENIED)]
        return [mavlink.MAVLink_mission_count_message(*self._asking, len(self._autopilot.items))]

    def _taken(self) -> bool:
        """Whether somebody else than who asks is writing."""
        return self._next < self._end and self._asking != self._writing

    def _clear(self, _message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        # As ArduPilot: not while it is flown.
        if self._taken() or self._autopilot.mode is FlightMode.AUTO:
            return [self._ack(mavlink.MAV_MISSION_ERROR)]
        self._end = self._next
        self._autopilot.truncate(1)
        return [self._ack(mavlink.MAV_MISSION_ACCEPTED)]

    def _count(self, message: mavlink.MAVLink_message, now_s: float) -> Messages:
        if message.mission_type != mavlink.MAV_MISSION_TYPE_MISSION:
            return [self._ack(mavlink.MAV_MISSION_UNSUPPORTED)]
        if self._taken():
            return [self._ack(mavlink.MAV_MISSION_DENIED)]
        # As ArduPilot: the mission is cut to its new length now, items are put in as they come.
        self._autopilot.truncate(message.count)
        self._next, self._end, self._writing = 0, message.count, self._asking
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
        self._writing = self._asking
        return self._ask(now_s)

    def _ask(self, now_s: float) -> Messages:
        self._asked_s, self._asked = now_s, 0
        return [mavlink.MAVLink_mission_request_int_message(*self._writing, self._next)]

    def _item(self, message: mavlink.MAVLink_message, now_s: float) -> Messages:
        if self._next >= self._end:
            return [self._ack(mavlink.MAV_MISSION_ERROR)]
        if message.seq != self._next:
            # As ArduPilot: the transfer goes on.
            return [self._ack(mavlink.MAV_MISSION_INVALID_SEQUENCE)]
        if self._taken():
            return [self._ack(mavlink.MAV_MISSION_DENIED)]
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

    def _ack(self, result: int) -> mavlink.MAVLink_message:
        return mavlink.MAVLink_mission_ack_message(*self._asking, result)

    def _download(self, message: mavlink.MAVLink_message, _now_s: float) -> Messages:
        seq = message.seq
        if self._next < self._end:
            return [self._ack(mavlink.MAV_MISSION_DENIED)]
        if seq >= len(self._autopilot.items):
            return [self._ack(mavlink.MAV_MISSION_INVALID_SEQUENCE)]
        item = self._autopilot.items[seq]
        return [
            mavlink.MAVLink_mission_item_int_message(
                *self._asking,
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
