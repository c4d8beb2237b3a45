"""The helicopter's ADS-B position, as the UAV's receiver hears it. Pure."""

from __future__ import annotations

import re

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_estimator.common.geodesy import Datum, valid_position
from sar_estimator.common.reports import Target

ADDRESS = re.compile(r"[0-9A-Fa-f]{6}")


class Transponder:
    """Picks one aircraft's positions out of what is heard; ``icao`` empty: nobody's.

    Raises ``ValueError`` for an address that is none.
    """

    def __init__(self, icao: str) -> None:
        """Listen for an ICAO address, six hexadecimal digits."""
        if icao and not ADDRESS.fullmatch(icao):
            raise ValueError(f"parameter helicopter_icao = {icao!r}: expected 6 hexadecimal digits")
        self._icao = int(icao, 16) if icao else -1

    def heard(
        self, message: mavlink.MAVLink_message, ros_s: float, datum: Datum | None
    ) -> Target | None:
        """Return where the helicopter was heard to be, None for any other message."""
        if message.get_type() != "ADSB_VEHICLE" or message.ICAO_address != self._icao:
            return None
        latitude, longitude = message.lat / 1e7, message.lon / 1e7
        sure = message.flags & mavlink.ADSB_FLAGS_VALID_COORDS
        if datum is None or not sure or not valid_position(latitude, longitude):
            return None
        east, north, _ = datum.to_local(latitude, longitude)
        return Target(ros_s - message.tslc, east, north)
