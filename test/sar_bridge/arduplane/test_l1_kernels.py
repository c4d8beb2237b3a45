"""Compiled motion against the plain formulas of uniformly accelerated motion."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.arduplane.l1_kernels import LEAVES_LEFT, LEAVES_RIGHT, STANDS, stop_and_turn
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
