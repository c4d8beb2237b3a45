"""What a helicopter may do that follows no pattern."""

import math

import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion, Phase
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import FlightPath, Straight
from sar_planner.patterns.legs import PatternTerms
from sar_planner.prediction.free_flight import FreeFlight, Possible, least_apart_m
from sar_planner.prediction.situation import HOVERS_S, Situation

PLACE = (0.0, -2000.0)


def seen(motions, phase=Phase.CRUISE):
    """Return what watches a helicopter, after it was seen to do all this."""
    situation = Situation(CornerParameters(), PatternTerms(side=1))
    free = FreeFlight(situation, CornerParameters())
    for motion in motions:
        situation.set_helicopter(motion)
        situation.set_phase(phase)
        free.watch()
    return free


def straight(until_s=30, speed=20.0):
    return [Motion(float(t), speed * t, 0.0, speed, 0.0) for t in range(until_s)]


def circling(rate=0.1, radius_m=150.0, until_s=30):
    found = []
    for t in range(until_s):
        angle, speed = rate * t, abs(rate) * radius_m
        sign = math.copysign(1.0, rate)
        found.append(
            Motion(
                float(t),
                radius_m * math.cos(angle),
                radius_m * math.sin(angle),
                -sign * speed * math.sin(angle),
                sign * speed * math.cos(angle),
            )
        )
    return found


def test_one_that_flies_straight_does_not_circle_and_may_come_only_when_it_heads_there():
    free = seen(straight())
    assert free.turn_rate == 0.0
    heads = free.possible(29.0, (5000.0, 0.0), comes=False)
    elsewhere = free.possible(29.0, PLACE, comes=False)
    assert len(heads) == len(elsewhere) + 1
    ordered = free.possible(29.0, PLACE, comes=True)
    there = ordered[-1].forecast.positions([29.0 + 200.0])[0]
    assert there == pytest.approx(PLACE)


@pytest.mark.parametrize("rate", [0.1, -0.1, 0.06])
def test_one_that_circles_is_expected_to_go_on_so(rate):
    motions = circling(rate)
    free = seen(motions)
    assert free.turn_rate == pytest.approx(rate, rel=0.05)
    *_, onward, turning = free.possible(29.0, PLACE, comes=False)
    assert onward.for_s < 20.0
    for later in circling(rate, until_s=60)[29:]:
        there = turning.forecast.positions([later.time_s])[0]
        assert math.dist(there, (later.x_m, later.y_m)) < 12.0


def test_a_turn_that_has_ended_counts_no_more():
    motions = circling()
    last = motions[-1]
    motions += [last.after(float(t))._replace(time_s=29.0 + t) for t in range(1, 20)]
    assert seen(motions).turn_rate == 0.0


def test_one_that_stands_circles_nothing_though_its_course_turns():
    noise = [Motion(float(t), 0.0, 0.0, math.cos(t), math.sin(t)) for t in range(30)]
    assert seen(noise).turn_rate == 0.0


def test_one_that_hovers_is_taken_to_stand_until_it_is_seen_to_leave():
    stands = [Motion(float(t), 5.0, 7.0, 0.1, 0.0) for t in range(round(HOVERS_S) + 5)]
    free = seen(stands, Phase.STOPPED)
    now_s = stands[-1].time_s
    (only,) = free.possible(now_s, PLACE, comes=True)
    assert only.forecast.positions([now_s + 60.0])[0] == pytest.approx((5.0, 7.0))
    leaves = [*stands, Motion(now_s + 1.0, 8.0, 7.0, 8.0, 0.0)]
    assert len(seen(leaves, Phase.STOPPED).possible(now_s + 1.0, PLACE, comes=False)) == 2


def test_nothing_is_possible_of_one_that_was_never_seen():
    assert seen([]).possible(0.0, PLACE, comes=True) == ()


def test_a_forecast_counts_for_as_long_as_it_is_believed():
    free = seen(straight())
    towards = Possible(free.possible(29.0, PLACE, comes=False)[1].forecast)
    # Head on: they meet in the middle.
    path = FlightPath.of(Pose(1580.0, 0.0, math.pi), (Straight(1000.0),))
    assert least_apart_m([towards], path, 29.0, 20.0) < 10.0
    briefly = Possible(towards.forecast, 12.0)
    assert least_apart_m([briefly], path, 29.0, 20.0) > 450.0
    assert least_apart_m([briefly, towards], path, 29.0, 20.0) < 10.0
    assert least_apart_m([], path, 29.0, 20.0) == math.inf
