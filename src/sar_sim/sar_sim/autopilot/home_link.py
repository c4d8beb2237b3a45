"""Asks an autopilot where its home is."""

from __future__ import annotations

import time

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.commands import Command, ground_heartbeat
from sar_bridge.mavlink.link import Link
from sar_estimator.common.geodesy import Datum

ASK_PERIOD_S = 1.0
HOME = Command(mavlink.MAV_CMD_REQUEST_MESSAGE, (mavlink.MAVLINK_MSG_ID_HOME_POSITION,))


def home_of(url: str, *, patience_s: float = 10.0) -> Datum:
    """Return the home of the autopilot at a URL. Raises ``ValueError`` when none is told."""
    link = Link(url)
    try:
        end = time.monotonic() + patience_s
        asked_s, autopilot = 0.0, None
        while time.monotonic() < end:
            for message in link.receive(0.1):
                kind = message.get_type()
                if kind == "HEARTBEAT" and message.autopilot != mavlink.MAV_AUTOPILOT_INVALID:
                    autopilot = Address(message.get_srcSystem(), message.get_srcComponent())
                elif kind == "HOME_POSITION":
                    place = message.latitude / 1e7, message.longitude / 1e7
                    return Datum(*place, message.altitude / 1e3)
            if time.monotonic() - asked_s > ASK_PERIOD_S:
                asked_s = time.monotonic()
                link.send([ground_heartbeat()])
                if autopilot is not None:
                    link.send([HOME.message(autopilot, 0)])
    finally:
        link.close()
    raise ValueError(f"{url}: expected an autopilot that tells its home within {patience_s:g} s")
