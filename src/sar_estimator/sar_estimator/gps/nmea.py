"""NMEA 0183: sentences of an epoch put together (GGA, RMC, VTG, GST, GSA), by pynmeagps."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from datetime import UTC, date, datetime, time
from typing import Any

import numpy as np
from pynmeagps import NMEAReader
from pynmeagps.exceptions import NMEAMessageError, NMEAParseError, NMEATypeError

from sar_estimator.common.states import FloatArray
from sar_estimator.gps.framing import PARSER_ERRORS
from sar_estimator.gps.reading import Reading

KNOT_MPS = 1852.0 / 3600.0
"""A knot [m/s] (ISO 80000-3)."""
WANTED = {
    "GGA": ("time", "lat", "lon", "quality", "HDOP", "alt"),
    "RMC": ("time", "status", "lat", "lon", "spd", "cog", "date"),
    "VTG": ("cogt", "sogn"),
    "GST": ("time", "stdLat", "stdLong"),
    "GSA": ("HDOP",),
}
"""The sentences that are read, and what is read of them."""
ESTIMATED = 6
"""The quality of GGA of a position that is dead reckoning."""
HALF_DAY_S = 43_200.0
DAY_S = 86_400.0


@dataclass
class _Epoch:
    """What has come of an epoch: sentences by name, the newest of each; how many in all."""

    time_s: float
    sentences: dict[str, Any] = field(default_factory=dict)
    count: int = 0


class NmeaDecoder:
    """Puts sentences together that have the same time, and tells each epoch once.

    As soon as as many sentences with a time have come as in the epoch before; else when the next
    one begins.
    ``uere_m``: the standard deviation of a range, by which HDOP becomes an accuracy. ``damaged``:
    sentences whose check sum is wrong, or that are no sentences.
    """

    def __init__(self, uere_m: float) -> None:
        """Know no epoch."""
        self._uere_m = uere_m
        self._epoch: _Epoch | None = None
        self._expected = 0
        self._is_told = self._has_rmc = False
        self._date: date | None = None
        self._date_time_s = 0.0
        self.damaged = 0

    def take(self, sentence: bytes) -> list[Reading]:
        """Take a sentence; return the epochs that it completes."""
        try:
            message = NMEAReader.parse(sentence + b"\r\n", msgmode=0)
        except (NMEAMessageError, NMEAParseError, NMEATypeError, *PARSER_ERRORS):
            self.damaged += 1
            return []
        if message is None or message.msgID not in WANTED or "*" not in sentence.decode("ascii"):
            return []
        if not all(hasattr(message, name) for name in WANTED[message.msgID]):
            self.damaged += 1  # cut short, and its eight bits of check sum right by chance
            return []
        found: list[Reading] = []
        at = getattr(message, "time", None)
        if isinstance(at, time):
            time_s = _seconds(at)
            if self._epoch is None or time_s != self._epoch.time_s:
                found += self._ended()
                self._epoch = _Epoch(time_s)
                self._is_told = False
        if self._epoch is None:
            return found
        self._epoch.sentences[message.msgID] = self._better(message)
        self._has_rmc = self._has_rmc or message.msgID == "RMC"
        # One without a time may be the next epoch's: it is not waited for, but for a velocity that
        # nothing else tells.
        if isinstance(at, time) or (message.msgID == "VTG" and not self._has_rmc):
            self._epoch.count += 1
            if self._epoch.count == self._expected:
                found += self._told()
        return found

    def _better(self, message: Any) -> Any:
        """Return the sentence to believe of two of a kind: a constellation's own comes second."""
        assert self._epoch is not None
        before = self._epoch.sentences.get(message.msgID)
        return message if before is None or message.talker in ("GN", "GP") else before

    def _ended(self) -> list[Reading]:
        """Tell the epoch that another one ends, if it was not told."""
        if self._epoch is None:
            return []
        self._expected = self._epoch.count
        return self._told()

    def _told(self) -> list[Reading]:
        epoch = self._epoch
        if epoch is None or self._is_told:
            return []
        self._is_told = True
        gga, rmc = epoch.sentences.get("GGA"), epoch.sentences.get("RMC")
        if rmc is not None and isinstance(rmc.date, date):
            self._date, self._date_time_s = rmc.date, epoch.time_s
        best = gga or rmc
        if best is None:
            return []
        valid = (gga is None or _is_position(gga)) and (rmc is None or _is_valid(rmc))
        latitude, longitude = _number(best.lat), _number(best.lon)
        valid = valid and math.isfinite(latitude) and math.isfinite(longitude)
        utc_s = self._utc_s(epoch.time_s)
        return [
            Reading(
                epoch.time_s if utc_s is None else utc_s,
                latitude,
                longitude,
                0.0 if gga is None else _number(gga.alt, 0.0),
                valid,
                self._covariance(epoch),
                _velocity(rmc, epoch.sentences.get("VTG")) if valid else None,
                has_date=utc_s is not None,
            )
        ]

    def _utc_s(self, time_s: float) -> float | None:
        """Return the time since 1970 of one of the day, by the newest date; None before any."""
        if self._date is None:
            return None
        day = datetime(self._date.year, self._date.month, self._date.day, tzinfo=UTC)
        after = DAY_S if self._date_time_s - time_s > HALF_DAY_S else 0.0
        return day.timestamp() + time_s + after

    def _covariance(self, epoch: _Epoch) -> FloatArray | None:
        gst = epoch.sentences.get("GST")
        if gst is not None:
            north, east = _number(gst.stdLat), _number(gst.stdLong)
            if north > 0.0 and east > 0.0:
                return np.diag((east**2, north**2))
        for name in ("GGA", "GSA"):
            sentence = epoch.sentences.get(name)
            hdop = math.nan if sentence is None else _number(sentence.HDOP)
            if 0.0 < hdop < 99.0:  # 99.99 stands for none
                return 0.5 * (hdop * self._uere_m) ** 2 * np.eye(2)
        return None


def _seconds(at: time) -> float:
    return 3600.0 * at.hour + 60.0 * at.minute + at.second + 1e-6 * at.microsecond


def _number(value: object, otherwise: float = math.nan) -> float:
    return float(value) if isinstance(value, int | float) else otherwise


def _is_position(gga: Any) -> bool:
    return isinstance(gga.quality, int) and gga.quality > 0 and gga.quality != ESTIMATED


def _is_valid(rmc: Any) -> bool:
    return bool(rmc.status == "A" and getattr(rmc, "posMode", "A") not in ("N", "E"))


def _velocity(rmc: Any, vtg: Any) -> tuple[float, float] | None:
    """Return the velocity east and north [m/s], None where there is none."""
    speed = course = math.nan
    if rmc is not None:
        speed, course = KNOT_MPS * _number(rmc.spd), _number(rmc.cog)
    if vtg is not None and not math.isfinite(speed):
        speed, course = KNOT_MPS * _number(vtg.sogn), _number(vtg.cogt)
    if math.isfinite(speed) and not math.isfinite(course) and speed < SLOW_MPS:
        course = 0.0  # receivers leave the course of one that stands out
    if not (math.isfinite(speed) and math.isfinite(course)):
        return None
    return speed * math.sin(math.radians(course)), speed * math.cos(math.radians(course))


SLOW_MPS = 1.0
