"""The radius that the UAV turns with, learnt while it turns."""

import math

import pytest

from sar_estimator.common.states import Motion
from sar_planner.guidance.turn_radius import TurnRadius

SPEED_MPS, STEP_S = 20.0, 0.1


def flown(parts, roll_lag_s=0.5):
    """Yield the motions of a UAV told to turn so far [rad] with a radius [m], one by one."""
    time_s = x = y = course = rate = 0.0
    for turn_rad, radius_m in parts:
        wanted = math.copysign(SPEED_MPS / radius_m, turn_rad)
        begun = course
        while abs(course - begun) < abs(turn_rad):
            rate += (1.0 - math.exp(-STEP_S / roll_lag_s)) * (wanted - rate)
            course += rate * STEP_S
            time_s += STEP_S
            x += SPEED_MPS * STEP_S * math.cos(course)
            y += SPEED_MPS * STEP_S * math.sin(course)
            yield Motion(time_s, x, y, SPEED_MPS * math.cos(course), SPEED_MPS * math.sin(course))


def learnt(parts, *, turns=None, **how):
    turns = turns or TurnRadius(100.0, 250.0)
    found = [turns.watch(motion) for motion in flown(parts, **how)]
    return turns, sum(found)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_wide_turn_is_learnt_once_while_it_lasts(side):
    turns, times = learnt([(side * math.radians(115.0), 140.0)])
    assert times == 1
    assert turns.radius_m == pytest.approx(1.1 * 140.0, rel=0.03)


@pytest.mark.parametrize("roll_lag_s", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("radius_m", [80.0, 100.0, 104.0])
def test_a_uav_that_turns_as_it_should_teaches_nothing(radius_m, roll_lag_s):
    parts = [(math.pi, radius_m), (-math.pi, radius_m), (0.6, radius_m)]
    turns, times = learnt(parts, roll_lag_s=roll_lag_s)
    assert times == 0
    assert turns.radius_m == 100.0


def test_short_and_gentle_turns_teach_nothing():
    """Swings back onto a track, and what the tightest part of a turn was not."""
    gentle = [(0.9, 200.0), (-0.9, 300.0), (0.5, 1000.0)]
    partly = [(math.radians(80.0), 100.0), (math.radians(80.0), 160.0)]
    assert learnt(gentle)[1] == 0
    assert learnt(partly)[1] == 0


def test_what_was_learnt_is_flown_and_stays():
    """The path's own larger radius is not taken for another limit of the UAV."""
    turns, _ = learnt([(math.pi, 140.0)])
    radius = turns.radius_m
    assert learnt([(math.pi, radius), (-math.pi, radius)], turns=turns)[1] == 0
    assert learnt([(0.5, radius), (0.06, 2.5 * radius), (1.38, radius)], turns=turns)[1] == 0
    assert learnt([(math.pi, 100.0)], turns=turns)[1] == 0
    assert turns.radius_m == radius


def test_bounds():
    assert learnt([(math.pi, 300.0)])[0].radius_m == 200.0
    kept = TurnRadius(220.0, 250.0)
    assert learnt([(math.pi, 300.0)], turns=kept)[0].radius_m == 220.0


def test_a_gap_ends_a_turn():
    turns = TurnRadius(100.0, 250.0)
    for i, motion in enumerate(flown([(math.pi, 140.0)])):
        if i % 120 == 60:
            turns.forget_turn()
        turns.watch(motion.stamped(motion.time_s + 5.0 * (i > 100)))
    assert turns.radius_m == 100.0
