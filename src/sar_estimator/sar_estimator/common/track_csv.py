"""Tracks as CSV: time_s, latitude_deg, longitude_deg; altitude_m, groundspeed_mps, track_deg."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path

from sar_estimator.common.gps_fix import Fix

REQUIRED = ("time_s", "latitude_deg", "longitude_deg")


def read_track(path: Path) -> list[Fix]:
    """Read every row as a fix; empty cells become NaN, so that no row is lost.

    Raises ``ValueError`` naming file, line and column for a missing column or a cell that is not a
    number, and for a file without rows.
    """
    fixes = []
    for line, row in _rows(path):
        time, latitude, longitude = (_number(path, line, name, row[name]) for name in REQUIRED)
        altitude = _number(path, line, "altitude_m", row.get("altitude_m") or "0")
        fixes.append(Fix(time, latitude, longitude, altitude))
    return fixes


def read_velocities(path: Path) -> list[tuple[float, float]]:
    """Read every row's velocity east and north [m/s], NaN where it has none.

    Raises ``ValueError`` as ``read_track`` does.
    """
    found = []
    for line, row in _rows(path):
        speed, course = (
            _number(path, line, name, row.get(name)) for name in ("groundspeed_mps", "track_deg")
        )
        course = math.radians(course)
        found.append((speed * math.sin(course), speed * math.cos(course)))
    return found


def _rows(path: Path) -> Iterator[tuple[int, dict[str, str]]]:
    """Hand on every row, with its line in the file; ``ValueError`` for a file that is no track."""
    with path.open(newline="", encoding="utf-8") as stream:
        reader = csv.DictReader(stream)
        names = reader.fieldnames or []
        missing = [name for name in REQUIRED if name not in names]
        if missing:
            raise ValueError(f"{path}: no column {missing[0]}: expected {', '.join(REQUIRED)}")
        row = None
        for row in reader:
            yield reader.line_num, row
        if row is None:
            raise ValueError(f"{path}: no rows: expected at least one fix")


def _number(path: Path, line: int, name: str, text: str | None) -> float:
    if text is None or not text.strip():
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"{path}:{line}: {name} = {text!r}: expected a number") from None
