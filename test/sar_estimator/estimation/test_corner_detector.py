import math

import numpy as np
import pytest

from sar_estimator.estimation.corner_detector import (
    ALONG,
    VARIANCE,
    AccelPrior,
    Decelerations,
    deviation,
    filtered,
    hypotheses,
    moments,
    onsets,
    stop_posterior,
    watch,
)
from sar_estimator.estimation.leg_process import Belief, LegProcess

PRIOR = AccelPrior(2.5, 0.3)
SPEED = 20.0


def slowing(times, onset=40.3, accel=2.0, speed=SPEED):
    t = np.clip(times - onset, 0.0, speed / accel)
    return speed * np.minimum(times, onset) + speed * t - 0.5 * accel * t**2


def rows_of(times, x, y=None, sigma=1.0):
    y = np.zeros(len(times)) if y is None else y
    return np.column_stack((times, x, y, np.full(len(times), sigma), np.zeros(len(times))))


def believed(rows, until):
    """What is believed of a leg flown east before a time, and the rows after it."""
    process = LegProcess(0.1)
    process.begin(float(rows[0, 0]), (0.0, 0.0), (SPEED, 0.0), 3.0)
    old = rows[:, 0] < until
    process.absorb(rows[old], 0.0)
    return process.belief, rows[~old]


def watched(rows, until):
    belief, new = believed(rows, until)
    last = float(rows[-1, 0])
    return watch(new, belief, 0.0, onset_range_s=(last - 10.0, last), accel_prior=PRIOR)


def test_deviation_is_the_shortfall_until_the_stop_and_beyond():
    for time in range(60):
        shortfall = slowing(np.array([float(time)]))[0] - SPEED * time
        assert deviation(time - 40.3, False, 2.0, SPEED, 10.0) == pytest.approx(shortfall)
    speeds = [deviation(time - 40.3, True, 2.0, SPEED, 10.0) for time in (40, 45, 59)]
    assert speeds == pytest.approx([0.0, -9.4, -20.0])


def test_onsets_are_close_for_the_newest_and_all_within_their_range():
    found = np.sort(onsets(30.0, 40.0))
    assert (found[0], found[-1]) == (30.0, 40.0)
    assert np.diff(found)[-1] == pytest.approx(0.25)
    assert np.diff(found).max() == pytest.approx(0.5)
    assert onsets(40.0, 40.0).tolist() == [40.0]
    assert onsets(1.8e9, 1.8e9).tolist() == [1.8e9]
    assert np.sort(onsets(1.8e9 - 10.0, 1.8e9)) - 1.8e9 == pytest.approx(found - 40.0, abs=1e-6)


def exact_log_ratio(rows, belief, shape):
    """The log likelihood ratio of a shape along x, by filtering the rows without it."""
    seen, *_ = filtered(rows, *belief[:-2], 0.0)
    moved = rows.copy()
    moved[:, 1] -= shape
    other, *_ = filtered(moved, *belief[:-2], 0.0)
    # What is left of the rows is white: the filter's innovations (Kailath 1968).
    before, after, variances = seen[:, ALONG], other[:, ALONG], seen[:, VARIANCE]
    return 0.5 * float(((before**2 - after**2) / variances).sum())


def test_a_hypothesis_is_weighed_by_the_likelihood_of_the_rows_without_its_shape():
    rng = np.random.default_rng(2)
    times = np.arange(0.0, 46.0)
    rows = rows_of(times, slowing(times) + rng.standard_normal(46))
    belief, new = believed(rows, 36.0)
    seen, means, covariance = filtered(new, *belief[:-2], 0.0)
    grid, accels = np.arange(37.0, 45.0, 0.5), np.array([1.5, 2.0, 2.6])
    table = hypotheses(seen, means, covariance, 0.0, (0.0, 0.0), grid, accels, np.zeros(3))
    for h in range(0, table.shape[1], 5):
        onset, accel = table[1, h], table[3, h]
        shape = np.array(
            [deviation(t - onset, False, accel, table[6, h], math.inf) for t in new[:, 0]]
        )
        assert table[0, h] == pytest.approx(exact_log_ratio(new, belief, shape), abs=1e-6)


def test_a_leg_kept_is_evidence_against_both():
    rng = np.random.default_rng(1)
    times = np.arange(0.0, 40.0)
    x, y = SPEED * times + rng.standard_normal(40), rng.standard_normal(40)
    found = watched(rows_of(times, x, y), 30.0)
    assert max(found.slowing, found.turning) < 0.0
    assert abs(found.misfit) < 3.0


def test_slowing_is_no_turn_and_a_turn_no_slowing():
    times = np.arange(0.0, 45.0)
    slow = watched(rows_of(times, slowing(times)), 34.0)
    assert slow.slowing > 10.0
    assert slow.turning < 0.0
    since = np.maximum(times - 40.3, 0.0)
    for side in (1.0, -1.0):
        turn = watched(rows_of(times, SPEED * times, side * 1.5 * since**2), 34.0)
        assert turn.turning > 10.0
        assert turn.slowing < 0.0
        assert side * turn.turn_mps2 == pytest.approx(3.0, abs=0.5)


