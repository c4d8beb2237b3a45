"""Who a MAVLink message is from, or for."""

from __future__ import annotations

from dataclasses import dataclass

from pymavlink.dialects.v20 import ardupilotmega as mavlink


@dataclass(frozen=True, slots=True)
class Address:
    """A MAVLink system and component."""

    system: int
    component: int


@dataclass(frozen=True, slots=True)
class Addressed:
    """A message to be sent as from an address, not the sender's own."""

    sender: Address
    message: mavlink.MAVLink_message
