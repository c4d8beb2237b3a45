"""Messages of receivers, made by the libraries that read them."""

import math
from datetime import date as day

import pytest
from pynmeagps import GET, NMEAMessage
from pyubx2 import GET as UBX_GET
from pyubx2 import UBXMessage

TODAY = day(2026, 11, 28)


def sentence(kind, talker="GN", **values):
    """Return a whole NMEA sentence with line end."""
    return NMEAMessage(talker, kind, GET, **values).serialize()


def gga(time="10:20:30", lat=37.5, lon=-122.5, quality=1, hdop=0.8, alt=30.0):
    return sentence(
        "GGA",
        time=time,
        lat=lat,
        NS="N" if lat >= 0 else "S",
        lon=lon,
        EW="E" if lon >= 0 else "W",
        quality=quality,
        numSV=9,
        HDOP=hdop,
        alt=alt,
        sep=-30.0,
    )


def rmc(time="10:20:30", lat=37.5, lon=-122.5, status="A", spd=20.0, cog=90.0, date=TODAY):
    return sentence(
        "RMC",
        time=time,
        status=status,
        lat=lat,
        NS="N" if lat >= 0 else "S",
        lon=lon,
        EW="E" if lon >= 0 else "W",
        spd=spd,
        cog=cog,
        date=date,
        posMode="A" if status == "A" else "N",
    )


def gst(time="10:20:30", north=1.5, east=2.5):
    return sentence("GST", time=time, rangeRms=1.0, stdLat=north, stdLong=east, stdAlt=4.0)


def pvt(second=30, lat=37.5, lon=-122.5, ok=1, fix=3, east=3.0, north=-4.0, hacc_m=1.2, dated=1):
    """Return a NAV-PVT."""
    return UBXMessage(
        "NAV",
        "NAV-PVT",
        UBX_GET,
        year=2026, month=11, day=28, hour=10, min=20, second=second, nano=250_000_000,
        validDate=dated, validTime=dated, gnssFixOk=ok, fixType=fix, numSV=12,
        lat=lat, lon=lon, hMSL=30_000, hAcc=round(1e3 * hacc_m), vAcc=2000,
        velN=round(1e3 * north), velE=round(1e3 * east), velD=0, sAcc=100,
        gSpeed=round(1e3 * math.hypot(east, north)),
    ).serialize()  # fmt: skip


@pytest.fixture
def make():
    """Return what makes messages, by name."""
    return {"sentence": sentence, "gga": gga, "rmc": rmc, "gst": gst, "pvt": pvt}
