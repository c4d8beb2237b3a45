"""Recordings with bytes turned: a line that names the file, or a recording; no crash.

``SAR_FUZZ_INPUTS`` inputs, a tenth of them here, seeded.
"""

import os

import numpy as np
import pytest

from sar_sim.trials.recordings import Recording, RecordingError, load_recording

INPUTS = max(200, int(os.environ.get("SAR_FUZZ_INPUTS", "2000")) // 10)
WORDS = (b"nan", b"-1", b"1e999", b"[]", b"{}", b"null", b": ", b"\x00", b"\xff", b'"', b",", b"\r")
FILES = {
    "mine.yaml": b"path: {rule: C, lag_m: 250, straight_m: 108, theta_deg: 72}\n"
    b"corner: {turn_radius_m: 100}\nuav: {l1_period_s: 10}\nwind: {speed_mps: 6, from_deg: 45}\n",
    "mine_waypoints.csv": b"x_m,y_m,on_planned_path\n"
    + b"".join(b"%d.25,-250.5,1\n" % (100 * i) for i in range(20)),
    "mine_track.csv": b"t_s,x_m,y_m,course_rad,groundspeed_mps\n"
    + b"".join(b"%d.125,%d.5,-250.5,0.0125,20.25\n" % (10 * i, 200 * i) for i in range(20)),
}


def turned(rng, data):
    data = bytearray(data)
    for _ in range(rng.integers(1, 4)):
        at, word = int(rng.integers(len(data))), WORDS[rng.integers(len(WORDS))]
        kind = rng.integers(3)
        if kind == 0:
            data[at] = int(rng.integers(256))
        elif kind == 1:
            del data[at : at + int(rng.integers(1, 20))]
        else:
            data[at:at] = word
        if not data:
            return b" "
    return bytes(data)


@pytest.mark.parametrize("name", FILES)
def test_recordings_with_bytes_turned(name, tmp_path):
    rng = np.random.default_rng(8)
    for other, data in FILES.items():
        (tmp_path / other).write_bytes(data)
    refused = 0
    for _ in range(INPUTS):
        (tmp_path / name).write_bytes(turned(rng, FILES[name]))
        try:
            assert isinstance(load_recording(tmp_path, "mine"), Recording)
        except RecordingError as error:
            refused += 1
            told = str(error)
            assert "\n" not in told
            assert told.startswith(str(tmp_path / name))
    assert 0 < refused < INPUTS
