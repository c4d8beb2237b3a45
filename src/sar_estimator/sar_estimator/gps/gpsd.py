"""gpsd's JSON: TPV reports."""

from __future__ import annotations

import json
import math
from datetime import datetime
from typing import Any

import numpy as np

from sar_estimator.gps.reading import Reading

WATCH = b'?WATCH={"enable":true,"json":true};\n'
"""What is sent to gpsd to hear its reports."""
CONFIDENCE = 1.96
"""Of gpsd's error estimates, 95 %, in standard deviations."""


class GpsdDecoder:
    """Reads reports; others than TPV do not matter.

    ``damaged``: lines that are no such objects.
    """

    def __init__(self) -> None:
        """Have heard nothing."""
        self.damaged = 0

    def take(self, line: bytes) -> list[Reading]:
        """Take a line; return what it says of an epoch."""
        try:
            report = json.loads(line)
            kind = report["class"]
            return [_of_tpv(report)] if kind == "TPV" and "time" in report else []
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
            self.damaged += 1
            return []


def _of_tpv(report: dict[str, Any]) -> Reading:
    def number(name: str, otherwise: float = math.nan) -> float:
        value = report.get(name, otherwise)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise TypeError(f"{name} = {value!r}")
        return float(value)

    utc_s = datetime.fromisoformat(str(report["time"])).timestamp()
    latitude, longitude = number("lat"), number("lon")
    valid = number("mode", 0.0) >= 2.0 and math.isfinite(latitude + longitude)
    speed, course = number("speed"), math.radians(number("track", 0.0))
    velocity = (speed * math.sin(course), speed * math.cos(course))
    east, north = number("epx") / CONFIDENCE, number("epy") / CONFIDENCE
    sigma = number("eps") / CONFIDENCE
    return Reading(
        utc_s,
        latitude,
        longitude,
        number("altMSL", number("alt", 0.0)),
        valid,
        np.diag((east**2, north**2)) if east > 0.0 and north > 0.0 else None,
        velocity if valid and math.isfinite(speed) else None,
        sigma if math.isfinite(sigma) else None,
    )
