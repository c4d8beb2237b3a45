"""Ground stations beside the bridge: what goes from them to the autopilot, and back. Pure.

They share the one link to the UAV, both ways, as a router shares it; but for what would mix two
mission transfers, or keep the autopilot from noticing that its leader is gone. Times are of a
monotonic clock [s]. https://mavlink.io/en/services/mission.html
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address, Addressed

MISSION = mavlink.MAV_MISSION_TYPE_MISSION
COMPANION = mavlink.MAV_COMP_ID_ONBOARD_COMPUTER
"""The component that speaks to the stations: of the UAV's system, so that they show its texts."""
STALLED_S = 3.0
GIVEN_UP_S = 8.0
LOST_S = 5.0

WRITES = ("MISSION_COUNT", "MISSION_WRITE_PARTIAL_LIST", "MISSION_CLEAR_ALL")
READS = ("MISSION_REQUEST_LIST", "MISSION_REQUEST_PARTIAL_LIST")
STEPS = ("MISSION_ITEM", "MISSION_ITEM_INT", "MISSION_REQUEST", "MISSION_REQUEST_INT")
ACK = "MISSION_ACK"
PROTOCOL = (*WRITES, *READS, *STEPS, ACK)
STICKS = ("MANUAL_CONTROL", "RC_CHANNELS_OVERRIDE")
"""What the autopilot takes for a sign of life, beside heartbeats."""
CHOSEN = (mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, mavlink.MAV_CMD_MISSION_START)
RATES = ("REQUEST_DATA_STREAM", "SET_MESSAGE_INTERVAL")
NEVER = ("HEARTBEAT", "SETUP_SIGNING", "BAD_DATA")
"""Never passed on: signs of life are the bridge's own; a key is not told over a radio."""
GUIDED_ITEMS = (2, 3)
"""``current`` of an item that is no mission's: a place to go to, or an altitude."""


@dataclass(frozen=True, slots=True)
class Traffic:
    """What a message leads to.

    ``to_autopilot``: packets, as they came. ``to_stations``: by station, packets or messages with
    their sender. ``mission_changed``: a mission is being written there; ``item_chosen``: what is
    flown of it was chosen there; ``rates_changed``: how often telemetry comes.
    """

    to_autopilot: list[bytes] = field(default_factory=list)
    to_stations: list[tuple[int, bytes | Addressed]] = field(default_factory=list)
    mission_changed: bool = False
    item_chosen: bool = False
    rates_changed: bool = False


NOTHING = Traffic()


@dataclass(frozen=True, slots=True)
class _Transfer:
    """A mission on its way between a station and the autopilot."""

    station: int
    address: Address
    writes: bool
    heard_s: float


@dataclass(frozen=True, slots=True)
class _Waiting:
    """What begins a transfer, and has to wait for another."""

    message: mavlink.MAVLink_message
    since_s: float


@dataclass(frozen=True, slots=True)
class Bridge:
    """What the stations have to respect: is a list ``flown``, is one of ours on its way (``busy``).

    ``silent``: the bridge keeps silent on purpose, so that the autopilot's failsafe acts.
    """

    autopilot: Address
    flown: bool = False
    busy: bool = False
    silent: bool = False


