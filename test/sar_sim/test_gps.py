import numpy as np
import pytest

from sar_estimator.fixes import Fix
from sar_estimator.geodesy import Datum
from sar_sim.gps import NoReceiver, RecordedTrack, SimulatedGps
from sar_sim.helicopter import PatternHelicopter
from sar_sim.scenario import Gps, Pattern, Pilot

DATUM = Datum(37.8, -122.8)
HELICOPTER = PatternHelicopter(Pattern(), Pilot(), 20.0, 2.5)


def errors(gps):
    found = []
    for reception in SimulatedGps(HELICOPTER, gps, DATUM).due(1000.0):
        truth = HELICOPTER.motion(reception.fix.time_s)
        x, y, _ = DATUM.to_local(reception.fix.latitude_deg, reception.fix.longitude_deg)
        found.append((x - truth.x_m, y - truth.y_m))
    return np.array(found)


def test_noise_has_the_sigma_it_says():
    assert errors(Gps(sigma_m=3.0)).std(axis=0) == pytest.approx([3.0, 3.0], rel=0.1)
    assert np.abs(errors(Gps())).max() < 1e-3


def test_dropouts_and_rate():
    assert len(errors(Gps(rate_hz=5.0))) == 5000
    assert len(errors(Gps(dropout=0.3))) == pytest.approx(700, abs=50)


def test_doppler():
    gps = SimulatedGps(HELICOPTER, Gps(doppler_sigma_mps=0.1), DATUM)
    velocities = np.array([(r.velocity.vx_mps, r.velocity.vy_mps) for r in gps.due(80.0)])
    assert velocities.mean(axis=0) == pytest.approx([0.0, 20.0], abs=0.1)


def test_epochs_are_given_once():
    gps = SimulatedGps(HELICOPTER, Gps(), DATUM)
    assert [len(gps.due(t)) for t in (0.5, 1.0, 1.0, 3.2)] == [0, 1, 0, 2]


def test_recorded_track_keeps_its_times():
    track = RecordedTrack([Fix(100.0, 37.8, -122.8), Fix(102.0, 37.8, -122.7)])
    assert track.end_s == 2.0
    assert [r.fix.time_s for r in track.due(0.0)] == [100.0]
    assert [r.fix.time_s for r in track.due(5.0)] == [102.0]
    assert NoReceiver().due(1.0) == []
