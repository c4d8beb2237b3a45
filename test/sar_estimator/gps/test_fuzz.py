"""Receivers nobody expects: nothing crashes, and no fix is told that no receiver gave.

``SAR_FUZZ_INPUTS`` inputs, seeded.
"""

import math
import os

import numpy as np

from sar_estimator.common import topics
from sar_estimator.gps.component import GpsComponent

INPUTS = int(os.environ.get("SAR_FUZZ_INPUTS", "4000"))
TPV = b'{"class":"TPV","mode":3,"time":"2026-11-28T10:20:%02dZ","lat":37.5,"lon":-122.5}\n'


def damaged(rng, data):
    """Return bytes with a byte turned, some left out, some put in, or the end cut off."""
    data = bytearray(data)
    kind, at = int(rng.integers(6)), int(rng.integers(len(data)))
    if kind == 0:
        data[at] ^= 1 << int(rng.integers(8))
    elif kind == 1:
        del data[at : at + int(rng.integers(1, 9))]
    elif kind == 2:
        data[at:at] = rng.bytes(int(rng.integers(1, 20)))
    elif kind == 3:
        del data[at:]
    elif kind == 4:
        data[at:at] = data[: int(rng.integers(1, 40))]
    return bytes(data)


def test_damaged_streams_tell_no_wrong_fix(make):
    rng = np.random.default_rng(24)
    told = 0
    for i in range(INPUTS):
        second = i % 60
        if second == 0:
            component = GpsComponent()
        component.ros_s = 1.8e9 + second
        at = {"time": f"10:20:{second:02d}"}
        good = [make["pvt"](second=second), *(make[kind](**at) for kind in ("gga", "rmc", "gst"))]
        good.append(TPV % second)
        data = damaged(rng, good[int(rng.integers(len(good)))])
        cut = int(rng.integers(len(data) + 1))
        for part in (data[:cut], data[cut:]):
            for topic, value in component.receive(part, float(i)):
                if topic == topics.FIX and value.has_fix:
                    told += 1
                    # A bit of NMEA or JSON text that is turned may still be a sentence: eight bits
                    # of check sum, or none at all, are all that there is.
                    assert math.isfinite(value.time_s)
                    assert abs(value.latitude_deg) <= 90.0
                    assert abs(value.longitude_deg) <= 180.0
        component.health(float(i))
    assert told > INPUTS // 40


def test_random_bytes_tell_nothing():
    rng = np.random.default_rng(25)
    component = GpsComponent()
    for i in range(INPUTS // 10):
        component.ros_s = float(i)
        assert component.receive(rng.bytes(100), float(i)) == []
        assert component.health(float(i)).severe
