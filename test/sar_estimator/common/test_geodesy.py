import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.geodesy import Datum, valid_position


@given(st.floats(-80.0, 80.0), st.floats(-180.0, 180.0), st.floats(-2e4, 2e4), st.floats(-2e4, 2e4))
def test_round_trip(latitude, longitude, x, y):
    datum = Datum(latitude, longitude, 10.0)
    back = datum.to_local(*datum.to_geodetic(x, y, 5.0))
    assert back == pytest.approx((x, y, 5.0), abs=1e-4)


def test_without_altitude_the_datums_is_taken():
    assert Datum(37.8, -122.8, 500.0).to_local(37.8, -122.8)[2] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("bad", [(91.0, 0.0), (0.0, 181.0), (math.nan, 0.0)])
def test_bad_datum_is_named(bad):
    assert not valid_position(*bad)
    with pytest.raises(ValueError, match="datum"):
        Datum(*bad)


def test_bad_altitude_is_named():
    with pytest.raises(ValueError, match="altitude_m inf"):
        Datum(0.0, 0.0, math.inf)
