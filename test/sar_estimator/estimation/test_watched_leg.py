"""A leg that is watched: told of as it is known, before a corner bends it."""

import math

import pytest

from sar_estimator.common.states import Motion
from sar_estimator.estimation.corner_detector import Decelerations
from sar_estimator.estimation.leg import LegRow
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_estimator.estimation.watched_leg import WatchedLeg

P = EstimatorParameters()
PRIOR = Decelerations(P.accel_prior_mps2, P.accel_prior_spread).expected


def rows(at_s, *, slowing_s=math.inf, velocities=True):
    """A helicopter east at 20 m/s that slows with 2.5 m/s^2 from a time on."""
    since = max(0.0, at_s - slowing_s)
    x = 20.0 * at_s - 1.25 * since**2
    found = [LegRow(at_s, x, 0.0, 1.0, is_velocity=False)]
    if velocities:
        found.append(LegRow(at_s, 20.0 - 2.5 * since, 0.0, 0.1, is_velocity=True))
    return found


def watched(until_s, **how):
    leg = WatchedLeg(P)
    leg.begin(rows(0.0, **how), Motion(0.0, 0.0, 0.0, 20.0, 0.0))
    for i in range(1, round(until_s) + 1):
        leg.add(rows(float(i), **how))
    return leg


def test_on_a_straight_leg_there_is_no_evidence_of_a_corner():
    leg = watched(60.0)
    seen = leg.watch(60.0, PRIOR)
    assert max(seen.slowing, seen.turning) < 0.0
    told = leg.leg(seen, 60.0)
    assert told.speed_mps == pytest.approx(20.0, abs=0.05)
    assert leg.heading_rad == pytest.approx(0.0, abs=1e-3)


def test_a_slow_down_is_seen_and_its_stop_inferred():
    leg = watched(63.0, slowing_s=60.0)
    assert leg.watch(63.0, PRIOR).slowing > leg.needed
    speed = 20.0 - 7.5
    motion = Motion(63.0, 20.0 * 63.0 - 1.25 * 9.0, 0.0, speed, 0.0)
    stop = leg.stop(motion, PRIOR, 63.0)
    assert stop.stop_time_s == pytest.approx(68.0, abs=0.5)
    assert motion.x_m + stop.stop_along_m == pytest.approx(1280.0, abs=6.0)


def test_the_leg_before_a_corner_is_not_bent_by_it():
    leg = watched(63.0, slowing_s=60.0)
    assert leg.leg_before(60.0).speed_mps == pytest.approx(20.0, abs=0.1)
    assert leg.leg(leg.watch(63.0, PRIOR), 63.0).speed_mps < 19.9
    assert leg.leg_before(-1.0) is None


def test_more_evidence_is_asked_for_without_velocities():
    assert watched(20.0, velocities=False).needed > watched(20.0).needed


def test_what_is_too_slow_is_no_leg():
    leg = WatchedLeg(P)
    leg.begin([LegRow(0.0, 0.0, 0.0, 1.0, is_velocity=False)], Motion(0.0, 0.0, 0.0, 1.0, 0.0))
    for i in range(1, 20):
        leg.add([LegRow(float(i), 1.0 * i, 0.0, 1.0, is_velocity=False)])
        leg.add([LegRow(float(i), 1.0, 0.0, 0.1, is_velocity=True)])
    leg.heading_rad = 0.3
    assert leg.leg(leg.watch(19.0, PRIOR), 19.0) is None
    assert leg.heading_rad == 0.3


def test_a_course_is_turned_from_the_leg_by_the_shorter_way():
    leg = watched(10.0)
    leg.heading_rad = math.radians(170.0)
    assert leg.turned(Motion(0.0, 0.0, 0.0, -1.0, -0.1)) == pytest.approx(
        math.radians(190.0) - math.radians(170.0) - math.radians(4.29), abs=0.01
    )
