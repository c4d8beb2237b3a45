"""The least distance of a path to a forecast is bounded from below, and closely."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_planner.paths.apart_kernels import (
    ROUNDING_M,
    TOLERANCE_M,
    from_origin,
    knots_for,
    least_until,
)

PLACES = st.floats(-500.0, 500.0)
ANGLES = st.floats(-math.pi, math.pi)
SPEEDS = st.floats(10.0, 35.0)


def straight(x, y, heading):
    return np.array([[x], [y], [heading], [0.0], [0.0]])


def turning(x, y, heading, radius):
    return np.array([[x], [y], [heading], [1.0 / radius], [0.0]])


def flying(x, y, heading, speed, accel=0.0, time_s=0.0):
    values = (time_s, x, y, math.cos(heading), math.sin(heading), speed, accel)
    return np.array(values)[:, None]


def bound(parts, mps, forecast, for_s, enough_m=0.0, sure_m=math.inf, start_s=0.0):
    pace = (0.0, mps, 1e4, mps, mps)
    knots = knots_for(parts.shape[1], forecast.shape[1])
    return least_until(parts, pace, forecast, start_s, for_s, enough_m, sure_m, knots)


@given(PLACES, PLACES, PLACES, PLACES)
def test_how_far_a_straight_is_from_the_origin(ax, ay, bx, by):
    share = np.linspace(0.0, 1.0, 4001)
    sampled = np.hypot(ax + share * (bx - ax), ay + share * (by - ay)).min()
    found = from_origin(ax, ay, bx, by)
    assert found <= sampled + 1e-9
    assert found >= sampled - math.hypot(bx - ax, by - ay) / 8000.0 - 1e-9


@given(PLACES, PLACES, ANGLES, SPEEDS, ANGLES, SPEEDS)
def test_both_straight_and_uniform_it_is_the_least_distance_itself(x, y, h, mps, there_h, there):
    """Of two uniform motions, by calculus."""
    velocity = mps * np.array((math.cos(h), math.sin(h)))
    velocity -= there * np.array((math.cos(there_h), math.sin(there_h)))
    gap = np.array((x, y))
    fast = velocity @ velocity
    at_s = min(max(-(gap @ velocity) / fast, 0.0), 60.0) if fast > 1e-12 else 0.0
    exact = math.hypot(*(gap + at_s * velocity))
    found = bound(straight(x, y, h), mps, flying(0.0, 0.0, there_h, there), 60.0)
    assert found == pytest.approx(max(exact - ROUNDING_M, 0.0), abs=1e-7)


@given(PLACES, PLACES, ANGLES, SPEEDS, st.floats(40.0, 300.0), ANGLES, st.floats(-3.0, 3.0))
def test_a_turn_beside_a_parabola(x, y, h, mps, radius, there_h, accel):
    found = bound(turning(x, y, h, radius), mps, flying(0.0, 0.0, there_h, 20.0, accel), 30.0)
    times = np.linspace(0.0, 30.0, 30001)
    turned = h + times * mps / radius
    run = 20.0 * times + 0.5 * accel * times**2
    gap_x = x + radius * (np.sin(turned) - math.sin(h)) - run * math.cos(there_h)
    gap_y = y - radius * (np.cos(turned) - math.cos(h)) - run * math.sin(there_h)
    sampled = np.hypot(gap_x, gap_y).min()
    assert sampled - TOLERANCE_M - 0.08 <= found <= sampled


@given(PLACES, PLACES, ANGLES, st.floats(40.0, 300.0), st.floats(0.0, 400.0))
def test_whether_a_distance_is_kept_is_told_apart_from_how_much(x, y, h, radius, asked):
    parts, forecast = turning(x, y, h, radius), flying(0.0, 0.0, 0.0, 20.0, -1.0)
    full = bound(parts, 22.0, forecast, 25.0)
    kept = bound(parts, 22.0, forecast, 25.0, asked, asked)
    if full >= asked:
        assert asked - TOLERANCE_M - ROUNDING_M <= kept <= full + TOLERANCE_M + ROUNDING_M
    elif full < asked - TOLERANCE_M - ROUNDING_M:
        assert kept < asked


def test_before_its_first_stretch_the_helicopter_cruised():
    # It slows from 10 s on, and would be hit at 5 s.
    forecast = flying(0.0, 0.0, 0.0, 20.0, -2.0, time_s=10.0)
    parts = straight(-100.0, -100.0, 0.5 * math.pi)
    assert bound(parts, 20.0, forecast, 30.0) < TOLERANCE_M
    assert bound(parts, 20.0, forecast, 4.0) == pytest.approx(math.hypot(20.0, 20.0), abs=1e-3)


def test_time_may_begin_anywhere():
    parts, forecast = turning(0.0, -300.0, 0.3, 100.0), flying(0.0, 0.0, 0.0, 20.0, -1.0)
    late = forecast.copy()
    late[0] += 1.7e9
    there = bound(parts, 20.0, late, 15.0, start_s=1.7e9)
    assert there == pytest.approx(bound(parts, 20.0, forecast, 15.0), abs=1e-5)


def test_what_is_not_finite_is_no_distance():
    parts, forecast = straight(0.0, -300.0, 0.0), flying(0.0, 0.0, 0.0, 20.0)
    lost = flying(math.nan, 0.0, 0.0, 20.0)
    assert bound(parts, 20.0, forecast, 30.0) == pytest.approx(300.0, abs=1e-3)
    assert not bound(parts, 20.0, lost, 30.0) >= 0.0
    assert bound(parts, 20.0, forecast, math.nan) == 0.0
