"""Compiled motion against the plain formulas of uniformly accelerated motion."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.arduplane.l1_kernels import (
    LEAVES_LEFT,
    LEAVES_RIGHT,
    STANDS,
    apart,
    stop_and_turn,
)
from sar_estimator.common.pose import Pose

TIMES_S = 0.5 * np.arange(121)


@given(
    x=st.floats(-5e3, 5e3),
    y=st.floats(-5e3, 5e3),
    heading=st.floats(-math.pi, math.pi),
    in_s=st.floats(0.0, 40.0),
    slowing=st.floats(0.5, 4.0),
    departing=st.floats(0.5, 4.0),
    cruise=st.floats(5.0, 40.0),
    turn=st.floats(0.1, math.pi),
)
def test_it_brakes_to_the_stop_and_departs_turned_to_either_side(
    x, y, heading, in_s, slowing, departing, cruise, turn
):
    ways = stop_and_turn(TIMES_S, x, y, heading, in_s, slowing, departing, cruise, turn)
    assert ways.shape == (3, len(TIMES_S), 2)
    stop = Pose(x, y, heading)
    before = in_s >= TIMES_S
    braking_m = 0.5 * slowing * np.maximum(in_s - TIMES_S, 0.0) ** 2
    along = [stop.along(*point) for point in ways[STANDS]]
    assert np.allclose(along, -braking_m, atol=1e-6)
    for way, side in ((LEAVES_LEFT, 1.0), (LEAVES_RIGHT, -1.0)):
        assert np.allclose(ways[way][before], ways[STANDS][before])
        out = Pose(x, y, heading + side * turn)
        since = np.maximum(TIMES_S - in_s, 0.0)
        until = cruise / departing
        run_m = np.where(
            since < until,
            0.5 * departing * since**2,
            0.5 * departing * until**2 + cruise * (since - until),
        )
        gone = [out.along(*point) for point in ways[way][~before]]
        assert np.allclose(gone, run_m[~before], atol=1e-6)
        across = [out.across(*point) for point in ways[way][~before]]
        assert np.allclose(across, 0.0, atol=1e-6)


@given(st.integers(0, 10_000), st.floats(0.0, 5.0))
def test_a_step_is_as_near_as_it_comes_within(seed, bulge):
    rng = np.random.default_rng(seed)
    path, positions = rng.normal(0.0, 30.0, (2, 12, 2))
    distance, _ = apart(path, positions, np.zeros(12), 0.0, bulge)
    share = np.linspace(0.0, 1.0, 2001)[:, None]
    gaps = path - positions
    assert distance[0] == pytest.approx(math.hypot(*gaps[0]))
    for i in range(1, 12):
        within = np.hypot(*((1.0 - share) * gaps[i - 1] + share * gaps[i]).T).min()
        assert within - 0.1 <= distance[i] + bulge or distance[i] == 0.0
        assert distance[i] <= max(within - bulge, 0.0) + 1e-9


@given(st.floats(-300.0, 300.0), st.floats(-300.0, 300.0), st.floats(-3.0, 3.0))
def test_a_turn_is_no_nearer_than_its_steps_say(x, y, heading):
    """A UAV that turns with 8 m/s^2 past a helicopter that brakes with 2 m/s^2."""
    step, mps, rate = 0.5, 20.0, 0.4

    def gaps(times):
        course = heading + rate * times
        run = 20.0 * times - times**2
        east = x + mps / rate * (np.sin(course) - math.sin(heading)) - run
        return np.column_stack((east, y - mps / rate * (np.cos(course) - math.cos(heading))))

    seen = gaps(step * np.arange(17))
    found, _ = apart(seen, np.zeros((17, 2)), np.zeros(17), 0.0, 0.125 * step**2 * 10.0)
    true = np.hypot(*gaps(np.linspace(0.0, 8.0, 16001)).T).min()
    assert found.min() <= true + 1e-9
    assert found.min() >= true - 2.0 * 0.125 * step**2 * 10.0 - 0.01
