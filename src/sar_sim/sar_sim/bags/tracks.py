"""Recorded helicopter tracks: CSV files and bags."""

from __future__ import annotations

from pathlib import Path

from sar_estimator.bags.bag import BAG_ERRORS, read_messages
from sar_estimator.common import topics
from sar_estimator.common.conversions import message_to_fix
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.track_csv import read_track


def load_track(path: Path) -> list[Fix]:
    """Read the fixes of a CSV file or of a bag. Raises ``ValueError`` when there are none."""
    if not path.exists():
        raise ValueError(f"{path}: no such file or bag")
    if path.suffix == ".csv":
        return read_track(path)
    try:
        fixes = [message_to_fix(message) for _, _, message in read_messages(path, {topics.FIX})]
    except BAG_ERRORS as error:
        raise ValueError(f"{path}: not a bag: {error}") from error
    if not fixes:
        raise ValueError(f"{path}: no messages on {topics.FIX}")
    return fixes
