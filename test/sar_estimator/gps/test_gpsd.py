"""gpsd's reports."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.gps.gpsd import GpsdDecoder

TPV = {
    "class": "TPV", "mode": 3, "time": "2026-11-28T10:20:30.250Z", "lat": 37.5, "lon": -122.5,
    "altMSL": 30.0, "speed": 5.0, "track": 90.0, "epx": 1.96, "epy": 3.92, "eps": 0.98,
}  # fmt: skip


def read(**changes):
    report = {key: value for key, value in {**TPV, **changes}.items() if value is not None}
    return GpsdDecoder().take(json.dumps(report).encode())


def test_a_report_is_an_epoch_and_its_errors_are_95_percent():
    (reading,) = read()
    assert reading.utc_s == 1_795_861_230.25
    assert reading.velocity_mps == pytest.approx((5.0, 0.0), abs=1e-9)
    assert np.diag(reading.covariance_m2) == pytest.approx((1.0, 4.0))
    assert reading.velocity_sigma_mps == pytest.approx(0.5)
    assert reading.is_valid


@pytest.mark.parametrize("changes", [{"mode": 1}, {"mode": 0}, {"lat": None}])
def test_without_a_fix_it_is_invalid(changes):
    (reading,) = read(**changes)
    assert not reading.is_valid
    assert reading.velocity_mps is None


def test_what_is_not_told_is_not_known():
    (reading,) = read(epx=None, eps=None, speed=None, altMSL=None, alt=12.0)
    assert reading.covariance_m2 is None
    assert reading.velocity_mps is None
    assert reading.velocity_sigma_mps is None
    assert reading.altitude_m == 12.0


@pytest.mark.parametrize("report", [{"class": "SKY"}, {"class": "TPV", "mode": 1}])
def test_other_reports_do_not_matter(report):
    decoder = GpsdDecoder()
    assert decoder.take(json.dumps(report).encode()) == []
    assert decoder.damaged == 0


@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(max_size=5) | st.just("TPV"),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(st.sampled_from([*TPV, "x"]), inner, max_size=6)
        ),
        max_leaves=12,
    )
)
def test_any_line_is_read_or_counted(value):
    decoder = GpsdDecoder()
    for reading in decoder.take(json.dumps(value).encode()):
        assert math.isfinite(reading.utc_s)
        assert not reading.is_valid or math.isfinite(reading.latitude_deg + reading.longitude_deg)