class GroundStations:
    """Stations by number, each with the addresses that were heard of it."""

    def __init__(self, own: Address, count: int) -> None:
        """Have heard none; ``own``: the bridge's address, which none of them may have."""
        self.own = own
        self._addresses: list[set[Address]] = [set() for _ in range(count)]
        self._heard_s = [float("-inf")] * count
        self._transfer: _Transfer | None = None
        self._waiting: dict[int, _Waiting] = {}
        self.same_address = False

    @property
    def writing(self) -> bool:
        """Whether a mission is being written by a station: none of ours can be."""
        return self._transfer is not None and self._transfer.writes

    def heard(self, now_s: float) -> int:
        """Return how many stations are there."""
        return sum(now_s - one < LOST_S for one in self._heard_s)

    # From a station ----------------------------------------------------------------------------

    def take(
        self, station: int, message: mavlink.MAVLink_message, now_s: float, bridge: Bridge
    ) -> Traffic:
        """Take a station's message; return where it goes, and what is answered for the autopilot.

        A mission that is begun while one of ours is on its way waits for that; none is taken while
        a list is flown.
        """
        sender = _sender(message)
        if sender == self.own:
            self.same_address = True
            return NOTHING
        self._addresses[station].add(sender)
        self._heard_s[station] = now_s
        kind = message.get_type()
        to = getattr(message, "target_system", 0)
        if kind in NEVER or to not in (0, bridge.autopilot.system):
            return NOTHING
        if kind in STICKS and bridge.silent:
            return NOTHING
        if kind in PROTOCOL and _mission_type(message) == MISSION:
            return self._mission(station, message, now_s, bridge)
        chosen = kind == "MISSION_SET_CURRENT" or _command(message) in CHOSEN
        rates = kind in RATES or _command(message) == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
        return Traffic([_packet(message)], item_chosen=chosen, rates_changed=rates)

    def _mission(
        self, station: int, message: mavlink.MAVLink_message, now_s: float, bridge: Bridge
    ) -> Traffic:
        kind, sender = message.get_type(), _sender(message)
        if getattr(message, "current", 0) in GUIDED_ITEMS and kind in STEPS:
            return Traffic([_packet(message)])
        begins = kind in WRITES or kind in READS
        other = self._transfer is not None and self._transfer.address != sender
        if kind in WRITES and bridge.flown:
            text = "In formation: disengage to write a mission"
            return _refused(station, sender, bridge.autopilot, text)
        if begins and (bridge.busy or other):
            self._waiting[station] = _Waiting(message, now_s)
            return NOTHING
        if begins:
            writes = kind in WRITES
            self._waiting.pop(station, None)
            if kind != "MISSION_CLEAR_ALL":
                self._transfer = _Transfer(station, sender, writes, now_s)
            return Traffic([_packet(message)], mission_changed=writes)
        if self._transfer is None or other:
            # What belongs to no transfer of its: an item asked for by itself does no harm.
            alone = kind.startswith("MISSION_REQUEST") and not (bridge.busy or other)
            return Traffic([_packet(message)]) if alone else NOTHING
        self._went_on(self._transfer, now_s, ended=kind == ACK)
        return Traffic([_packet(message)])

    def _went_on(self, transfer: _Transfer, now_s: float, *, ended: bool) -> None:
        self._transfer = None if ended else replace(transfer, heard_s=now_s)

    def tick(self, now_s: float, bridge: Bridge | None) -> list[Traffic]:
        """Forget a transfer that stands still; let the one begin that has waited longest."""
        transfer = self._transfer
        if transfer is not None and now_s - transfer.heard_s > STALLED_S:
            self._transfer = None
        self._waiting = {
            station: one
            for station, one in self._waiting.items()
            if now_s - one.since_s < GIVEN_UP_S
        }
        if bridge is None or bridge.busy or not self._waiting or self._transfer is not None:
            return []
        station = min(self._waiting, key=lambda one: self._waiting[one].since_s)
        return [self.take(station, self._waiting.pop(station).message, now_s, bridge)]

    def make_way(self, bridge: Bridge) -> Traffic:
        """Break off a mission that is being read, for a list of ours that has to go out."""
        transfer = self._transfer
        if transfer is None or transfer.writes:
            return NOTHING
        self._transfer = None
        text = "Formation's waypoints went first: read it again"
        result = mavlink.MAV_MISSION_OPERATION_CANCELLED
        return _refused(transfer.station, transfer.address, bridge.autopilot, text, result)

    # From the autopilot's side -----------------------------------------------------------------

    def is_ours(self, message: mavlink.MAVLink_message) -> bool:
        """Whether a message of the autopilot's concerns the bridge."""
        to = _target(message)
        if to.system and not _is_for(self.own, to):
            return False
        # An autopilot that tells not whom it answers: who is in a transfer.
        nobody = to.system == 0 and message.get_type() in PROTOCOL
        return not (nobody and self._transfer is not None)

    def pass_on(
        self, message: mavlink.MAVLink_message, now_s: float, *, busy: bool
    ) -> list[tuple[int, bytes | Addressed]]:
        """Return to which stations a message from the UAV's side of the link goes.

        To whom it is meant for; to all where that is not said, but for an answer to a transfer.
        """
        if not self._addresses:
            return []
        kind, to, packet = message.get_type(), _target(message), _packet(message)
        transfer = self._transfer
        in_protocol = kind in PROTOCOL and _mission_type(message) == MISSION
        if in_protocol and transfer is not None and _is_for(transfer.address, to):
            self._went_on(transfer, now_s, ended=kind == ACK)
            return [(transfer.station, packet)]
        if to.system == 0 and in_protocol and busy:
            return []
        return [
            (station, packet)
            for station, addresses in enumerate(self._addresses)
            if to.system == 0 or any(_is_for(one, to) for one in addresses)
        ]


def _is_for(address: Address, to: Address) -> bool:
    """Whether a message to ``to``, where 0 is anybody, is for an address."""
    return to.system in (0, address.system) and to.component in (0, address.component)


def _packet(message: mavlink.MAVLink_message) -> bytes:
    return bytes(message.get_msgbuf())


def _sender(message: mavlink.MAVLink_message) -> Address:
    return Address(message.get_srcSystem(), message.get_srcComponent())


def _target(message: mavlink.MAVLink_message) -> Address:
    system = getattr(message, "target_system", 0)
    return Address(system, getattr(message, "target_component", 0))


def _mission_type(message: mavlink.MAVLink_message) -> int:
    """Return the kind of a list of items; all of them, which can be cleared, have the mission."""
    kind = getattr(message, "mission_type", MISSION)
    return MISSION if kind == mavlink.MAV_MISSION_TYPE_ALL else kind


def _command(message: mavlink.MAVLink_message) -> int:
    is_command = message.get_type() in ("COMMAND_LONG", "COMMAND_INT")
    return message.command if is_command else -1


def _refused(
    station: int,
    to: Address,
    autopilot: Address,
    text: str,
    result: int = mavlink.MAV_MISSION_DENIED,
) -> Traffic:
    """Return a refusal in the autopilot's name, and why, for a station to show."""
    ack = mavlink.MAVLink_mission_ack_message(to.system, to.component, result, MISSION)
    told = mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_WARNING, text.encode())
    companion = Address(autopilot.system, COMPANION)
    return Traffic(
        to_stations=[(station, Addressed(autopilot, ack)), (station, Addressed(companion, told))]
    )
