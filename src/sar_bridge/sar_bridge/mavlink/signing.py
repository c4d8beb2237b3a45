"""MAVLink 2 signing: a key from a file, timestamps that never go back, forgeries without effect.

https://mavlink.io/en/guide/message_signing.html. Timestamps count 10 us since 1 January 2015.
"""

from __future__ import annotations

import hashlib
import hmac
import stat
from pathlib import Path
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

KEY_BYTES = 32
EPOCH_S = 1_420_070_400
TICKS_PER_S = 100_000
SAVE_PERIOD_TICKS = 10 * TICKS_PER_S
RESTART_MARGIN_TICKS = 60 * TICKS_PER_S
OTHERS_MAY = stat.S_IRWXG | stat.S_IRWXO


def read_key(path: Path) -> bytes:
    """Return a key of 32 bytes from a file that only its owner may read: raw, or 64 hex digits.

    Raises ``ValueError`` naming the file and what was expected, never its content.
    """
    try:
        mode = stat.S_IMODE(path.stat().st_mode)
        data = path.read_bytes()
    except OSError as error:
        raise ValueError(f"signing key {path}: {error.strerror}") from error
    if mode & OTHERS_MAY:
        raise ValueError(f"signing key {path}: mode {mode:o}, expected 600: for its owner only")
    if len(data) == KEY_BYTES:
        return data
    try:
        key = bytes.fromhex(data.decode("ascii").strip())
    except ValueError:
        key = b""
    if len(key) != KEY_BYTES:
        raise ValueError(
            f"signing key {path}: {len(data)} bytes, expected {KEY_BYTES}, or {2 * KEY_BYTES} hex "
            "digits"
        )
    return key


class VerifyingParser(mavlink.MAVLink):  # type: ignore[misc]
    """A parser that believes nothing of a packet before its signature is verified.

    pymavlink stores a stream's timestamp first: one forged packet from the future would lock the
    real autopilot out.
    """

    forgeries = 0

    def check_signature(self, msgbuf: bytearray, srcSystem: int, srcComponent: int) -> bool:  # noqa: N803
        """Return whether a packet is signed with the key, and newer than the last of its stream."""
        digest = hashlib.sha256(self.signing.secret_key + bytes(msgbuf[:-6])).digest()[:6]
        if not hmac.compare_digest(digest, bytes(msgbuf[-6:])):
            self.forgeries += 1
            return False
        return bool(super().check_signature(msgbuf, srcSystem, srcComponent))


class Signer:
    """Signs what is sent and says what may be received, over the life of a link and beyond.

    The newest timestamp is kept in a file beside the key: neither a restart nor a clock that was
    set back makes it go back.
    """

    def __init__(self, key_file: Path | str, wall_s: float) -> None:
        """Read the key; ``wall_s``: the time since 1970. Raises ``ValueError`` for a bad key."""
        key_file = Path(key_file)
        self.state = mavlink.MAVLinkSigning()
        self.state.secret_key = read_key(key_file)
        self.state.sign_outgoing = True
        self.state.allow_unsigned_callback = _may_be_unsigned
        self._file = key_file.with_name(key_file.name + ".timestamp")
        self._saved = self._load()
        self.advance(wall_s)

    def _load(self) -> int:
        try:
            saved = int(self._file.read_text("ascii"))
        except (OSError, ValueError):
            return 0
        self.state.timestamp = saved + RESTART_MARGIN_TICKS
        return saved

    def advance(self, wall_s: float) -> None:
        """Let the timestamp go on with time, and save it now and then."""
        now = round((wall_s - EPOCH_S) * TICKS_PER_S)
        self.state.timestamp = max(self.state.timestamp, now)
        if self.state.timestamp - self._saved > SAVE_PERIOD_TICKS:
            self._saved = self.state.timestamp
            part = self._file.with_name(self._file.name + ".part")
            part.write_text(str(self._saved), "ascii")
            part.replace(self._file)


def _may_be_unsigned(_parser: Any, number: int) -> bool:
    """Telemetry radios speak of themselves and cannot sign."""
    return number == mavlink.MAVLINK_MSG_ID_RADIO_STATUS
