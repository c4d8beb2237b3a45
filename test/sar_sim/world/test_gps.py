import numpy as np
import pytest

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_sim.scenario.scenario import Gps, Pattern, Pilot
from sar_sim.world.gps import NoReceiver, RecordedTrack, SimulatedGps
from sar_sim.world.helicopter import PatternHelicopter

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


def test_errors_that_wander_have_their_size_and_their_time():
    gps = Gps(bias_sigma_m=2.0, bias_time_s=20.0, seed=4)
    long = PatternHelicopter(Pattern(first_leg_m=200_000.0), Pilot(), 20.0, 2.5)
    found = []
    for reception in SimulatedGps(long, gps, DATUM).due(9000.0):
        x, y, _ = DATUM.to_local(reception.fix.latitude_deg, reception.fix.longitude_deg)
        found.append((x, y - 20.0 * reception.fix.time_s))
    found = np.array(found)[:, 0]  # the map is flat, and 180 km are not: across alone
    assert found.std() == pytest.approx(2.0, rel=0.2)
    alike = np.corrcoef(found[:-20], found[20:])[0, 1]
    assert alike == pytest.approx(np.exp(-1.0), abs=0.15)


def test_what_is_late_is_of_an_earlier_time():
    gps = Gps(latency_s=0.1, latency_per_mps_s=0.01)
    assert errors(gps)[10:50, 1] == pytest.approx(np.full(40, -20.0 * 0.3), abs=0.05)


def test_the_receiver_says_how_good_it_is_as_a_whole():
    gps = Gps(sigma_m=3.0, bias_sigma_m=4.0)
    fix = SimulatedGps(HELICOPTER, gps, DATUM).due(1.0)[0].fix
    assert fix.covariance_m2 == pytest.approx(25.0 * np.eye(2))
