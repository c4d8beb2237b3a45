"""What a receiver says of an epoch: UBX by pyubx2, NMEA 0183 by pynmeagps. Pure."""

from __future__ import annotations

import math
from datetime import UTC, datetime

from pynmeagps import GET as NMEA_GET
from pynmeagps import NMEAMessage
from pyubx2 import GET, UBXMessage

from sar_estimator.gps.nmea import KNOT_MPS
from sar_sim.world.gps import Reception

SATELLITES = 12


def _speed(reception: Reception) -> tuple[float, float]:
    """Return the velocity, east and north [m/s]. Raises ``ValueError`` for a reception without."""
    if reception.velocity is None:
        raise ValueError("reception without a velocity: expected one, as every receiver tells")
    return reception.velocity.vx_mps, reception.velocity.vy_mps


def ubx(reception: Reception, utc_s: float, sigma_m: float, sigma_mps: float) -> bytes:
    """Return a NAV-PVT; its accuracies are radii that hold 68 %."""
    fix, (east, north) = reception.fix, _speed(reception)
    whole = math.floor(utc_s)
    at = datetime.fromtimestamp(whole, UTC)
    message = UBXMessage(
        "NAV",
        "NAV-PVT",
        GET,
        year=at.year,
        month=at.month,
        day=at.day,
        hour=at.hour,
        min=at.minute,
        second=at.second,
        nano=round(1e9 * (utc_s - whole)),
        validDate=1,
        validTime=1,
        gnssFixOk=1,
        fixType=3,
        numSV=SATELLITES,
        lat=fix.latitude_deg,
        lon=fix.longitude_deg,
        hMSL=round(1e3 * fix.altitude_m),
        hAcc=round(1e3 * math.sqrt(2.0) * sigma_m),
        vAcc=round(2e3 * sigma_m),
        velE=round(1e3 * east),
        velN=round(1e3 * north),
        gSpeed=round(1e3 * math.hypot(east, north)),
        sAcc=round(1e3 * math.sqrt(2.0) * sigma_mps),
    )
    return bytes(message.serialize())


def nmea(reception: Reception, utc_s: float, sigma_m: float) -> bytes:
    """Return RMC, GGA and GST of an epoch."""
    fix, (east, north) = reception.fix, _speed(reception)
    at = datetime.fromtimestamp(round(utc_s, 2), UTC)
    clock, latitude, longitude = at.time(), fix.latitude_deg, fix.longitude_deg
    place = {
        "lat": latitude,
        "NS": "N" if latitude >= 0.0 else "S",
        "lon": longitude,
        "EW": "E" if longitude >= 0.0 else "W",
    }
    sentences = (
        NMEAMessage(
            "GN",
            "RMC",
            NMEA_GET,
            time=clock,
            status="A",
            spd=math.hypot(east, north) / KNOT_MPS,
            cog=math.degrees(math.atan2(east, north)) % 360.0,
            date=at.date(),
            posMode="A",
            **place,
        ),
        NMEAMessage(
            "GN",
            "GGA",
            NMEA_GET,
            time=clock,
            quality=1,
            numSV=SATELLITES,
            HDOP=0.9,
            alt=fix.altitude_m,
            sep=0.0,
            **place,
        ),
        NMEAMessage(
            "GN",
            "GST",
            NMEA_GET,
            time=clock,
            rangeRms=sigma_m,
            stdLat=sigma_m,
            stdLong=sigma_m,
            stdAlt=2.0 * sigma_m,
        ),
    )
    return b"".join(bytes(one.serialize()) for one in sentences)
