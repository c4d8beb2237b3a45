"""Real receivers' logs, beside what gpsd made of them (its .chk files)."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import pymap3d

from sar_estimator.gps.reading import Reading

ROLLOVER_S = 1024 * 604_800.0
"""Of GPS's ten-bit week counter: old logs' dates are by as much too early, or not."""
Reports = dict[float, list[dict[str, Any]]]


@dataclass(frozen=True, slots=True)
class Comparison:
    """Readings of a log beside gpsd's reports of the same times.

    ``fixes``: valid readings; ``compared``: those that gpsd has a position of. ``worst_deg``,
    ``worst_mps``: the largest differences, of latitude or longitude, and of speed. ``otherwise``:
    how many are valid to one and not to the other. ``problem``: what the receiver is said to be.
    """

    log: str
    fixes: int
    compared: int
    worst_deg: float
    worst_mps: float
    otherwise: int
    problem: str


def log_bytes(log: Path) -> bytes:
    """Return what the receiver sent: a log begins with comments of who recorded it."""
    lines = log.read_bytes().splitlines(keepends=True)
    begin = next((i for i, line in enumerate(lines) if not line.startswith(b"#")), len(lines))
    return b"".join(lines[begin:])


def answers(log: Path) -> Reports:
    """Return gpsd's reports of a log by time; a week counter that rolled over is as it was."""
    found: Reports = {}
    text = log.with_name(f"{log.name}.chk").read_text(errors="replace")
    for line in text.splitlines():
        if line.startswith('{"class":"TPV"') and '"time"' in line:
            report = json.loads(line)
            utc_s = datetime.fromisoformat(report["time"]).timestamp()
            found.setdefault(_key(utc_s), []).append(report)
    return found


def _key(utc_s: float) -> float:
    return round(utc_s % ROLLOVER_S, 2)


def compare(name: str, readings: list[Reading], reports: Reports, problem: str) -> Comparison:
    """Compare every reading with gpsd's reports of its time, the most like of them."""
    compared = otherwise = 0
    worst_deg = worst_mps = 0.0
    for reading in readings:
        same = reports.get(_key(reading.utc_s), [])
        if same and reading.has_date:
            otherwise += reading.is_valid is not any(one["mode"] >= 2 for one in same)
        placed = [one for one in same if "lat" in one]
        if not reading.is_valid or not placed:
            continue
        compared += 1
        worst_deg = max(worst_deg, min(_off_deg(reading, one) for one in placed))
        speeds = [one["speed"] for one in placed if "speed" in one]
        if speeds and reading.velocity_mps is not None:
            speed = math.hypot(*reading.velocity_mps)
            worst_mps = max(worst_mps, min(abs(one - speed) for one in speeds))
    fixes = sum(reading.is_valid for reading in readings)
    return Comparison(name, fixes, compared, worst_deg, worst_mps, otherwise, problem)


def _off_deg(reading: Reading, report: dict[str, Any]) -> float:
    """Return how far a position is off from gpsd's, or the receiver's own where gpsd tells it."""
    places = [(float(report["lat"]), float(report["lon"]))]
    if "ecefx" in report:
        own = pymap3d.ecef2geodetic(report["ecefx"], report["ecefy"], report["ecefz"])
        places.append((float(own[0]), float(own[1])))
    return min(
        max(abs(reading.latitude_deg - latitude), abs(reading.longitude_deg - longitude))
        for latitude, longitude in places
    )
