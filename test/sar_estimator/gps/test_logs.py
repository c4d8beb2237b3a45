"""Real receivers' logs against gpsd's own answers (recorded data, beside this repository)."""

import json
import math
import os
from datetime import datetime
from pathlib import Path

import numpy as np
import pymap3d
import pytest

from sar_estimator.gps.framing import Protocol
from sar_estimator.gps.receiver import Receiver

ROOT = Path(__file__).parents[3]
DATA = Path(os.environ.get("SAR_TEST_DATA", ROOT.parent / "shared" / "data"), "gps")
ROLLOVER_S = 1024 * 604_800.0
# How many fixes are compared.
UNDERSTOOD = {
    "haicom-305N": 67, "mtk-3301": 3, "sirfstarv-nmea": 59, "telit-he910": 187, "ublox-8": 72,
    "ublox-lea-4t": 2, "ublox-neo-m8n": 24, "ublox-zed-f9p-nmea": 29,
}  # fmt: skip

pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason=f"no recorded receivers in {DATA}")


def answers(name):
    """Return gpsd's reports of a log by time; a week counter that rolled over is as it was."""
    found = {}
    for line in (DATA / f"{name}.log.chk").read_text(errors="replace").splitlines():
        if line.startswith('{"class":"TPV"') and '"time"' in line:
            report = json.loads(line)
            utc_s = datetime.fromisoformat(report["time"]).timestamp()
            found.setdefault(round(utc_s % ROLLOVER_S, 2), []).append(report)
    return found


def readings(name, size=37):
    """Return a log's readings; its comments are no bytes of a receiver."""
    lines = (DATA / f"{name}.log").read_bytes().splitlines(keepends=True)
    begin = next(i for i, line in enumerate(lines) if not line.startswith(b"#"))
    data = b"".join(lines[begin:])
    receiver, found = Receiver(), []
    for i in range(0, len(data), size):
        found += receiver.feed(data[i : i + size], i / 1000.0)
    return receiver, found, len(data) / 1000.0


def is_at(reading, report):
    """Whether a position is the report's; of one that gives its own solution, that."""
    if "ecefx" in report:
        ours = pymap3d.geodetic2ecef(reading.latitude_deg, reading.longitude_deg, 0.0)
        theirs = (report["ecefx"], report["ecefy"], report["ecefz"])
        lat, lon, _ = pymap3d.ecef2geodetic(*theirs)
        flat = pymap3d.geodetic2ecef(lat, lon, 0.0)
        return math.dist(ours, flat) < 0.1
    return (
        abs(reading.latitude_deg - report["lat"]) < 1e-6
        and abs(reading.longitude_deg - report["lon"]) < 1e-6
    )


@pytest.mark.parametrize("name", UNDERSTOOD)
def test_every_fix_is_gpsds_own(name):
    _, found, _ = readings(name)
    theirs = answers(name)
    compared = 0
    for reading in found:
        reports = theirs.get(round(reading.utc_s % ROLLOVER_S, 2), [])
        if reports and reading.has_date:
            assert reading.is_valid == any(report["mode"] >= 2 for report in reports)
        placed = [report for report in reports if "lat" in report]
        if not reading.is_valid or not placed:
            continue
        assert any(is_at(reading, report) for report in placed)
        speeds = [report["speed"] for report in placed if "speed" in report]
        if speeds and reading.velocity_mps is not None:
            speed = math.hypot(*reading.velocity_mps)
            assert min(abs(one - speed) for one in speeds) < 0.05
        assert reading.covariance_m2 is not None
        assert (np.linalg.eigvalsh(reading.covariance_m2) > 0.0).all()
        compared += 1
    assert compared == UNDERSTOOD[name]


@pytest.mark.parametrize("name", ["ublox-8", "ublox-neo-m8n"])
@pytest.mark.parametrize("size", [1, 5, 4096])
def test_however_the_bytes_come(name, size):
    assert [r.utc_s for r in readings(name, size)[1]] == [r.utc_s for r in readings(name)[1]]


@pytest.mark.parametrize("name", ["bu303-moving", "bu303-nofix"])
def test_another_protocol_is_named(name):
    receiver, found, end_s = readings(name)
    assert found == []
    assert receiver.heard[Protocol.SIRF] > 40
    assert receiver.problem(end_s) == (
        "receiver speaks SiRF binary: expected NMEA 0183, UBX or gpsd"
    )
