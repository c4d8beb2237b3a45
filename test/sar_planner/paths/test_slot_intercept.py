"""Captures end where they should, with the detour asked for."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.paths.slot_intercept import (
    STRAIGHT_P,
    STRAIGHT_Q,
    STRAIGHT_Y,
    InterceptProblem,
    PathBatch,
)

ANGLES = st.floats(-math.pi, math.pi)
PLACES = st.floats(-1500.0, 1500.0)


@settings(max_examples=80, deadline=None)
@given(
    PLACES, PLACES, ANGLES, st.floats(0.8, 1.6), st.floats(-800.0, 1500.0), st.floats(-1.4, 1.4),
    st.sampled_from([(STRAIGHT_Y, STRAIGHT_Q), (STRAIGHT_P, STRAIGHT_Y), (STRAIGHT_P, STRAIGHT_Q)]),
)  # fmt: skip
def test_solved_captures_have_the_detour_and_end_on_the_track(x, y, h, factor, detour, last, pair):
    problem = InterceptProblem(Pose(x, y, h), 100.0, factor, last)
    grid = np.linspace(-3.0, 3.0, 9)
    turn_1, turn_2 = (axis.ravel() for axis in np.meshgrid(grid, grid))
    for side in (1, -1):
        batch = problem.solve(problem.arcs(turn_1, turn_2, side), detour, straights=pair)
        assert (batch.rows[:, [STRAIGHT_P, STRAIGHT_Y, STRAIGHT_Q]] >= 0.0).all()
        assert problem.detours_m(batch) == pytest.approx(np.full(len(batch), detour), abs=1e-4)
        assert batch.ends[:, 1] == pytest.approx(np.zeros(len(batch)), abs=1e-4)
        for i in range(min(len(batch), 3)):
            path = batch.path(i)
            assert math.cos(path.end.heading_rad) == pytest.approx(1.0)
            assert path.length_m == pytest.approx(batch.lengths_m[i], abs=1e-6)


@settings(max_examples=40, deadline=None)
@given(ANGLES, st.lists(st.floats(-2.0, 2.0), min_size=4, max_size=4), st.floats(0.0, 300.0))
def test_points_of_a_batch_are_those_of_its_paths(heading, turns, straight):
    row = [straight, turns[0], 0.5 * straight, turns[1], straight, turns[2], turns[3]]
    batch = PathBatch(Pose(10.0, -20.0, heading), 80.0, np.array([row]))
    distances = np.linspace(0.0, float(batch.lengths_m[0]) + 100.0, 60)
    assert batch.points(distances)[0] == pytest.approx(batch.path(0).points(distances), abs=1e-6)
    each = batch.points(distances[None, :])
    assert each == pytest.approx(batch.points(distances))


def test_reach_leaves_out_what_cannot_get_there():
    problem = InterceptProblem(Pose(0.0, -300.0, 0.0), 100.0)
    left = problem.reach(problem.arcs(np.array([0.5]), np.array([0.0]), -1))
    right = problem.reach(problem.arcs(np.array([-0.5]), np.array([0.0]), 1))
    assert len(left) == 1
    assert left.ends[0, 1] == pytest.approx(0.0, abs=1e-9)
    assert len(right) == 0
