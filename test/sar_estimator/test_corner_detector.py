import math

import numpy as np
import pytest

from sar_estimator.corner_detector import (
    AccelPrior,
    TrackRows,
    deviation,
    hypotheses,
    moments,
    stop_posterior,
)

PRIOR = AccelPrior(2.5, 0.3)


def rows(times, values, sigma, is_speed=None):
    flags = np.zeros(len(times), dtype=bool) if is_speed is None else is_speed
    return TrackRows(times, values, np.full(len(times), sigma), flags)


def slowing(times, onset=40.3, accel=2.0, speed=20.0):
    t = np.clip(times - onset, 0.0, speed / accel)
    return speed * np.minimum(times, onset) + speed * t - 0.5 * accel * t**2


def test_deviation_is_the_shortfall_until_the_stop_and_beyond():
    for time in range(60):
        shortfall = slowing(np.array([float(time)]))[0] - 20.0 * time
        assert deviation(time - 40.3, False, 2.0, 20.0, 10.0) == pytest.approx(shortfall)
    speeds = [deviation(time - 40.3, True, 2.0, 20.0, 10.0) for time in (40, 45, 59)]
    assert speeds == pytest.approx([0.0, -9.4, -20.0])


def test_moments_are_those_of_the_exact_likelihood_ratio():
    rng = np.random.default_rng(2)
    times = np.arange(0.0, 46.0)
    is_speed = rng.random(46) < 0.3
    values = np.where(is_speed, 20.0, slowing(times) + rng.standard_normal(46))
    sigmas = rng.uniform(0.5, 2.0, 46)
    onsets, (accels, log_prior) = np.arange(36.0, 45.0, 0.5), PRIOR.grid()
    design = np.where(is_speed[:, None], (0.0, 1.0), np.column_stack((np.ones(46), times - 45.0)))
    design /= sigmas[:, None]
    off_design = np.eye(46) - design @ np.linalg.pinv(design)
    weights, stops = [], []
    for onset in onsets:
        for accel, prior in zip(accels, log_prior, strict=True):
            shape = np.array(
                [
                    deviation(t - onset, kind, accel, 20.0, 20.0 / accel)
                    for t, kind in zip(times, is_speed, strict=True)
                ]
            )
            free, slow = (off_design @ (x / sigmas) for x in (values, values - shape))
            weights.append(0.5 * (free @ free - slow @ slow) + prior)
            place, speed = np.linalg.lstsq(design, (values - shape) / sigmas)[0]
            stops.append(place + speed * (onset - 45.0) + 0.5 * speed**2 / accel)
    found = moments(hypotheses(times, values, sigmas, is_speed, 20.0, onsets, accels, log_prior))
    peak = max(weights)
    shares = np.exp(np.array(weights) - peak)
    assert found[0, 0] == pytest.approx(peak + np.log(shares.sum()))
    assert found[0, 4] == pytest.approx(shares @ np.array(stops) / shares.sum())


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
