"""What the planner makes of what it is told: the motion to come in every phase."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.parameters.corner import CornerParameters
from sar_planner.patterns.legs import PatternTerms
from sar_planner.prediction.situation import HOVER_MPS, HOVERS_S, Situation


def estimate(**changes):
    values = {
        "time_s": 104.0,
        "stop": Pose(80.0, 0.0, 0.0),
        "stop_time_s": 108.0,
        "speed_mps": 20.0,
        "accel_mps2": 2.5,
        "covariance": np.zeros((2, 2)),
        "heading_sigma_rad": 0.0,
        "stop_time_sigma_s": 0.0,
    }
    return CornerEstimate(**(values | changes))


def situation(phase, helicopter, *, side=1, leg=None, corner=None):
    known = Situation(CornerParameters(), PatternTerms(side=side))
    known.set_helicopter(helicopter)
    if leg is not None:
        known.set_leg(leg)
    if corner is not None:
        known.set_corner(corner)
        if phase is not Phase.DECELERATING:
            known.set_phase(Phase.STOPPED)
    known.set_phase(phase)
    return known


def test_nothing_is_predicted_of_a_helicopter_that_is_lost_or_not_understood():
    assert Situation(CornerParameters(), PatternTerms(side=1)).forecasts(0.0) == ()
    at_rest = Motion(0.0, 0.0, 0.0, 0.0, 0.0)
    for phase in Phase:
        assert situation(phase, at_rest).forecasts(0.0) == ()


def test_on_a_leg_it_goes_on_or_stops_at_once():
    leg = LegEstimate(100.0, Pose(0.0, 0.0, 0.0), 21.0, 0.5, 0.001, 0.05)
    known = situation(Phase.CRUISE, Motion(100.0, 0.0, 0.0, 21.0, 0.0), leg=leg)
    going, stopping = known.forecasts(101.0)
    assert going.positions([111.0])[0] == pytest.approx((21.0 * 11.0, 0.0), abs=2.0)
    far = stopping.positions([200.0])[0]
    assert 80.0 < far[0] < 130.0


@pytest.mark.parametrize("side", [1, -1])
def test_slowing_it_will_turn_to_the_patterns_side(side):
    known = situation(
        Phase.DECELERATING, Motion(104.0, 60.0, 0.0, 10.0, 0.0), side=side, corner=estimate()
    )
    (forecast,) = known.forecasts(104.0)
    assert forecast.positions([130.0])[0][1] * side < -100.0
    assert known.slot_of(forecast.leg).x_m == pytest.approx(80.0 - 250.0)


def turning(side, vx=3.0, vy=4.0):
    """Two seconds before the stop that is expected, 2 m short of it and already aside."""
    return Motion(106.0, 78.0, -2.0 * side, vx, -vy * side)


@pytest.mark.parametrize("side", [1, -1])
def test_one_who_turns_while_he_slows_has_left_already(side):
    slowing = Motion(106.0, 75.0, 0.0, 5.0, 0.0)
    stops = situation(Phase.DECELERATING, slowing, side=side, corner=estimate())
    known = situation(Phase.DECELERATING, turning(side), side=side, corner=estimate())
    assert (stops.has_left, known.has_left) == (False, True)
    leaving, stopping = known.forecasts(106.0)[0], stops.forecasts(106.0)[0]
    assert leaving.leg.heading_rad == pytest.approx(-side * math.pi / 2.0)
    assert -side * leaving.positions([106.0])[0][1] == pytest.approx(2.0)
    # He needs 6.4 s to V, and the other 2 s to the stop and 8 from it.
    ahead_m = -side * (leaving.positions([130.0])[0] - stopping.positions([130.0])[0])[1]
    assert ahead_m == pytest.approx(2.0 + 20.0 * (24.0 - 6.4) + 12.0 * 6.4 - 20.0 * 14.0 - 80.0)


@pytest.mark.parametrize(
    ("motion", "sigma_mps"),
    [
        (turning(1), 1.5),  # as sure as positions alone make it
        (turning(-1), 0.1),  # to the other side
        (turning(1, vx=8.0), 0.1),  # not by 40 degrees yet
        (turning(1, vx=0.0, vy=2.5), 0.1),  # too slow to have a course
    ],
)
def test_who_may_still_stop_has_not_left(motion, sigma_mps):
    known = situation(Phase.DECELERATING, motion, corner=estimate())
    known.set_helicopter(motion, sigma_mps)
    assert not known.has_left


@pytest.mark.parametrize("phase", [phase for phase in Phase if phase is not Phase.DECELERATING])
def test_only_of_one_who_slows_it_is_asked_whether_he_has_left(phase):
    assert not situation(phase, turning(1), corner=estimate()).has_left
    assert not situation(Phase.DECELERATING, turning(1)).has_left


def test_standing_it_has_just_left_or_stands_on():
    known = situation(Phase.STOPPED, Motion(120.0, 80.0, 0.0, 0.0, 0.0), corner=estimate())
    leaving, standing = known.forecasts(120.0)
    assert leaving.positions([115.0])[0] == pytest.approx((80.0, 0.0))
    assert leaving.positions([140.0])[0][1] < -200.0
    assert standing.positions([500.0])[0] == pytest.approx((80.0, 0.0))


@pytest.mark.parametrize(("turn_deg", "believed"), [(-90, -90), (-60, -60), (90, 90), (-88, -90)])
def test_speeding_up_it_goes_where_it_is_going(turn_deg, believed):
    out = math.radians(turn_deg)
    there = Motion(
        115.0, 80.0 + 60.0 * math.cos(out), 60.0 * math.sin(out),
        15.0 * math.cos(out), 15.0 * math.sin(out),
    )  # fmt: skip
    known = situation(Phase.ACCELERATING, there, corner=estimate())
    for forecast in known.forecasts(115.0):
        assert math.degrees(forecast.leg.heading_rad) == pytest.approx(believed, abs=0.01)


def test_speeding_up_it_may_have_left_earlier_than_is_seen():
    """By two seconds, but not before it stood."""
    for stood_s, early_s in ((80.0, 2.0), (110.0, 1.0), (111.0, 0.0)):
        there = Motion(115.0, 80.0, -20.0, 0.0, -10.0)  # 4 s after it left
        known = situation(
            Phase.ACCELERATING, there, corner=replace(estimate(), stop_time_s=stood_s)
        )
        seen, *others = known.forecasts(115.0)
        assert len(others) == (early_s > 0.0)
        for early in others:
            assert early.positions([200.0])[0][1] == pytest.approx(
                seen.positions([200.0])[0][1] - 20.0 * early_s
            )
    fast = situation(Phase.ACCELERATING, Motion(115.0, 80.0, -90.0, 0.0, -20.0), corner=estimate())
    assert len(fast.forecasts(115.0)) == 1


def test_a_corner_that_was_none_is_forgotten():
    leg = LegEstimate(100.0, Pose(0.0, 0.0, 0.0), 20.0, 0.5, 0.001, 0.05)
    known = situation(
        Phase.DECELERATING, Motion(104.0, 60.0, 0.0, 12.0, 0.0), leg=leg, corner=estimate()
    )
    known.set_phase(Phase.ACCELERATING)
    assert known.went_on
    (forecast,) = known.forecasts(104.0)
    assert forecast.leg.heading_rad == pytest.approx(0.0)
    assert forecast.positions([130.0])[0][0] > 400.0


def test_a_young_leg_is_weighed_against_a_right_angle():
    noisy = LegEstimate(130.0, Pose(82.0, -200.0, math.radians(-94.0)), 17.0, 3.0, 0.05, 2.0)
    there = Motion(130.0, 81.0, -200.0, 0.0, -20.0)
    known = situation(Phase.CRUISE, there, leg=noisy, corner=estimate())
    forecast = known.forecasts(130.0)[0]
    assert math.degrees(forecast.leg.heading_rad) == pytest.approx(-91.3, abs=0.6)
    assert forecast.speed_mps == pytest.approx(19.7, abs=0.1)
    known.set_leg(LegEstimate(150.0, noisy.foot, 17.0, 0.3, 0.001, 0.05))
    forecast = known.forecasts(130.0)[0]
    assert math.degrees(forecast.leg.heading_rad) == pytest.approx(-94.0, abs=0.1)
    assert forecast.speed_mps == pytest.approx(17.0, abs=0.05)


def test_new_corners_are_counted_and_refinements_are_not():
    known = Situation(CornerParameters(), PatternTerms(side=1))
    assert known.set_corner(estimate())
    assert not known.set_corner(estimate(time_s=105.0))
    assert known.set_corner(estimate(time_s=204.0, stop_time_s=208.0))
    assert known.corners_seen == 2


def test_the_corner_may_be_told_before_the_phase():
    leg = LegEstimate(104.0, Pose(0.0, 0.0, 0.0), 20.0, 0.5, 0.001, 0.05)
    slowing = Motion(104.0, 60.0, 0.0, 10.0, 0.0)
    known = situation(Phase.CRUISE, slowing, leg=leg)
    known.set_corner(estimate())
    early = known.forecasts(104.0)
    known.set_phase(Phase.DECELERATING)
    assert known.forecasts(104.0) == early
    assert not known.went_on
    assert early[0].leg.heading_rad == pytest.approx(-math.pi / 2.0)


def test_a_corner_not_predicted_yet_is_not_taken_for_the_one_before():
    leg = LegEstimate(200.0, Pose(80.0, -1500.0, -math.pi / 2.0), 20.0, 0.5, 0.001, 0.05)
    before = estimate(time_s=104.0, stop_time_s=108.0)
    known = situation(
        Phase.CRUISE, Motion(200.0, 80.0, -1500.0, 0.0, -15.0), leg=leg, corner=before
    )
    known.set_phase(Phase.DECELERATING)
    going, stopping = known.forecasts(200.0)
    assert going.positions([210.0])[0] == pytest.approx((80.0, -1700.0), abs=5.0)
    assert stopping.positions([230.0])[0][1] == pytest.approx(-1580.0, abs=5.0)


def rolled_corner(*, learnt=True):
    """A situation in which a corner was rolled: at cruise again 6 s after it began, not 16."""
    known = situation(Phase.CRUISE, Motion(100.0, 0.0, 0.0, 20.0, 0.0))
    known.set_phase(Phase.DECELERATING)
    known.set_corner(estimate())
    known.set_helicopter(Motion(107.0, 85.0, -30.0, 0.0, -15.0))
    known.set_phase(Phase.ACCELERATING)
    # It passed abeam of the stop at 104 + 1, and is on its new leg as if it had left at 106.
    foot = Pose(80.0, -20.0 * (120.0 - 106.0), -math.pi / 2)
    leg = LegEstimate(120.0, foot, 20.0, 0.5, 0.001, 0.1 if learnt else 2.0)
    known.set_phase(Phase.CRUISE)
    known.set_leg(leg)
    known.set_helicopter(Motion(200.0, 80.0, -1880.0, 0.0, -20.0))
    return known


def test_a_corner_that_is_rolled_is_no_slow_down_that_was_given_up():
    assert not rolled_corner().went_on
    given_up = situation(Phase.CRUISE, Motion(100.0, 0.0, 0.0, 20.0, 0.0))
    given_up.set_phase(Phase.DECELERATING)
    given_up.set_corner(estimate())
    given_up.set_phase(Phase.CRUISE)
    assert given_up.went_on


def next_corner():
    stop = Pose(80.0, -2000.0, -math.pi / 2)
    return estimate(time_s=203.0, stop=stop, stop_time_s=208.0)


def test_a_pilot_who_rolls_his_corners_is_expected_to_roll_the_next():
    known = rolled_corner()
    known.set_corner(next_corner())
    # The stop before was passed at 104, had it been cruised to, and left, as if cruised, at 106.
    assert known.estimate.stop == next_corner().stop
    assert known.estimate.speed_mps / known.estimate.accel_mps2 == pytest.approx(2.0, abs=0.01)
    passed = known.estimate.stop_time_s - 0.5 * 2.0
    assert passed == pytest.approx(208.0 - 4.0, abs=0.01)


def test_one_who_gets_slower_than_that_is_expected_to_stop():
    known = rolled_corner()
    known.set_corner(next_corner())
    known.set_helicopter(Motion(207.0, 80.0, -1998.0, 0.0, -3.0))
    known.set_corner(replace(next_corner(), time_s=207.0))
    assert known.estimate.accel_mps2 == 2.5
    assert known.corners_seen == 2


def test_nothing_is_learnt_of_a_leg_that_is_not_known_yet():
    known = rolled_corner(learnt=False)
    known.set_corner(next_corner())
    assert known.estimate.accel_mps2 == 2.5


def test_the_same_estimate_told_again_is_the_same_corner():
    known = situation(Phase.CRUISE, Motion(100.0, 0.0, 0.0, 20.0, 0.0))
    assert known.set_corner(estimate())
    planned = known.estimate
    assert not known.set_corner(estimate())
    assert known.estimate is planned
    # Refined, its onset may come to lie behind the stop that was told first: still the same.
    assert not known.set_corner(estimate(time_s=107.5, stop_time_s=110.5, accel_mps2=20.0))
    assert known.corners_seen == 1


def test_who_stands_for_longer_than_in_a_corner_hovers_until_it_is_seen_to_leave():
    situation = Situation(CornerParameters(), PatternTerms(side=1))
    for second in range(14):
        situation.set_helicopter(Motion(float(second), 0.0, 0.0, 0.3, 0.0))
        situation.set_phase(Phase.STOPPED)
        assert situation.hovers is (second > HOVERS_S)
    situation.set_helicopter(Motion(14.0, 3.0, 0.0, HOVER_MPS + 1.0, 0.0))
    assert situation.has_hovered
    assert not situation.hovers
    situation.set_phase(Phase.ACCELERATING)
    assert not situation.has_hovered


def cornering(situation, heading_rad, stop_s):
    """Tell of a leg and the corner at its end."""
    situation.set_helicopter(Motion(stop_s - 4.0, 0.0, 0.0, 20.0, 0.0))
    leg = LegEstimate(stop_s - 20.0, Pose(0.0, 0.0, heading_rad), 20.0, 1.0, 0.01, 0.1)
    situation.set_leg(leg)
    situation.set_phase(Phase.CRUISE)
    stop = Pose(0.0, 0.0, heading_rad)
    told = {"time_s": stop_s - 4.0, "stop_time_s": stop_s, "stop": stop}
    situation.set_corner(estimate(**told))


@pytest.mark.parametrize(
    ("pattern", "places_m"),
    [
        ("expanding_square", [(250.0, 250.0)] * 4),
        ("sector", [(250.0, 250.0)] * 4),
        ("parallel_track", [(250.0, -350.0), (-350.0, -250.0)] * 2),
    ],
)
def test_every_corner_has_its_turn_and_places_before_and_after_it(pattern, places_m):
    situation = Situation(CornerParameters(), PatternTerms(pattern, 1))
    heading, found = 0.5 * math.pi, []
    for k in range(4):
        cornering(situation, heading, 100.0 * (k + 1))
        expected = situation.progress.here
        found.append(situation.places_m)
        assert situation.turn_side == (-1 if expected.turn_rad > 0.0 else 1)
        slot = situation.slot_of(Pose(0.0, 0.0, heading))
        across_m = -situation.turn_side * places_m[k][0]
        assert Pose(0.0, 0.0, heading).across(*slot[:2]) == pytest.approx(across_m)
        heading += expected.turn_rad
    assert found == [pytest.approx(places) for places in places_m]
    assert situation.progress.leg == 3


def test_how_much_is_left_of_a_leg_and_of_the_one_to_come():
    """Of the leg being flown, what is not flown yet; of the next, all of it; of none, nothing."""
    known = Situation(CornerParameters(), PatternTerms(leg_m=2000.0, spacing_m=500.0))
    assert known.left_m(0.0) == 2000.0
    known.set_helicopter(Motion(0.0, 0.0, 0.0, 20.0, 0.0))
    known.set_leg(LegEstimate(0.0, Pose(0.0, 0.0, 0.0), 20.0, 0.5, 0.001, 0.02))
    known.set_helicopter(Motion(30.0, 600.0, 0.0, 20.0, 0.0))
    assert known.left_m(0.0) == pytest.approx(1400.0)
    assert known.left_m(-0.5 * math.pi) == pytest.approx(2000.0)
    known.set_helicopter(Motion(120.0, 2400.0, 0.0, 20.0, 0.0))
    assert known.left_m(0.0) == 0.0
    assert Situation(CornerParameters(), PatternTerms()).left_m(0.0) == 0.0
