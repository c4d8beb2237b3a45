"""Corners where they are expected: seen on less evidence, and never later for it."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.states import Phase
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.expectant_tracker import LONGEST_EARLY_S
from sar_estimator.estimation.expected_legs import ExpectedLegs, log_odds_gain
from sar_estimator.estimation.parameters import EstimatorParameters

P = EstimatorParameters()
DATUM = Datum(37.8, -122.8)
V, A = 20.0, 2.5
STOPPING_M = V * V / (2.0 * A)
EAST, SOUTH = 0.0, -0.5 * math.pi

lengths = st.floats(1e-3, 1e6)
places = st.floats(-1e6, 1e6)
speeds = st.floats(P.min_cruise_mps, 100.0)


def flown(time_s, leg_m):
    """Place and velocity on a leg east that ends after ``leg_m``, and one south from there."""
    onset = (leg_m - STOPPING_M) / V
    slow = min(max(time_s - onset, 0.0), V / A)
    fast = min(max(time_s - onset - V / A, 0.0), V / A)
    going = max(time_s - onset - 2.0 * V / A, 0.0)
    x = V * min(time_s, onset) + V * slow - 0.5 * A * slow**2
    return (x, -0.5 * A * fast**2 - V * going), (V - A * slow, -A * fast)


def fly(expected_m, *, leg_m=1000.0, seed=0, sigma=3.0, until_s=90, doppler=0.0):
    """Yield time and estimator after every fix of ``flown``."""
    rng = np.random.default_rng(seed)
    estimator = HelicopterEstimator(replace(P, expected_legs_m=tuple(expected_m)), DATUM)
    for i in range(until_s):
        t = i + rng.uniform(0.0, 0.05)
        place, velocity = flown(t, leg_m)
        x, y = place + sigma * rng.standard_normal(2)
        vx, vy = velocity + doppler * rng.standard_normal(2)
        if doppler:
            estimator.add_velocity(t, vx, vy, doppler)
        latitude, longitude, _ = DATUM.to_geodetic(x, y)
        estimator.add_fix(Fix(t, latitude, longitude, 0.0, np.eye(2) * sigma**2))
        yield t, estimator


def told(flight):
    """Return, of every fix, its time, the phase, and the corner's stop or None."""
    return [(t, e.phase(t), e.corner and (e.corner.stop, e.corner.stop_time_s)) for t, e in flight]


def first_seen_s(flight):
    return next(t for t, _, corner in told(flight) if corner is not None)


@given(places, st.floats(1e-3, 1e4), lengths)
def test_the_evidence_needed_is_never_more_for_what_is_expected(past_m, newest_m, length_m):
    gain = log_odds_gain(past_m, newest_m, length_m)
    assert math.isfinite(gain)
    assert P.detect_log_bayes - gain <= P.detect_log_bayes


@given(st.lists(lengths, max_size=4), st.lists(st.floats(-4.0, 4.0)), places, speeds)
def test_nor_on_any_leg_at_any_place(expected_m, headings, x_m, speed_mps):
    legs = ExpectedLegs(expected_m)
    for heading in headings:
        legs.begin((0.0, 0.0), heading)
    gain = legs.gain((x_m, 0.0), speed_mps, A)
    assert gain >= 0.0
    assert expected_m or gain == 0.0


@given(st.floats(300.0, 1e5), st.floats(20.0, 400.0), places)
def test_some_evidence_is_always_needed(length_m, newest_m, past_m):
    assert log_odds_gain(past_m, newest_m, length_m) < 0.8 * P.detect_log_bayes


def test_less_evidence_will_do_about_the_expected_onset_only():
    gains = {past_m: log_odds_gain(past_m, 80.0, 1400.0) for past_m in range(-600, 1001, 10)}
    assert -50 <= max(gains, key=gains.get) <= 150
    assert gains[50] > 2.0
    assert gains[-300] == 0.0
    assert gains[1000] == pytest.approx(0.0, abs=1e-6)


def test_an_onset_is_expected_where_slowing_ends_the_leg():
    legs = ExpectedLegs([1000.0])
    legs.begin((0.0, 0.0), EAST)
    gains = [legs.gain((float(x), 0.0), V, A) for x in range(1200)]
    before, after = gains[700], gains[int(1000.0 - STOPPING_M + 60.0)]
    assert before == 0.0
    assert after == max(gains) or after > 2.0


