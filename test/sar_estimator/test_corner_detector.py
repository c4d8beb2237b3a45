import math

import numpy as np
import pytest

from sar_estimator.corner_detector import AccelPrior, TrackRows, deviations, stop_posterior

PRIOR = AccelPrior(2.5, 0.3)


def rows(times, values, sigma, is_speed=None):
    flags = np.zeros(len(times), dtype=bool) if is_speed is None else is_speed
    return TrackRows(times, values, np.full(len(times), sigma), flags)


def slowing(times, onset=40.3, accel=2.0, speed=20.0):
    t = np.clip(times - onset, 0.0, speed / accel)
    return speed * np.minimum(times, onset) + speed * t - 0.5 * accel * t**2


def test_deviation_is_the_shortfall_until_the_stop_and_beyond():
    times = np.arange(0.0, 60.0)
    shift = deviations(rows(times, times, 1.0), np.array([40.3]), np.array([2.0]), 20.0)
    assert shift[0] == pytest.approx(slowing(times) - 20.0 * times)
    speeds = deviations(
        rows(times, times, 1.0, np.ones(60, dtype=bool)), np.array([40.3]), np.array([2.0]), 20.0
    )
    assert speeds[0][[40, 45, 59]] == pytest.approx([0.0, -9.4, -20.0])


@pytest.mark.parametrize("until", [44.0, 47.0, 50.0])
def test_posterior_holds_the_truth(until):
    rng = np.random.default_rng(4)
    inside = 0
    times = np.arange(0.0, until)
    for _ in range(60):
        values = slowing(times) + rng.standard_normal(times.size)
        found = stop_posterior(
            rows(times, values, 1.0),
            onset_range_s=(35.0, 44.0),
            speed_mps=20.0,
            accel_prior=PRIOR,
            refinements=2,
        )
        inside += abs(found.stop_along_m - (20.0 * 40.3 + 100.0)) < 2.0 * found.stop_along_sigma_m
    assert inside >= 51


def test_noise_free_slowing_is_resolved_finely():
    times = np.arange(0.0, 50.0)
    found = stop_posterior(
        rows(times, slowing(times), 0.5),
        onset_range_s=(35.0, 44.0),
        speed_mps=20.0,
        accel_prior=PRIOR,
        refinements=2,
    )
    assert found.stop_along_m == pytest.approx(906.0, abs=0.5)
    assert found.stop_time_s == pytest.approx(50.3, abs=0.15)
    assert found.accel_mps2 == pytest.approx(2.0, abs=0.03)
    assert found.speed_mps == pytest.approx(20.0, abs=0.02)
    assert found.log_bayes_factor > 100.0


def test_steady_flight_is_evidence_against():
    times = np.arange(0.0, 50.0)
    found = stop_posterior(
        rows(times, 20.0 * times, 1.0),
        onset_range_s=(40.0, 49.0),
        speed_mps=20.0,
        accel_prior=PRIOR,
    )
    assert found.log_bayes_factor < 0.0


def test_prior_expects_an_unbiased_stopping_distance():
    accels, log_weights = AccelPrior(2.5, 0.3).grid()
    assert np.exp(log_weights).sum() == pytest.approx(1.0)
    mean_inverse = float(np.exp(log_weights) @ (1.0 / accels))
    assert 1.0 / mean_inverse == pytest.approx(2.5, rel=0.01)
    assert math.isclose(accels[6], 2.5 * math.exp(0.045))
