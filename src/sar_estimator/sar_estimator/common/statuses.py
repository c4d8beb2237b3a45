"""Values as ``diagnostic_msgs/DiagnosticStatus``: keys and texts, and back.

Inner mappings and lists have dotted keys, ``corner.speed_mps``, ``faults.0.kind``. A value that is
not set has no key.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, is_dataclass
from enum import IntEnum
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

HARDWARE = "sar_formation"
DEEPEST = 8
"""How many mappings a key may be within; further dots belong to the name."""


class Level(IntEnum):
    """The levels of ``DiagnosticStatus``."""

    OK = 0
    WARN = 1
    ERROR = 2


def level_of(status: Any) -> Level:
    """Return a status's level: an octet, which is bytes in rclpy, and a number in rosbags.

    One that is none, as STALE, is an error.
    """
    level = status.level if isinstance(status.level, int) else status.level[0]
    return Level(level) if level in (0, 1) else Level.ERROR


def to_status(
    name: str, values: object, *, level: Level = Level.OK, message: str = "ok"
) -> DiagnosticStatus:
    """Return a dataclass, a named tuple or a mapping as a status."""
    return DiagnosticStatus(
        level=bytes([level]),
        name=name,
        message=message,
        hardware_id=HARDWARE,
        values=[KeyValue(key=key, value=text) for key, text in _flat(values)],
    )


def values_of(status: Any) -> dict[str, Any]:
    """Return a status's values as texts by key; dotted keys as mappings and lists in each other.

    Raises ``ValueError`` for a key that is both a value and a mapping.
    """
    found: dict[str, Any] = {}
    for item in status.values:
        *path, last = item.key.split(".", DEEPEST)
        inside = found
        for part in path:
            inside = inside.setdefault(part, {})
            if isinstance(inside, str):
                text = f"{item.key} = {item.value!r}: expected no value beside it at {part}"
                raise ValueError(text)  # noqa: TRY004 - of what was received, not of a type
        if isinstance(inside.get(last), dict):
            text = f"{item.key} = {item.value!r}: expected no value beside those in it"
            raise ValueError(text)  # noqa: TRY004 - likewise
        inside[last] = item.value
    return {key: _with_lists(value) for key, value in found.items()}


def _flat(value: object, key: str = "") -> Iterator[tuple[str, str]]:
    """Yield keys and texts."""
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    elif hasattr(value, "_asdict"):
        value = value._asdict()
    elif isinstance(value, list | tuple):
        value = dict(enumerate(value))
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _flat(inner, f"{key}.{name}" if key else str(name))
    elif isinstance(value, bool):
        yield key, "true" if value else "false"
    elif value is not None:
        yield key, str(value)


def _with_lists(value: Any) -> Any:
    """Return a mapping of 0, 1, ... as a list."""
    if not isinstance(value, dict):
        return value
    inner = {key: _with_lists(item) for key, item in value.items()}
    if inner and list(inner) == [str(n) for n in range(len(inner))]:
        return list(inner.values())
    return inner
