"""A receiver's stream of bytes cut into frames, whatever protocols it mixes, and what is none."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from enum import StrEnum
from typing import NamedTuple

from pyrtcm.rtcmhelpers import calc_crc24q
from pyubx2 import calc_checksum

LONGEST_LINE = 200
LONGEST_JSON = 20_000
LONGEST_UBX = 2_048
LONGEST_SIRF = 1_023
NEWLINES = b"\r\n"
PARSER_ERRORS = (ValueError, KeyError, IndexError, TypeError, ArithmeticError, AttributeError)
"""What the parsers' libraries let out, beside their own errors, for frames that are none."""


class Protocol(StrEnum):
    """What a receiver may speak. SiRF and RTCM are told by name, and not understood."""

    NMEA = "NMEA 0183"
    UBX = "UBX"
    GPSD = "gpsd"
    SIRF = "SiRF binary"
    RTCM = "RTCM 3"


class Frame(NamedTuple):
    """One whole message, its check sum right where its frame has one that is checked here."""

    protocol: Protocol
    data: bytes


class Framer:
    """Cuts bytes as they come. Nothing damaged is handed on, and nothing after it is lost.

    ``garbage``: bytes that belong to no frame. ``damaged``: frames that were cut off, or whose
    check sum is wrong, by protocol; of NMEA those cut off only.
    """

    def __init__(self) -> None:
        """Begin with nothing received."""
        self._buffer = bytearray()
        self._cuts: dict[int, Callable[[], tuple[Frame | None, int]]] = {
            ord("$"): self._sentence,
            ord("{"): self._object,
            0xB5: self._ubx,
            0xA0: self._sirf,
            0xD3: self._rtcm,
        }
        self.garbage = 0
        self.damaged: Counter[Protocol] = Counter()

    def feed(self, data: bytes) -> list[Frame]:
        """Take bytes; return the frames that they complete."""
        self._buffer += data
        found = []
        while self._buffer:
            cut = self._cuts.get(self._buffer[0])
            if cut is None:
                self._drop(self._to_next_start())
                continue
            frame, used = cut()
            if used == 0:
                break  # its end has not come yet
            del self._buffer[:used]
            if frame is not None:
                found.append(frame)
        return found

    def _to_next_start(self) -> int:
        """Return how many bytes there are before one that can begin a frame."""
        return next(
            (n for n, byte in enumerate(self._buffer) if byte in self._cuts), len(self._buffer)
        )

    def _drop(self, count: int) -> None:
        self.garbage += sum(byte not in NEWLINES for byte in self._buffer[:count])
        del self._buffer[:count]

    def _not_one(self, protocol: Protocol | None = None) -> tuple[None, int]:
        """Leave out one byte that looked like the beginning of a frame."""
        self.garbage += 1
        if protocol is not None:
            self.damaged[protocol] += 1
        return None, 1

    # Each returns a frame, and how many bytes are done with: 0 while the end has not come. --------

    def _sentence(self) -> tuple[Frame | None, int]:
        end = self._buffer.find(b"\n", 0, LONGEST_LINE)
        line = self._buffer[: end if end >= 0 else LONGEST_LINE]
        for n, byte in enumerate(line[1:], 1):
            # A sentence that was cut off by another, or by bytes that are no text.
            if byte == ord("$") or not (32 <= byte < 127 or byte in NEWLINES):
                self.damaged[Protocol.NMEA] += 1
                self.garbage += n
                return None, n
        if end >= 0:
            return Frame(Protocol.NMEA, bytes(line).rstrip(NEWLINES)), end + 1
        return self._not_one(Protocol.NMEA) if len(line) >= LONGEST_LINE else (None, 0)

    def _object(self) -> tuple[Frame | None, int]:
        end = self._buffer.find(b"\n", 0, LONGEST_JSON)
        if end >= 0:
            return Frame(Protocol.GPSD, bytes(self._buffer[:end]).rstrip(NEWLINES)), end + 1
        return self._not_one(Protocol.GPSD) if len(self._buffer) >= LONGEST_JSON else (None, 0)

    def _ubx(self) -> tuple[Frame | None, int]:
        if self._waits_for(b"\xb5\x62", 6):
            return None, 0
        length = int.from_bytes(self._buffer[4:6], "little")
        if self._buffer[1] != 0x62 or length > LONGEST_UBX:
            return self._not_one()
        whole = bytes(self._buffer[: 8 + length])
        if len(whole) < 8 + length:
            return None, 0
        if calc_checksum(whole[2:-2]) != whole[-2:]:
            return self._not_one(Protocol.UBX)
        return Frame(Protocol.UBX, whole), len(whole)

    def _sirf(self) -> tuple[Frame | None, int]:
        if self._waits_for(b"\xa0\xa2", 4):
            return None, 0
        length = int.from_bytes(self._buffer[2:4], "big")
        if self._buffer[1] != 0xA2 or length > LONGEST_SIRF:
            return self._not_one()
        whole = bytes(self._buffer[: 8 + length])
        if len(whole) < 8 + length:
            return None, 0
        if whole[-2:] != b"\xb0\xb3":
            return self._not_one(Protocol.SIRF)
        return Frame(Protocol.SIRF, whole), len(whole)

    def _rtcm(self) -> tuple[Frame | None, int]:
        if len(self._buffer) < 3:
            return None, 0
        if self._buffer[1] & 0xFC:
            return self._not_one()
        length = int.from_bytes(self._buffer[1:3], "big")
        whole = bytes(self._buffer[: 6 + length])
        if len(whole) < 6 + length:
            return None, 0
        if calc_crc24q(whole) != 0:
            return self._not_one()
        return Frame(Protocol.RTCM, whole), len(whole)

    def _waits_for(self, sync: bytes, header: int) -> bool:
        """Whether what there is may be a frame's header that is not whole yet."""
        there = min(len(self._buffer), len(sync))
        return len(self._buffer) < header and self._buffer[:there] == sync[:there]
