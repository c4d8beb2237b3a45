"""u-blox's UBX: NAV-PVT; of receivers that have none NAV-SOL and NAV-VELNED. By pyubx2."""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pymap3d
from pyubx2 import GET, UBXReader
from pyubx2.exceptions import UBXMessageError, UBXParseError, UBXStreamError, UBXTypeError

from sar_estimator.gps.framing import PARSER_ERRORS
from sar_estimator.gps.reading import Reading

GPS_EPOCH_S = 315_964_800.0
"""The beginning of GPS time, 1980-01-06, since 1970 [s]."""
WEEK_S = 604_800.0
FIXES = (2, 3, 4)
"""The types of fix that are a position: 2D, 3D, GNSS with dead reckoning."""
SEEN_PVT = "NAV-PVT"


class UbxDecoder:
    """Reads a receiver's solutions; each is an epoch by itself.

    ``leap_s``: GPS time less UTC [s], for messages that tell it not; NAV-TIMEUTC and NAV-TIMEGPS
    tell it. ``damaged``: messages that are of no known shape.
    """

    def __init__(self, leap_s: float = 18.0) -> None:
        """Have heard nothing."""
        self.leap_s = leap_s
        self.damaged = 0
        self._has_pvt = False
        self._velocity: tuple[int, tuple[float, float], float] | None = None

    def take(self, data: bytes) -> list[Reading]:
        """Take a whole message; return what it says of an epoch."""
        try:
            message = UBXReader.parse(data, msgmode=GET)
        except (UBXMessageError, UBXParseError, UBXStreamError, UBXTypeError, *PARSER_ERRORS):
            self.damaged += 1
            return []
        try:
            return self._read(message, data[6:-2])
        except (AttributeError, ValueError, OverflowError):
            self.damaged += 1
            return []

    def _read(self, message: Any, payload: bytes) -> list[Reading]:
        if message.identity == SEEN_PVT:
            self._has_pvt = True
            return [_of_pvt(message)]
        if message.identity == "NAV-TIMEGPS" and message.leapSValid:
            self.leap_s = float(message.leapS)
        elif message.identity == "NAV-VELNED":
            sigma = 0.01 * message.sAcc / math.sqrt(2.0)
            tow_ms = int.from_bytes(payload[:4], "little")
            self._velocity = tow_ms, (0.01 * message.velE, 0.01 * message.velN), sigma
        elif message.identity == "NAV-SOL" and not self._has_pvt:
            return [self._of_sol(message, payload)]
        return []

    def _of_sol(self, sol: Any, payload: bytes) -> Reading:
        tow_ms = int.from_bytes(payload[:4], "little")
        gps_s = GPS_EPOCH_S + WEEK_S * sol.week + 1e-3 * tow_ms + 1e-9 * sol.fTOW
        x, y, z = (0.01 * value for value in (sol.ecefX, sol.ecefY, sol.ecefZ))
        latitude, longitude, height = map(float, pymap3d.ecef2geodetic(x, y, z))
        velocity, sigma = None, 0.01 * sol.sAcc / math.sqrt(3.0)
        if self._velocity is not None and self._velocity[0] == tow_ms:
            _, velocity, sigma = self._velocity
        else:
            speeds = (0.01 * value for value in (sol.ecefVX, sol.ecefVY, sol.ecefVZ))
            east, north, _ = pymap3d.ecef2enuv(*speeds, latitude, longitude)
            velocity = float(east), float(north)
        variance = (0.01 * sol.pAcc) ** 2 / 3.0
        valid = bool(sol.gpsfixOK) and sol.gpsFix in FIXES
        return Reading(
            gps_s - self.leap_s,
            latitude,
            longitude,
            height,
            valid,
            variance * np.eye(2),
            velocity if valid else None,
            sigma,
            has_date=bool(sol.wknSet and sol.towSet),
        )


def _of_pvt(pvt: Any) -> Reading:
    """Return what NAV-PVT says; its accuracies are radii that hold 68 %."""
    dated = bool(pvt.validDate and pvt.validTime)
    valid = bool(pvt.gnssFixOk) and pvt.fixType in FIXES and not getattr(pvt, "invalidLlh", 0)
    utc_s = 0.0
    if dated:
        second = min(pvt.second, 59)
        at = datetime(pvt.year, pvt.month, pvt.day, pvt.hour, pvt.min, second, tzinfo=UTC)
        utc_s = at.timestamp() + (pvt.second - second) + 1e-9 * pvt.nano
    variance = 0.5 * (1e-3 * pvt.hAcc) ** 2
    return Reading(
        utc_s,
        float(pvt.lat),
        float(pvt.lon),
        1e-3 * pvt.hMSL,
        valid and dated,
        variance * np.eye(2),
        (1e-3 * pvt.velE, 1e-3 * pvt.velN) if valid else None,
        1e-3 * pvt.sAcc / math.sqrt(2.0),
        has_date=dated,
    )