def test_both_at_once_are_both_seen():
    times = np.arange(0.0, 45.0)
    since = np.maximum(times - 41.3, 0.0)
    both = watched(rows_of(times, slowing(times), -1.5 * since**2), 34.0)
    assert min(both.slowing, both.turning) > 5.0


def test_a_gentle_change_of_speed_is_no_corner():
    times = np.arange(0.0, 45.0)
    since = np.clip(times - 38.0, 0.0, 5.0)
    changed = SPEED * times - 0.5 * 0.3 * since**2
    assert watched(rows_of(times, changed), 35.0).slowing < 5.0


def test_what_wanders_is_believed_later():
    times = np.arange(0.0, 45.0)
    rows = rows_of(times, slowing(times))
    belief, new = believed(rows, 34.0)
    rough = Belief(*belief[:3], size_mps=1.5, scale=belief.scale, along=1.0, across=1.0)
    given = {"onset_range_s": (34.0, 44.0), "accel_prior": PRIOR}
    steady = watch(new, belief, 0.0, **given).slowing
    assert watch(new, rough, 0.0, **given).slowing < 0.5 * steady
    noisier = belief._replace(along=4.0)
    assert watch(new, noisier, 0.0, **given).slowing < 0.5 * steady


@pytest.mark.parametrize("until", [44.0, 47.0, 50.0])
def test_posterior_holds_the_truth(until):
    rng = np.random.default_rng(4)
    inside = 0
    times = np.arange(0.0, until)
    for _ in range(60):
        belief, new = believed(
            rows_of(times, slowing(times) + rng.standard_normal(times.size)), 34.0
        )
        found = stop_posterior(
            new,
            belief,
            0.0,
            onset_range_s=(35.0, 44.0),
            accel_prior=PRIOR,
            origin_m=(100.0, 0.0),
            refinements=2,
        )
        off = found.stop_along_m - (SPEED * 40.3 + 100.0 - 100.0)
        inside += abs(off) < 2.0 * found.stop_along_sigma_m
    assert inside >= 51


def test_noise_free_slowing_is_resolved_finely():
    times = np.arange(0.0, 50.0)
    belief, new = believed(rows_of(times, slowing(times), sigma=0.5), 34.0)
    found = stop_posterior(
        new,
        belief,
        0.0,
        onset_range_s=(35.0, 44.0),
        accel_prior=PRIOR,
        origin_m=(0.0, 0.0),
        refinements=2,
    )
    assert found.stop_along_m == pytest.approx(906.0, abs=0.7)
    assert found.stop_time_s == pytest.approx(50.3, abs=0.2)
    assert found.accel_mps2 == pytest.approx(2.0, abs=0.05)
    assert found.speed_mps == pytest.approx(SPEED, abs=0.05)
    assert found.log_bayes_factor > 100.0


def test_moments_are_those_of_the_weights():
    table = np.vstack((np.log((1.0, 2.0, 1.0)), np.tile((1.0, 2.0, 5.0), (7, 1))))
    found = moments(table)
    assert found[0, 0] == pytest.approx(math.log(4.0))
    assert found[:, 1] == pytest.approx((2.5, 2.25))


def test_prior_expects_an_unbiased_stopping_distance():
    accels, log_weights = AccelPrior(2.5, 0.3).grid()
    assert np.exp(log_weights).sum() == pytest.approx(1.0)
    mean_inverse = float(np.exp(log_weights) @ (1.0 / accels))
    assert 1.0 / mean_inverse == pytest.approx(2.5, rel=0.01)
    assert math.isclose(accels[len(accels) // 2], 2.5 * math.exp(0.045))


def test_decelerations_are_expected_as_they_were_seen():
    """Student's t of a conjugate prior: from what is expected first to what the pilot does."""
    seen = Decelerations(2.5, 0.3)
    assert (seen.expected.centre_mps2, seen.expected.spread) == pytest.approx((2.5, 0.3))
    for alike in range(20):
        seen.add(2.0)
        assert seen.expected.spread < 0.4, alike
    assert seen.expected.centre_mps2 == pytest.approx(2.0, rel=0.03)
    assert seen.expected.spread == pytest.approx(0.1, abs=0.02)
    rng, seen = np.random.default_rng(2), Decelerations(2.5, 0.3)
    for accel in 2.2 * np.exp(0.35 * rng.standard_normal(60)):
        seen.add(accel)
    assert seen.expected.spread == pytest.approx(0.35, abs=0.06)


@pytest.mark.parametrize("accel", [0.05, 30.0])
def test_what_is_learnt_of_decelerations_stays_within_reason(accel):
    seen = Decelerations(2.5, 0.3)
    for _ in range(30):
        seen.add(accel)
    assert 2.5 / 1.8 <= seen.expected.centre_mps2 <= 2.5 * 1.8
    assert 0.1 <= seen.expected.spread <= 0.5
