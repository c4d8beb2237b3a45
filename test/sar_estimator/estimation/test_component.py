"""The estimator as a component: what is told, when, and in which order."""

import math

import pytest

from sar_estimator.common import topics
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.reports import Velocity
from sar_estimator.common.states import Phase
from sar_estimator.estimation.component import EstimatorComponent, given_datum
from sar_estimator.estimation.parameters import EstimatorParameters

DATUM = Datum(37.8, -122.8)


def fix_at(time_s, x):
    latitude, longitude, _ = DATUM.to_geodetic(x, 0.0)
    return Fix(time_s, latitude, longitude)


def along(time_s, onset_s=40.0):
    """Distance and speed at 20 m/s, slowed with 2.5 m/s^2 to a stand from an onset on."""
    slowing = min(max(time_s - onset_s, 0.0), 8.0)
    return 20.0 * min(time_s, onset_s) + 20.0 * slowing - 1.25 * slowing**2, 20.0 - 2.5 * slowing


def flown(until=60, *, velocity=False, component=None):
    component = component or EstimatorComponent(EstimatorParameters())
    told = [*component.start(0.0)]
    for second in range(until):
        x, speed = along(float(second))
        told += component.handle(topics.FIX, fix_at(float(second), x), float(second))
        if velocity:
            given = Velocity(float(second), speed, 0.0)
            told += component.handle(topics.VELOCITY, given, float(second))
        for fifth in range(5):
            told += component.tick(second + 0.2 * fifth)
    return component, told


def test_a_flight_is_told_in_full_and_everything_told_is_declared():
    component, told = flown()
    assert {topic for topic, _ in told} == set(component.outputs) - {topics.DIAGNOSTICS}
    phases = [value for topic, value in told if topic == topics.PHASE]
    assert phases[:4] == [Phase.LOST, Phase.ACCELERATING, Phase.CRUISE, Phase.DECELERATING] or (
        phases[:3] == [Phase.ACCELERATING, Phase.CRUISE, Phase.DECELERATING]
    )
    assert sum(topic == topics.DATUM for topic, _ in told) == 1


def test_a_phase_is_told_before_what_is_predicted_in_it():
    _, told = flown()
    order = [topic for topic, value in told]
    at = next(i for i, (topic, value) in enumerate(told) if value is Phase.DECELERATING)
    assert topics.PREDICTION in order[at : at + 4]
    assert topics.PREDICTION not in order[:at]


def test_a_velocity_that_comes_after_its_fix_is_told_at_once():
    _, told = flown(velocity=True)
    assert any(topic == topics.PREDICTION for topic, _ in told)


def test_an_origin_that_is_given_is_told_before_any_fix():
    component = EstimatorComponent(EstimatorParameters(), DATUM)
    assert component.start(0.0) == [(topics.DATUM, DATUM)]
    assert component.tick(0.0) == [(topics.PHASE, Phase.LOST)]
    assert given_datum(math.nan, math.nan, 0.0) is None
    assert given_datum(37.8, -122.8, 5.0) == Datum(37.8, -122.8, 5.0)


def test_health_says_what_became_of_fixes():
    component, _ = flown(20)
    health = component.health(19.0)
    assert (health.name, health.problem) == ("estimator", "")
    assert health.values["accepted"] == 20
    assert not health.severe
    lost = component.health(60.0)
    assert (lost.problem, lost.severe) == ("no usable GPS fix", True)


def test_a_clock_set_back_begins_again():
    component, _ = flown(20)
    component.set_clock_back()
    assert component.handle(topics.FIX, fix_at(5.0, 0.0), 5.0)
    assert component.estimator.phase(5.0) is not Phase.LOST


@pytest.mark.parametrize("rate", [0.0, -1.0, 1000.0, math.nan])
def test_a_rate_that_cannot_be_meant_is_named(rate):
    with pytest.raises(ValueError, match="prediction_rate_hz"):
        EstimatorComponent(EstimatorParameters(), rate_hz=rate)


def test_what_is_no_input_changes_nothing():
    component, _ = flown(20)
    assert component.handle(topics.SPEED, 20.0, 20.0) == []


def test_a_receivers_accuracy_counts_where_it_is_worse_than_what_is_believed():
    """And one that tells it is not heard twice."""
    sigmas = []
    component = EstimatorComponent(EstimatorParameters(), velocity_sigma_mps=0.1)
    component.estimator.add_velocity = lambda *given: sigmas.append(given[3])
    for topic, sigma in (
        (topics.VELOCITY, None),
        (topics.FIX_VELOCITY, 0.4),
        (topics.FIX_VELOCITY, 0.02),
        (topics.FIX_VELOCITY, None),
        (topics.VELOCITY, None),
    ):
        component.handle(topic, Velocity(1.0, 20.0, 0.0, sigma), 1.0)
    assert sigmas == [0.1, 0.4, 0.1, 0.1]


def test_the_time_of_a_fix_is_told_before_what_rests_on_it():
    component = EstimatorComponent(EstimatorParameters(), DATUM)
    told = component.handle(topics.FIX, fix_at(10.0, 0.0), 10.4)
    assert told[0] == (topics.DATUM, DATUM)
    assert told[1] == (topics.FIX_TIME, 10.0)
    assert component.health(10.4).values["fix_late_s"] == "0.4"
    again = component.handle(topics.FIX, fix_at(10.0, 0.0), 13.0)
    assert topics.FIX_TIME not in [topic for topic, _ in again]
    assert component.health(13.0).values["fix_late_s"] == "0.4"
