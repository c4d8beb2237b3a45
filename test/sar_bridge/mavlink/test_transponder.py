"""The helicopter's ADS-B position among what is heard."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.transponder import Transponder
from sar_estimator.common.geodesy import Datum

DATUM = Datum(37.8, -122.8)
VALID = mavlink.ADSB_FLAGS_VALID_COORDS


def vehicle(icao=0xA1B2C3, lat=378_100_000, lon=-1_228_000_000, flags=VALID, age_s=2):
    return mavlink.MAVLink_adsb_vehicle_message(
        icao, lat, lon, 0, 150_000, 9000, 2000, 0, b"CG6019", 7, age_s, flags, 1200
    )


def test_its_own_positions_are_picked_out_and_dated():
    seen = Transponder("a1b2C3").heard(vehicle(), 1000.0, DATUM)
    assert seen.time_s == 998.0
    assert (seen.x_m, seen.y_m) == pytest.approx((0.0, 1109.9), abs=0.5)


@pytest.mark.parametrize(
    ("icao", "message", "datum"),
    [
        ("A1B2C4", vehicle(), DATUM),
        ("", vehicle(), DATUM),
        ("A1B2C3", vehicle(flags=0), DATUM),
        ("A1B2C3", vehicle(lat=2_000_000_000), DATUM),
        ("A1B2C3", vehicle(), None),
        ("A1B2C3", mavlink.MAVLink_radio_status_message(1, 1, 1, 1, 1, 1, 1), DATUM),
    ],
)
def test_all_else_is_not(icao, message, datum):
    assert Transponder(icao).heard(message, 1000.0, datum) is None


@pytest.mark.parametrize("icao", ["A1B2", "A1B2C3D", "G1B2C3", "0xA1B2"])
def test_what_is_no_address_is_refused(icao):
    with pytest.raises(ValueError, match=r"helicopter_icao = .*expected 6 hexadecimal digits"):
        Transponder(icao)
