"""The airspeed that is asked of the autopilot: small changes and many are kept back. Pure."""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.commands import Command

SPEED_STEP_MPS = 0.2
SPEED_PERIOD_S = 1.0


class SpeedCommand:
    """``wanted_mps``: the airspeed that is wanted, 0 for none."""

    def __init__(self) -> None:
        """Ask for nothing."""
        self.wanted_mps = 0.0
        self._sent_mps = 0.0
        self._sent_s = -math.inf

    def forget(self) -> None:
        """Want nothing any more; what is wanted next is asked for whatever it is."""
        self.wanted_mps = self._sent_mps = 0.0

    def due(self, now_s: float) -> Command | None:
        """Return the command to send, where one is due."""
        wanted = self.wanted_mps
        small = abs(wanted - self._sent_mps) < SPEED_STEP_MPS
        if not wanted > 0.0 or small or now_s - self._sent_s < SPEED_PERIOD_S:
            return None
        self._sent_mps, self._sent_s = wanted, now_s
        airspeed = float(mavlink.SPEED_TYPE_AIRSPEED)
        return Command(mavlink.MAV_CMD_DO_CHANGE_SPEED, (airspeed, wanted, -1.0))
