"""What a simulated receiver says is read back as it was meant."""

import pytest

from sar_estimator.common.gps_fix import Fix
from sar_estimator.gps.receiver import Receiver
from sar_sim.trials.receiver_speech import nmea, ubx
from sar_sim.world.gps import Reception, Velocity

UTC_S = 1_795_000_000.0


def receptions():
    for i in range(5):
        fix = Fix(float(i), 37.8 + 1e-4 * i, -122.8 - 2e-4 * i, 45.0)
        yield UTC_S + i, Reception(fix, Velocity(12.0, -16.0))


@pytest.mark.parametrize("protocol", ["ubx", "nmea"])
def test_it_is_read_back(protocol):
    receiver, found, meant = Receiver(), [], []
    for utc_s, reception in receptions():
        data = ubx(reception, utc_s, 1.5, 0.1) if protocol == "ubx" else nmea(reception, utc_s, 1.5)
        found += receiver.feed(data, utc_s)
        meant.append((utc_s, reception))
    assert len(found) >= 4
    by_time = dict(meant)
    for reading in found:
        reception = by_time[round(reading.utc_s)]
        assert reading.is_valid
        assert reading.latitude_deg == pytest.approx(reception.fix.latitude_deg, abs=1e-6)
        assert reading.longitude_deg == pytest.approx(reception.fix.longitude_deg, abs=1e-6)
        assert reading.altitude_m == pytest.approx(45.0, abs=0.1)
        assert reading.velocity_mps == pytest.approx((12.0, -16.0), abs=0.02)
        assert reading.covariance_m2.diagonal() == pytest.approx((2.25, 2.25), abs=0.05)
        if protocol == "ubx":
            assert reading.velocity_sigma_mps == pytest.approx(0.1, abs=0.01)


def test_a_reception_without_a_velocity_is_not_told_as_one_that_stands():
    with pytest.raises(ValueError, match="without a velocity"):
        ubx(Reception(Fix(0.0, 37.8, -122.8, 0.0)), UTC_S, 1.0, 0.1)
