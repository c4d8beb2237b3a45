"""u-blox's solutions: NAV-PVT, and NAV-SOL with NAV-VELNED where there is none."""

import math

import numpy as np
import pymap3d
import pytest
from pyubx2 import GET, UBXMessage

from sar_estimator.gps.ubx import UbxDecoder


def test_a_pvt_is_an_epoch(make):
    (reading,) = UbxDecoder().take(make["pvt"]())
    assert reading.utc_s == 1_795_861_230.25
    assert (reading.latitude_deg, reading.longitude_deg) == pytest.approx((37.5, -122.5))
    assert reading.altitude_m == 30.0
    assert reading.velocity_mps == (3.0, -4.0)
    assert reading.velocity_sigma_mps == pytest.approx(0.1 / math.sqrt(2.0))
    assert reading.covariance_m2 == pytest.approx(0.5 * 1.2**2 * np.eye(2))
    assert reading.is_valid


@pytest.mark.parametrize("changes", [{"ok": 0}, {"fix": 0}, {"fix": 1}, {"fix": 5}, {"dated": 0}])
def test_what_is_no_fix_with_a_date_is_invalid(make, changes):
    (reading,) = UbxDecoder().take(make["pvt"](**changes))
    assert not reading.is_valid


def test_a_leap_second_is_one_more(make):
    (reading,) = UbxDecoder().take(make["pvt"](second=60))
    assert reading.utc_s == 1_795_861_260.25


def sol(tow_ms=207_348_000, week=2402, ok=1, fix=3):
    x, y, z = pymap3d.geodetic2ecef(37.5, -122.5, 30.0)
    return UBXMessage(
        "NAV", "NAV-SOL", GET,
        iTOW=tow_ms, fTOW=0, week=week, gpsFix=fix, gpsfixOK=ok, wknSet=1, towSet=1,
        ecefX=round(100 * x), ecefY=round(100 * y), ecefZ=round(100 * z), pAcc=300,
        ecefVX=0, ecefVY=0, ecefVZ=0, sAcc=20,
    ).serialize()  # fmt: skip


def test_a_receiver_without_pvt_is_read_by_its_older_messages():
    decoder = UbxDecoder()
    decoder.take(
        UBXMessage(
            "NAV",
            "NAV-TIMEGPS",
            GET,
            iTOW=207_348_000,
            fTOW=0,
            week=2402,
            leapS=18,
            towValid=1,
            weekValid=1,
            leapSValid=1,
        ).serialize()
    )
    decoder.take(
        UBXMessage(
            "NAV",
            "NAV-VELNED",
            GET,
            iTOW=207_348_000,
            velN=-400,
            velE=300,
            velD=0,
            speed=500,
            gSpeed=500,
            heading=0,
            sAcc=20,
            cAcc=0,
        ).serialize()
    )
    (reading,) = decoder.take(sol())
    assert (reading.latitude_deg, reading.longitude_deg) == pytest.approx((37.5, -122.5), abs=1e-7)
    assert reading.altitude_m == pytest.approx(30.0, abs=0.02)
    assert reading.velocity_mps == (3.0, -4.0)
    assert reading.utc_s == 315_964_800 + 2402 * 604_800 + 207_348 - 18
    (other,) = decoder.take(sol(tow_ms=207_349_000))
    assert other.velocity_mps == pytest.approx((0.0, 0.0))


def test_of_a_receiver_with_pvt_the_older_messages_are_not_told_twice(make):
    decoder = UbxDecoder()
    assert len(decoder.take(make["pvt"]())) == 1
    assert decoder.take(sol()) == []


def test_what_is_no_message_is_counted():
    decoder = UbxDecoder()
    assert decoder.take(b"\xb5\x62\x01\x07\x02\x00\x00\x00\x0a\x2b") == []
    assert decoder.take(b"") == []
    assert decoder.damaged >= 1
