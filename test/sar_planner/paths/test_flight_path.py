import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose, wrap_angle
from sar_planner.paths.flight_path import Arc, CornerFrame, FlightPath, Straight

lengths = st.floats(0.0, 2000.0)
coordinates = st.floats(-5000.0, 5000.0)
headings = st.floats(-math.pi, math.pi)
turns = st.floats(-2 * math.pi, 2 * math.pi).filter(lambda a: abs(a) > 1e-3)
segments = st.lists(
    st.one_of(st.builds(Straight, lengths), st.builds(Arc, st.floats(20.0, 300.0), turns)),
    min_size=1,
    max_size=6,
)
poses = st.builds(Pose, coordinates, coordinates, headings)


@given(st.floats(-100.0, 100.0))
def test_wrap_angle_keeps_direction(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


@given(poses, segments)
def test_path_walked_in_small_steps_agrees_with_end_and_length(start, parts):
    path = FlightPath.of(start, parts)
    points = path.sample(1.0)
    assert points[0] == pytest.approx((start.x_m, start.y_m))
    assert points[-1] == pytest.approx((path.end.x_m, path.end.y_m), abs=1e-6)
    walked = np.hypot(*np.diff(points, axis=0).T).sum()
    assert walked == pytest.approx(path.length_m, rel=1e-3, abs=1e-6)
    assert path.length_m == pytest.approx(sum(part.length_m for part in parts), abs=1e-6)


@given(poses, segments)
def test_path_has_no_kinks(start, parts):
    path = FlightPath.of(start, parts)
    step = 0.01
    for at, pose in zip(
        np.cumsum([s.length_m for s in path.segments]), path.joints[1:], strict=True
    ):
        before, after = path.points([at - step, at + step])
        assert math.dist(before, after) == pytest.approx(2 * step, rel=1e-3)
        assert math.dist(before, (pose.x_m, pose.y_m)) == pytest.approx(step, rel=1e-2)


def test_path_goes_straight_on_beyond_its_ends():
    path = FlightPath.of(Pose(0, 0, 0), [Straight(10.0), Arc(10.0, math.pi / 2)])
    assert path.points([-5.0])[0] == pytest.approx((-5.0, 0.0))
    assert path.points([path.length_m + 7.0])[0] == pytest.approx((20.0, 17.0))


def test_negative_straight_is_refused():
    with pytest.raises(ValueError, match=r"straight of -1\.000 m"):
        FlightPath.of(Pose(0, 0, 0), [Straight(-1.0)])


def test_left_arc_turns_left():
    end = FlightPath.of(Pose(0, 0, 0), [Arc(100.0, math.pi / 2)]).end
    assert (end.x_m, end.y_m) == pytest.approx((100.0, 100.0))
    assert end.heading_rad == pytest.approx(math.pi / 2)


@given(poses, poses, st.sampled_from([1, -1]))
def test_corner_frame_round_trip(origin, pose, side):
    frame = CornerFrame(origin, side)
    back = frame.pose_to_map(frame.to_frame(pose))
    assert (back.x_m, back.y_m) == pytest.approx((pose.x_m, pose.y_m), abs=1e-6)
    assert wrap_angle(back.heading_rad - pose.heading_rad) == pytest.approx(0.0, abs=1e-9)


@given(poses, st.sampled_from([1, -1]), segments)
def test_path_and_points_go_to_the_map_alike(origin, side, parts):
    frame = CornerFrame(origin, side)
    path = FlightPath.of(Pose(-300.0, -250.0, 0.0), parts)
    at = np.linspace(0.0, path.length_m, 7)
    assert frame.path_to_map(path).points(at) == pytest.approx(
        frame.points_to_map(path.points(at)), abs=1e-6
    )


def test_left_turn_frame_mirrors():
    frame = CornerFrame(Pose(0, 0, 0), -1)
    assert frame.to_frame(Pose(5.0, 250.0, 0.1)).y_m == -250.0
    with pytest.raises(ValueError, match="turn_side 0"):
        CornerFrame(Pose(0, 0, 0), 0)
