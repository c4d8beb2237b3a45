"""The radius that the UAV turns with, learnt while it turns."""

import math

import pytest

from sar_estimator.common.states import Motion
from sar_planner.guidance.turn_radius import TurnRadius, Turns

SPEED_MPS, STEP_S = 20.0, 0.1


def flown(parts, roll_lag_s=0.5, speed_mps=SPEED_MPS):
    """Yield the motions of a UAV told to turn so far [rad] with a radius [m], one by one."""
    time_s = x = y = course = rate = 0.0
    for turn_rad, radius_m in parts:
        wanted = math.copysign(speed_mps / radius_m, turn_rad)
        begun = course
        while abs(course - begun) < abs(turn_rad):
            rate += (1.0 - math.exp(-STEP_S / roll_lag_s)) * (wanted - rate)
            course += rate * STEP_S
            time_s += STEP_S
            x += speed_mps * STEP_S * math.cos(course)
            y += speed_mps * STEP_S * math.sin(course)
            yield Motion(time_s, x, y, speed_mps * math.cos(course), speed_mps * math.sin(course))


def learnt(parts, *, turns=None, told_m=100.0, **how):
    turns = turns or TurnRadius(100.0, 250.0, SPEED_MPS)
    found = [turns.watch(motion, told_m) for motion in flown(parts, **how)]
    return turns, sum(found)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_wide_turn_is_learnt_once_while_it_lasts(side):
    turns, times = learnt([(side * math.radians(115.0), 140.0)])
    assert times == 1
    assert turns.believed.radius_m == pytest.approx(1.1 * 140.0, rel=0.03)


@pytest.mark.parametrize("roll_lag_s", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("radius_m", [80.0, 100.0, 104.0])
def test_a_uav_that_turns_as_it_should_teaches_nothing(radius_m, roll_lag_s):
    parts = [(math.pi, radius_m), (-math.pi, radius_m), (0.6, radius_m)]
    turns, times = learnt(parts, roll_lag_s=roll_lag_s)
    assert times == 0
    assert turns.believed.radius_m == 100.0


def test_short_and_gentle_turns_teach_nothing():
    """Swings back onto a track, and what the tightest part of a turn was not."""
    gentle = [(0.9, 200.0), (-0.9, 300.0), (0.5, 1000.0)]
    partly = [(math.radians(80.0), 100.0), (math.radians(80.0), 160.0)]
    assert learnt(gentle)[1] == 0
    assert learnt(partly)[1] == 0


def test_what_was_learnt_is_flown_and_stays():
    """The path's own larger radius is not taken for another limit of the UAV."""
    turns, _ = learnt([(math.pi, 140.0)])
    radius = turns.believed.radius_m
    for parts in (
        [(math.pi, radius), (-math.pi, radius)],
        [(0.5, radius), (0.06, 2.5 * radius), (1.38, radius)],
        [(math.pi, 100.0)],
    ):
        assert learnt(parts, turns=turns, told_m=radius)[1] == 0
    assert turns.believed.radius_m == radius


def test_bounds():
    assert learnt([(math.pi, 300.0)])[0].believed.radius_m == 200.0
    kept = TurnRadius(220.0, 250.0, SPEED_MPS)
    assert learnt([(math.pi, 300.0)], turns=kept)[0].believed.radius_m == 220.0


def test_a_gap_ends_a_turn():
    turns = TurnRadius(100.0, 250.0, SPEED_MPS)
    for i, motion in enumerate(flown([(math.pi, 140.0)])):
        if i % 70 == 60:
            turns.forget_turn()
        turns.watch(motion.stamped(motion.time_s + 5.0 * (i > 100)), 100.0)
    assert turns.believed.radius_m == 100.0


def test_it_is_not_known_how_a_uav_turns_before_it_was_seen_to():
    turns, _ = learnt([(0.9, 100.0)])
    assert not turns.believed.is_sure
    turns, times = learnt([(math.radians(90.0), 100.0)])
    assert turns.believed == Turns(100.0)
    assert times == 0


def test_the_first_turn_teaches_sooner_once_it_tightens_no_more():
    assert learnt([(math.radians(75.0), 140.0)])[1] == 1
    seen, _ = learnt([(math.pi, 100.0)])
    assert learnt([(math.radians(75.0), 140.0)], turns=seen)[1] == 0


def test_slower_it_turns_tighter_as_its_bank_is_what_limits_it():
    turns, _ = learnt([(math.pi, 140.0)])
    radius = turns.believed.radius_m
    assert turns.believed.at_m(0.8) == pytest.approx(0.64 * radius)
    assert turns.believed.at_m(1.1) == pytest.approx(1.21 * radius)
    assert Turns(100.0).at_m(0.8) == 100.0


def test_one_that_makes_good_little_of_its_speed_is_not_slow():
    """It banks for all of its speed: what it flies at V is what is seen."""
    turns = TurnRadius(100.0, 250.0, SPEED_MPS)
    for motion in flown([(math.pi, 130.0)], speed_mps=0.6 * SPEED_MPS):
        told = motion._replace(vx_mps=motion.vx_mps / 0.6, vy_mps=motion.vy_mps / 0.6)
        turns.watch(told, 100.0)
    assert turns.believed.radius_m == pytest.approx(1.1 * 130.0, rel=0.03)


def test_until_it_is_seen_not_to():
    turns, _ = learnt([(math.pi, 140.0)])
    radius, tighter = turns.believed.radius_m, turns.believed.at_m(0.8)
    _, times = learnt([(math.pi, 140.0)], turns=turns, told_m=tighter, speed_mps=16.0)
    assert times == 1
    assert not turns.believed.by_bank
    assert turns.believed.radius_m == turns.believed.at_m(0.8) == radius


def test_wider_turns_that_it_is_told_to_fly_are_no_limit_of_its_own():
    turns, times = learnt([(math.pi, 180.0)], told_m=180.0)
    assert times == 0
    assert turns.believed == Turns(100.0)
