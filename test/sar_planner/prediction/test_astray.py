"""A helicopter that leaves its corner another way, against one that is walked step by step."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate
from sar_planner.prediction.astray import LEAVES_MPS2, LOOK_S, STANDS_S, astray_apart_m

STEP_S = 0.01


def corner_at(stop, stop_s, accel=2.5):
    return CornerEstimate(0.0, stop, stop_s, 20.0, accel, np.zeros((2, 2)), 0.0, 0.0)


def walked(corner, until_s, begun_s, way):
    """Where it is at a time that slows as expected until another, then goes on, or out."""
    x, speed, out, t = -20.0 * corner.stop_time_s, 20.0, 0.0, 0.0
    x += 0.5 * 20.0**2 / corner.accel_mps2
    onset_s = corner.stop_time_s - 20.0 / corner.accel_mps2
    while t < until_s:
        astray = t >= begun_s
        if astray and way == "on":
            speed = min(speed + LEAVES_MPS2 * STEP_S, 20.0)
        elif t >= onset_s and t < corner.stop_time_s:
            speed = max(speed - corner.accel_mps2 * STEP_S, 0.0)
        elif astray and t >= corner.stop_time_s:
            out = min(out + LEAVES_MPS2 * STEP_S, 20.0)
            speed = 0.0
        x += speed * STEP_S if t < corner.stop_time_s or way == "on" else 0.0
        t += STEP_S
    away = max(until_s - max(begun_s, corner.stop_time_s), 0.0) if way == "out" else 0.0
    return x, 0.5 * LEAVES_MPS2 * away**2


@pytest.mark.parametrize("until_s", [9.0, 12.0, 15.0, 18.0, 22.0])
@pytest.mark.parametrize("turn_rad", [-0.5 * math.pi, 0.5 * math.pi])
def test_it_goes_on_or_out_for_as_long_as_is_looked_ahead(until_s, turn_rad):
    corner = corner_at(Pose(0.0, 0.0, 0.0), 8.0)
    begun_s = max(until_s - LOOK_S, 2.0)
    (on, _), (stood, out) = (walked(corner, until_s, begun_s, way) for way in ("on", "out"))
    for uav in ((200.0, 180.0), (60.0, math.copysign(250.0, -turn_rad)), (0.0, 150.0)):
        places = (on, 0.0), (min(on, 0.0), 0.0), (stood, math.copysign(out, -turn_rad))
        # Before it stands it is astray only by going on.
        places = places[:2] if until_s <= corner.stop_time_s else places
        expected = min(math.dist(uav, one) for one in places)
        at = np.array((until_s,)), np.array((uav,))
        assert astray_apart_m(*at, corner, turn_rad, 2.0) == pytest.approx(expected, abs=1.0)


@given(st.floats(-math.pi, math.pi), st.floats(-500.0, 500.0), st.floats(-500.0, 500.0))
def test_it_is_the_same_wherever_the_corner_is(heading, x_m, y_m):
    times = np.linspace(5.0, 25.0, 41)
    points = np.column_stack((-100.0 + 18.0 * times, np.full_like(times, 250.0)))
    here, there = Pose(0.0, 0.0, 0.0), Pose(x_m, y_m, heading)
    turned = np.array(
        ((math.cos(heading), math.sin(heading)), (-math.sin(heading), math.cos(heading)))
    )
    moved = points @ turned + np.array((x_m, y_m))
    one = astray_apart_m(times, points, corner_at(here, 12.0), -0.5 * math.pi, 5.0)
    other = astray_apart_m(times, moved, corner_at(there, 12.0), -0.5 * math.pi, 5.0)
    assert other == pytest.approx(one)


def test_once_it_must_have_left_it_cannot_go_astray():
    corner = corner_at(Pose(0.0, 0.0, 0.0), 8.0)
    late_s = corner.stop_time_s + STANDS_S + LOOK_S + 1.0
    assert math.isinf(astray_apart_m(np.array((late_s,)), np.zeros((1, 2)), corner, -1.5, 2.0))
