import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.guidance.path_waypoints import arc_offsets, path_waypoints, thinned
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import Arc, FlightPath, Straight
from sar_planner.rules.paper_automaton import PaperAutomaton

CURVE = PaperAutomaton(CornerParameters()).plan(0.0).path


def test_arc_ends_only_are_the_joints():
    points = path_waypoints(CURVE, 0.0)
    assert points == pytest.approx(np.array([(p.x_m, p.y_m) for p in CURVE.joints[1:]]))


@given(st.floats(5.0, 60.0))
def test_spacing_is_kept_on_arcs(spacing):
    path = FlightPath.of(Pose(0, 0, 0), [Arc(100.0, -math.pi)])
    points = np.vstack(((0.0, 0.0), path_waypoints(path, spacing)))
    assert np.hypot(*np.diff(points, axis=0).T).max() <= spacing * 1.02


@given(st.floats(0.2, 2 * math.pi), st.floats(2.0, 40.0))
def test_mean_radius_of_the_polygon_is_the_arcs(turn, spacing):
    chords, radius = arc_offsets(Arc(100.0, turn), spacing)
    half = turn / chords / 2
    angles = np.linspace(-half, half, 2001)
    mean = (radius * math.cos(half) / np.cos(angles)).mean()
    assert mean == pytest.approx(100.0, rel=1e-3)


def test_waypoints_behind_are_left_out():
    path = FlightPath.of(Pose(0, 0, 0), [Straight(100.0), Arc(50.0, 1.0), Straight(30.0)])
    assert len(path_waypoints(path, 10.0, from_m=120.0)) < len(path_waypoints(path, 10.0))
    assert path_waypoints(path, 10.0, from_m=1000.0).shape == (0, 2)


@pytest.mark.parametrize("rounding", [-1e-9, 0.0, 1e-9])
def test_a_lead_in_that_ends_where_the_list_begins_is_left_out_whatever_the_rounding(rounding):
    path = FlightPath.of(Pose(0, 0, 0), [Straight(50.0), Arc(100.0, 1.0)])
    points = path_waypoints(path, 10.0, from_m=50.0 + rounding)
    assert len(points) == 10
    assert points[0][0] > 55.0


def test_points_on_top_of_each_other_are_thinned_and_the_last_stays():
    points = np.array([[0.0, 0.0], [0.01, 0.0], [3.0, 0.0], [40.0, 0.0], [41.0, 0.0]])
    assert thinned(points, 5.0).tolist() == [[0.0, 0.0], [41.0, 0.0]]
    assert thinned(points[:1], 5.0).tolist() == [[0.0, 0.0]]
    assert thinned(points, 0.005).tolist() == points.tolist()
