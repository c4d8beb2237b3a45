"""Asks the autopilot for telemetry, again whenever positions are late. Pure."""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.commands import Command

LATE_POSITION_S = 0.5
STREAM_RETRY_S = 2.0
STREAMS_HZ = {
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 5.0,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: 5.0,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 5.0,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: 2.0,
    mavlink.MAVLINK_MSG_ID_WIND: 1.0,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: 0.5,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 0.5,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 0.5,
}


class TelemetryStreams:
    """Remembers when it asked."""

    def __init__(self) -> None:
        """Nothing was asked for yet."""
        self._asked_s = -math.inf
        self._changed = False

    def again(self) -> None:
        """Ask as soon as a rate may be another."""
        self._changed = True

    def due(self, position_s: float, now_s: float) -> list[Command]:
        """Return the requests to send, where the last position, at ``position_s``, is late.

        And where somebody else asked for other rates.
        """
        late = self._changed or now_s - position_s > LATE_POSITION_S
        if not late or now_s - self._asked_s < STREAM_RETRY_S:
            return []
        self._asked_s, self._changed = now_s, False
        number = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
        return [Command(number, (which, 1e6 / rate)) for which, rate in STREAMS_HZ.items()]
