"""Waypoints for an L1-guided autopilot."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.guidance.l1_waypoints import L1Tuning, make_guide
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.paths.flight_path import Arc, FlightPath, Straight

TUNING = L1Tuning(15.0)


def path(*segments):
    return FlightPath.of(Pose(0.0, 0.0, 0.3), segments)


def test_straight_path_has_no_offset_and_two_waypoints_at_most():
    guide = make_guide(path(Straight(1000.0)), TUNING, 20.0)
    assert np.abs(guide.offsets_m).max() == 0.0
    assert len(guide.waypoints(30.0)) == 1


@given(st.floats(8.0, 15.0), st.floats(80.0, 150.0), st.sampled_from([1, -1]))
def test_steady_turn_settles_inside_it(period, radius, side):
    tuning = L1Tuning(period)
    guide = make_guide(path(Straight(300.0), Arc(radius, side * 1.9 * math.pi)), tuning, 20.0)
    steady = tuning.offset_m(side / radius, 20.0)
    assert math.copysign(1.0, steady) == side
    assert guide.offsets_m[-30] == pytest.approx(steady, rel=0.02)
    # L1^2 k / (4 damping^2 share)
    by_hand = (0.75 * period * 20.0 / math.pi) ** 2 / (4 * 0.75**2 * 0.8) / radius
    assert abs(steady) == pytest.approx(by_hand)


def test_offset_begins_where_the_roll_must():
    guide = make_guide(path(Straight(300.0), Arc(100.0, 1.0), Straight(500.0)), TUNING, 20.0)
    assert guide.offset_at(290.0) == pytest.approx(0.0, abs=1e-6)
    assert guide.offset_at(330.0) > 5.0
    assert guide.offset_at(850.0) < 1.0


def test_guide_goes_on_from_an_offset():
    turn = path(Arc(100.0, 2.0), Straight(300.0))
    assert make_guide(turn, TUNING, 20.0).offset_at(0.0) > 20.0
    assert make_guide(turn, TUNING, 20.0, offset_m=3.0).offset_at(0.0) == 3.0


@given(st.floats(0.0, 900.0))
def test_waypoints_begin_where_asked(begin):
    guide = make_guide(path(Straight(300.0), Arc(100.0, 2.0), Straight(600.0)), TUNING, 20.0)
    points = guide.waypoints(30.0, from_m=begin)
    everything = guide.waypoints(30.0)
    assert np.allclose(points, everything[-len(points) :])


def test_slow_ground_speed_needs_less_offset():
    turn = path(Arc(100.0, 1.5 * math.pi))
    upwind = AirEnvelope(20.0, 20.0, (-6.0, 0.0))
    assert abs(make_guide(turn, TUNING, 20.0, air=upwind).offsets_m).min() < 15.0


def test_longest_period():
    assert L1Tuning(15.0).longest_period_s(100.0, 20.0) == pytest.approx(17.77, abs=0.01)


@pytest.mark.parametrize("spacing", [8.0, 15.0, 30.0])
def test_no_leg_is_over_before_it_begins(spacing):
    """Flown on the path, every leg still has its finish line ahead when the one before it ends."""
    snake = path(Arc(100.0, 0.6), Arc(100.0, -1.2), Straight(200.0))
    guide = make_guide(snake, TUNING, 20.0, offset_m=-45.0)
    begin = snake.pose_at(0.0).offset(0.0, -45.0)
    last, at = np.array((begin.x_m, begin.y_m)), 0.0
    points = guide.waypoints(spacing)
    assert len(points) > 5
    for point in points[:-1]:
        way = (point - last) / np.hypot(*(point - last))
        stations = np.arange(at, snake.length_m, 1.0)
        left = (point - snake.points(stations)) @ way
        assert left[0] > 8.0
        at = float(stations[np.argmax(left <= 0.0)])
        last = point
