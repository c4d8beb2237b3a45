"""Sentences of an epoch are put together, told once and soon, and wrong ones not at all."""

import math
from datetime import date as day

import numpy as np
import pytest

from sar_estimator.gps.nmea import KNOT_MPS, NmeaDecoder


def taken(decoder, *sentences):
    return [one for line in sentences for one in decoder.take(line.rstrip())]


@pytest.fixture
def decoder():
    return NmeaDecoder(5.0)


def test_position_velocity_time_and_accuracy_are_those_of_the_sentences(decoder, make):
    taken(decoder, make["rmc"](), make["gga"](), make["gst"]())
    later = {"time": "10:20:31"}
    (first,) = taken(decoder, make["rmc"](**later))  # the first epoch's size was not known
    assert first.utc_s == 1_795_861_230.0
    (reading,) = taken(decoder, make["gga"](**later), make["gst"](**later))
    assert reading.utc_s == 1_795_861_231.0
    assert reading.has_date
    assert (reading.latitude_deg, reading.longitude_deg) == pytest.approx((37.5, -122.5))
    assert reading.altitude_m == 30.0
    assert reading.velocity_mps == pytest.approx((20.0 * KNOT_MPS, 0.0), abs=1e-6)
    assert np.diag(reading.covariance_m2) == pytest.approx((2.5**2, 1.5**2))


def test_each_epoch_is_told_once_with_its_last_sentence(decoder, make):
    counts = []
    for second in range(30, 36):
        at = {"time": f"10:20:{second}"}
        counts.append([len(taken(decoder, make[kind](**at))) for kind in ("rmc", "gga", "gst")])
    assert counts[0] == [0, 0, 0]
    assert counts[1] == [1, 0, 1]
    assert counts[2:] == [[0, 0, 1]] * 4


def test_a_sentence_that_is_missing_delays_its_epoch_to_the_next(decoder, make):
    for second in (30, 31, 32):
        taken(decoder, *(make[kind](time=f"10:20:{second}") for kind in ("rmc", "gga", "gst")))
    assert taken(decoder, make["rmc"](time="10:20:33"), make["gga"](time="10:20:33")) == []
    (late,) = taken(decoder, make["rmc"](time="10:20:34"))
    assert late.utc_s % 60.0 == 33.0


@pytest.mark.parametrize(
    ("hdop", "sigma_m"), [(1.2, 6.0 / math.sqrt(2.0)), (99.99, None), (0, None)]
)
def test_hdop_is_an_accuracy_where_no_other_is_told(decoder, make, hdop, sigma_m):
    reading, *_ = taken(decoder, make["gga"](), make["gga"](time="10:20:31", hdop=hdop))[1:]
    assert not reading.has_date
    if sigma_m is None:
        assert reading.covariance_m2 is None
    else:
        assert reading.covariance_m2 == pytest.approx(sigma_m**2 * np.eye(2))


@pytest.mark.parametrize(
    ("kind", "changes"),
    [("gga", {"quality": 0}), ("gga", {"quality": 6}), ("rmc", {"status": "V"})],
)
def test_one_sentence_that_says_so_makes_an_epoch_invalid(decoder, make, kind, changes):
    lines = {"rmc": make["rmc"](), "gga": make["gga"]()}
    lines[kind] = make[kind](**changes)
    taken(decoder, *lines.values())
    (reading,) = taken(decoder, make["rmc"](time="10:20:31"))
    assert not reading.is_valid
    assert reading.velocity_mps is None


def test_midnight_takes_the_date_on(decoder, make):
    taken(decoder, make["rmc"](time="23:59:59"), make["gga"](time="23:59:59"))
    taken(decoder, make["gga"](time="00:00:00"))
    (reading,) = taken(decoder, make["rmc"](time="00:00:00", date=day(2026, 11, 29)))
    before = 1_795_861_230.0 - (10 * 3600 + 20 * 60 + 30)
    assert reading.utc_s == before + 86_400.0


def test_a_wrong_check_sum_is_counted_and_tells_nothing(decoder, make):
    line = make["gga"]().replace(b"37", b"38", 1)
    assert taken(decoder, line, line, line) == []
    assert decoder.damaged == 3
    assert taken(decoder, b"$GNGGA,1,2,3\r\n") == []


def test_one_that_stands_has_no_course_and_a_velocity_all_the_same(decoder, make):
    def standing(second):
        line = make["rmc"](time=f"10:20:{second}", spd=0.02, cog="")
        return taken(decoder, line)

    reading = [*standing(30), *standing(31)][-1]
    assert math.hypot(*reading.velocity_mps) == pytest.approx(0.02 * KNOT_MPS)


def test_a_sentence_without_a_time_is_not_waited_for_where_rmc_has_the_velocity(decoder, make):
    """It may come first of the next epoch: an epoch that waits for it is told a second late."""
    vtg = make["sentence"]("VTG", cogt=90.0, sogn=5.0)
    for second in (30, 31):
        at = {"time": f"10:20:{second}"}
        taken(decoder, vtg, make["gga"](**at), make["rmc"](**at))
    at = {"time": "10:20:32"}
    assert len(taken(decoder, vtg, make["gga"](**at), make["rmc"](**at))) == 1
    assert taken(decoder, vtg) == []


def test_without_rmc_the_velocity_is_that_of_vtg(decoder, make):
    vtg = make["sentence"]("VTG", cogt=90.0, cogtUnit="T", sogn=5.0, sognUnit="N")
    found = []
    for second in (30, 31, 32):
        found += taken(decoder, make["gga"](time=f"10:20:{second}"), vtg)
    assert len(found) == 3
    assert found[-1].velocity_mps == pytest.approx((5.0 * KNOT_MPS, 0.0), abs=1e-6)


@pytest.mark.parametrize("kind", ["GGA", "RMC", "VTG", "GST", "GSA"])
@pytest.mark.parametrize("fields", range(8))
def test_a_sentence_that_is_cut_short_and_sound_by_chance_is_damaged(kind, fields):
    """Eight bits of check sum let one in 256 through."""
    body = ",".join([f"GN{kind}", *(["102046", "30", "", "0.0", "0", "1", "2"][:fields])])
    check = 0
    for letter in body.encode():
        check ^= letter
    decoder = NmeaDecoder(5.0)
    for _ in range(3):
        for reading in decoder.take(f"${body}*{check:02X}".encode()):
            assert not reading.is_valid
    assert decoder.damaged <= 3