def test_a_leg_is_the_next_one_when_it_has_another_heading():
    legs = ExpectedLegs([1000.0, 2000.0])
    at_end = (1000.0, 0.0)
    assert legs.gain(at_end, V, A) == 0.0
    legs.begin((0.0, 0.0), EAST)
    assert legs.gain(at_end, V, A) > 1.0
    legs.begin((500.0, 0.0), EAST + 0.2)  # he stood for a while
    assert legs.gain(at_end, V, A) > 1.0
    legs.begin(at_end, SOUTH)
    assert legs.gain((1000.0, -1000.0), V, A) == 0.0
    assert legs.gain((1000.0, -2000.0), V, A) > 1.0
    legs.begin((1000.0, -2000.0), math.pi)
    assert legs.gain((0.0, -2000.0), V, A) == 0.0


def test_of_a_leg_that_went_on_nothing_more_is_expected():
    legs = ExpectedLegs([1000.0, 1000.0])
    legs.begin((0.0, 0.0), EAST)
    legs.spend()
    assert legs.gain((1000.0, 0.0), V, A) == 0.0
    legs.begin((1000.0, 0.0), SOUTH)
    assert legs.gain((1000.0, -1000.0), V, A) > 1.0


def test_lengths_must_be_lengths():
    with pytest.raises(ValueError, match="expected_legs_m"):
        EstimatorParameters(expected_legs_m=(1000.0, 0.0))


def test_a_corner_is_seen_sooner_where_it_is_expected():
    sooner = [
        first_seen_s(fly((), seed=seed)) - first_seen_s(fly((1000.0,), seed=seed))
        for seed in range(40)
    ]
    assert min(sooner) >= 0.0
    assert np.mean(sooner) > 0.2


def test_the_second_leg_counts_from_the_first_corners_stop():
    *_, (_, estimator) = fly((1000.0, 500.0), until_s=74, sigma=1.0, doppler=0.1)
    place, _ = flown(73.0, 1000.0)
    assert estimator.leg is not None
    legs = estimator._tracker._expected
    assert legs._flown == 2
    assert math.dist(legs._from_m, (1000.0, 0.0)) < 15.0
    assert place[1] > -500.0


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.floats(300.0, 1600.0), min_size=1, max_size=3),
    st.integers(0, 1000),
    st.sampled_from((0.0, 0.1)),
)
@example([1000.0], 1, 0.0)
@example([900.0], 2, 0.0)
def test_whatever_is_expected_a_corner_is_told_of_no_later_and_no_other(expected_m, seed, doppler):
    without = told(fly((), seed=seed, doppler=doppler))
    with_it = told(fly(expected_m, seed=seed, doppler=doppler))
    early = [
        t
        for (t, phase, corner), other in zip(without, with_it, strict=True)
        if other[1:] != (phase, corner)
        and (phase, corner, other[1]) == (Phase.CRUISE, None, Phase.DECELERATING)
    ]
    for one, other in zip(without, with_it, strict=True):
        assert one == other or one[0] in early
    assert len(early) <= (LONGEST_EARLY_S + 1.0) * len(expected_m)


def test_who_flies_on_is_believed_to():
    """At most one corner is told of early where the leg was to end, and is soon taken back."""
    alarms = 0
    for seed in range(30):
        flight = told(fly((1000.0,), leg_m=1e6, seed=seed))
        shown = [corner is not None for _, _, corner in flight]
        begun = sum(now and not before for before, now in pairwise(shown))
        assert begun <= 1
        assert sum(shown) <= LONGEST_EARLY_S + 1.0
        assert flight[-1][1] is Phase.CRUISE
        alarms += begun
    assert alarms <= 3


def test_what_is_taken_back_is_counted_and_leaves_the_leg_as_it_was():
    for seed in range(200):
        pairs = zip(
            fly((1000.0,), leg_m=1e6, seed=seed, until_s=60),
            fly((), leg_m=1e6, seed=seed, until_s=60),
            strict=True,
        )
        early = [one.corner is not None and other.corner is None for (_, one), (_, other) in pairs]
        if any(early) and not early[-1]:
            break
    else:
        pytest.fail("no early corner in 200 flights")
    (*_, (_, one)), (*_, (_, other)) = (
        fly(told_m, leg_m=1e6, seed=seed, until_s=60) for told_m in ((1000.0,), ())
    )
    assert one.withdrawn_corners == other.withdrawn_corners + 1
    assert one.leg == other.leg
