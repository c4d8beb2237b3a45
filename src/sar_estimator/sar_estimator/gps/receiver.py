"""A receiver: bytes in, readings out, and what is wrong with it. Pure."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

from sar_estimator.common.geodesy import valid_position
from sar_estimator.gps.framing import Framer, Protocol
from sar_estimator.gps.gpsd import GpsdDecoder
from sar_estimator.gps.nmea import NmeaDecoder
from sar_estimator.gps.reading import Reading
from sar_estimator.gps.ubx import UbxDecoder

SILENT_S = 3.0
NOISE_BYTES = 200
NOISE_SHARE = 0.5
UNREAD = (Protocol.SIRF, Protocol.RTCM)


class Receiver:
    """Finds out what a receiver speaks, and reads it. Times are of a monotonic clock [s].

    UBX is preferred to NMEA where a receiver speaks both: it tells its accuracy.
    """

    def __init__(self, uere_m: float = 5.0) -> None:
        """Have heard nothing. ``uere_m``: see ``NmeaDecoder``."""
        self._framer = Framer()
        self.nmea, self.ubx, self.gpsd = NmeaDecoder(uere_m), UbxDecoder(), GpsdDecoder()
        self.heard: Counter[Protocol] = Counter()
        self._bytes_s = self._frame_s = self._reading_s = self._valid_s = -SILENT_S
        self._noise = self._since_frame = 0
        self._preferred: Protocol | None = None

    def feed(self, data: bytes, now_s: float) -> list[Reading]:
        """Take bytes; return the epochs that they complete, of the preferred protocol."""
        if data:
            self._bytes_s = now_s
        before = self._framer.garbage
        frames = self._framer.feed(data)
        self._noise += self._framer.garbage - before
        self._since_frame += len(data)
        if frames:
            self._frame_s, self._noise, self._since_frame = now_s, 0, 0
        found: list[Reading] = []
        for frame in frames:
            self.heard[frame.protocol] += 1
            if frame.protocol in UNREAD:
                continue
            read = {
                Protocol.NMEA: self.nmea.take,
                Protocol.UBX: self.ubx.take,
                Protocol.GPSD: self.gpsd.take,
            }[frame.protocol](frame.data)
            if read and self._preferred in (None, frame.protocol, Protocol.NMEA):
                self._preferred = frame.protocol
                found += [_checked(reading) for reading in read]
        if found:
            self._reading_s = now_s
        if any(reading.is_valid for reading in found):
            self._valid_s = now_s
        return found

    @property
    def damaged(self) -> int:
        """How many frames were damaged, or of no known shape."""
        inner = self.nmea.damaged + self.ubx.damaged + self.gpsd.damaged
        return inner + sum(self._framer.damaged.values())

    @property
    def garbage(self) -> int:
        """How many bytes belonged to nothing."""
        return self._framer.garbage

    def problem(self, now_s: float) -> str:
        """Return what is wrong, empty when valid fixes come."""
        if now_s - self._bytes_s >= SILENT_S:
            return "receiver silent"
        if now_s - self._valid_s < SILENT_S:
            return ""
        if self._since_frame >= NOISE_BYTES and self._noise >= NOISE_SHARE * self._since_frame:
            return "bytes of no known protocol: is the baud rate right?"
        if now_s - self._reading_s < SILENT_S:
            return "receiver has no fix"
        understood = {Protocol.NMEA, Protocol.UBX, Protocol.GPSD} & set(self.heard)
        if not understood and self.heard:
            names = " and ".join(str(name) for name in self.heard)
            return f"receiver speaks {names}: expected NMEA 0183, UBX or gpsd"
        return "receiver tells no position yet"


def _checked(reading: Reading) -> Reading:
    """Return a reading that is valid only where its numbers can be."""
    possible = valid_position(reading.latitude_deg, reading.longitude_deg)
    possible = possible and math.isfinite(reading.utc_s + reading.altitude_m)
    return reading if possible else replace(reading, is_valid=False, velocity_mps=None)
