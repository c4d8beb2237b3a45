"""Real receivers' logs against gpsd's own answers (recorded data, beside this repository)."""

import os
from pathlib import Path

import numpy as np
import pytest

from sar_estimator.gps.framing import Protocol
from sar_estimator.gps.receiver import Receiver
from sar_sim.trials.receiver_logs import answers, compare, log_bytes

ROOT = Path(__file__).parents[3]
DATA = Path(os.environ.get("SAR_TEST_DATA", ROOT.parent / "shared" / "data"), "gps")
# How many fixes are compared.
UNDERSTOOD = {
    "haicom-305N": 67, "mtk-3301": 3, "sirfstarv-nmea": 59, "telit-he910": 187, "ublox-8": 72,
    "ublox-lea-4t": 2, "ublox-neo-m8n": 24, "ublox-zed-f9p-nmea": 29,
}  # fmt: skip

pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason=f"no recorded receivers in {DATA}")


def readings(name, size=37):
    """Return a log's readings."""
    data = log_bytes(DATA / f"{name}.log")
    receiver, found = Receiver(), []
    for i in range(0, len(data), size):
        found += receiver.feed(data[i : i + size], i / 1000.0)
    return receiver, found, len(data) / 1000.0


@pytest.mark.parametrize("name", UNDERSTOOD)
def test_every_fix_is_gpsds_own(name):
    _, found, _ = readings(name)
    compared = compare(name, found, answers(DATA / f"{name}.log"), "")
    assert compared.compared == UNDERSTOOD[name]
    assert compared.otherwise == 0
    assert compared.worst_deg < 1e-6
    assert compared.worst_mps < 0.05
    for reading in found:
        if reading.is_valid:
            assert (np.linalg.eigvalsh(reading.covariance_m2) > 0.0).all()


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
