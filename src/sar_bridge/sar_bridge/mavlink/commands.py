"""Commands to the autopilot, repeated until acknowledged: COMMAND_LONG and COMMAND_ACK, pure."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address

TIMEOUT_S = 1.0
RETRIES = 4


def ground_heartbeat() -> mavlink.MAVLink_message:
    """Return the heartbeat of a ground station."""
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE, 3
    )


@dataclass(frozen=True, slots=True)
class Command:
    """One command and its parameters 1 to 7 (missing ones are 0)."""

    number: int
    params: tuple[float, ...] = ()

    def message(self, target: Address, confirmation: int) -> mavlink.MAVLink_message:
        """Return the message that sends it."""
        params = (*self.params, *([0.0] * (7 - len(self.params))))
        return mavlink.MAVLink_command_long_message(
            target.system, target.component, self.number, confirmation, *params
        )


@dataclass(frozen=True, slots=True)
class _Pending:
    command: Command
    sent_s: float
    tries: int = 0


class CommandQueue:
    """Sends commands one kind at a time; a newer command of the same kind replaces the older.

    ``refusal``: the newest command the autopilot refused or never answered, as a text.
    """

    def __init__(self, target: Address) -> None:
        """Send to ``target``."""
        self.target = target
        self.refusal = ""
        self._pending: dict[int, _Pending] = {}

    def send(self, command: Command, now_s: float) -> list[mavlink.MAVLink_message]:
        """Return what to send for a new command."""
        self._pending[command.number] = _Pending(command, now_s)
        return [command.message(self.target, 0)]

    def handle(self, message: mavlink.MAVLink_message) -> None:
        """Take a COMMAND_ACK of the target's."""
        if message.get_type() != "COMMAND_ACK" or message.command not in self._pending:
            return
        if message.result == mavlink.MAV_RESULT_IN_PROGRESS:
            return
        del self._pending[message.command]
        if message.result != mavlink.MAV_RESULT_ACCEPTED:
            result = mavlink.enums["MAV_RESULT"].get(message.result)
            name = result.name if result else str(message.result)
            self.refusal = f"command {message.command}: {name}"

    def tick(self, now_s: float) -> list[mavlink.MAVLink_message]:
        """Repeat what was not acknowledged in time."""
        due = []
        for number, pending in list(self._pending.items()):
            if now_s - pending.sent_s < TIMEOUT_S:
                continue
            if pending.tries >= RETRIES:
                del self._pending[number]
                self.refusal = f"command {number}: no answer after {RETRIES} retries"
                continue
            self._pending[number] = replace(pending, sent_s=now_s, tries=pending.tries + 1)
            due.append(pending.command.message(self.target, pending.tries + 1))
        return due

    def cancel(self, number: int) -> None:
        """Forget one command under way."""
        self._pending.pop(number, None)

    def clear(self) -> None:
        """Forget every command under way."""
        self._pending.clear()
