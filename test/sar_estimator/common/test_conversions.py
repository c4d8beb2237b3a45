import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nav_msgs.msg import Path

from sar_estimator.common import conversions as m
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, MotionEstimate

values = st.floats(-1e5, 1e5)
speeds = st.floats(-80.0, 80.0)
sigmas = st.floats(1e-6, 1e3)


@given(st.floats(0.0, 2e9), values, values, speeds, speeds, st.floats(-3.1, 3.1))
def test_motion_round_trip(time_s, x, y, vx, vy, yaw):
    motion = Motion(time_s, x, y, vx, vy)
    back = m.odometry_to_motion(m.motion_to_odometry(motion, child="uav", yaw_rad=yaw))
    assert back.time_s == pytest.approx(time_s, abs=1e-6)
    assert (back.x_m, back.y_m) == (x, y)
    assert (back.vx_mps, back.vy_mps) == pytest.approx((vx, vy), abs=1e-9)


@given(st.floats(0.0, 2e9), values, values, speeds, speeds, st.none() | st.floats(-7.0, 7.0))
def test_a_motion_as_told_is_what_a_message_carries_to_the_last_bit(time_s, x, y, vx, vy, yaw):
    motion = Motion(time_s, x, y, vx, vy, 1.0, 2.0)
    message = m.motion_to_odometry(motion, child="uav", yaw_rad=yaw)
    assert m.motion_as_published(motion, yaw) == m.odometry_to_motion(message)
    assert m.stamped_s(time_s) == m.from_stamp(m.to_stamp(time_s))


@given(st.floats(0.0, 2e9), values, values, st.floats(-7.0, 7.0), st.floats(0.0, 90.0), sigmas)
def test_a_leg_as_told_is_what_a_message_carries_to_the_last_bit(time_s, x, y, yaw, speed, sigma):
    leg = LegEstimate(time_s, Pose(x, y, yaw), speed, sigma, 0.1 * sigma, 0.3 * sigma)
    assert m.leg_as_published(leg) == m.odometry_to_leg(m.leg_to_odometry(leg))


def test_velocity_covariance_is_turned_into_the_body():
    p = np.zeros((6, 6))
    p[1, 1], p[4, 4] = 4.0, 1.0
    north = MotionEstimate(Motion(0.0, 0.0, 0.0, 0.0, 20.0), p)
    message = m.estimate_to_odometry(north)
    assert message.twist.covariance[0] == pytest.approx(1.0)
    assert message.twist.covariance[7] == pytest.approx(4.0)
    assert message.twist.twist.linear.x == pytest.approx(20.0)
    accel = m.estimate_to_accel(north)
    assert accel.header.frame_id == "map"


@pytest.mark.parametrize("altitude_m", [0.0, -3.0, 150.0])
def test_an_altitude_is_told_and_one_that_is_not_known_is_told_as_such(altitude_m):
    motion = Motion(0.0, 1.0, 2.0, 20.0, 0.0)
    known = m.motion_to_odometry(motion, child="uav", altitude_m=altitude_m)
    assert m.odometry_altitude_m(known) == altitude_m
    unknown = m.motion_to_odometry(motion, child="uav")
    assert math.isnan(m.odometry_altitude_m(unknown))
    assert unknown.pose.pose.position.z == 0.0
    variances = np.diag((4.0, 1.0, 1.0, 4.0, 1.0, 1.0))
    for estimate in (MotionEstimate(motion, variances), MotionEstimate(motion, variances, 7.0)):
        told = m.odometry_altitude_m(m.estimate_to_odometry(estimate))
        assert told == pytest.approx(estimate.altitude_m, nan_ok=True)


def test_leg_round_trip():
    leg = LegEstimate(12.5, Pose(1.0, 2.0, 0.3), 20.0, 1.5, 0.01, 0.2)
    back = m.odometry_to_leg(m.leg_to_odometry(leg))
    assert back.foot.heading_rad == pytest.approx(0.3)
    assert (
        back.speed_mps,
        back.position_sigma_m,
        back.heading_sigma_rad,
        back.speed_sigma_mps,
    ) == (pytest.approx((20.0, 1.5, 0.01, 0.2)))


def test_corner_round_trip_by_two_stamped_poses():
    corner = CornerEstimate(
        101.0, Pose(5.0, -7.0, 2.0), 104.0, 21.0, 2.3, np.diag([4.0, 1.0]), 0.01, 0.3
    )
    back = m.path_to_corner(m.corner_to_path(corner))
    assert back.stop.heading_rad == pytest.approx(2.0)
    assert (back.time_s, back.stop_time_s, back.speed_mps, back.accel_mps2) == pytest.approx(
        (101.0, 104.0, 21.0, 2.3), abs=1e-6
    )
    pose = m.corner_to_pose(corner)
    assert pose.pose.covariance[[0, 7, 14]] == pytest.approx([4.0, 1.0, 0.09])
    assert m.from_stamp(pose.header.stamp) == pytest.approx(104.0)


def test_prediction_that_is_none_is_refused():
    with pytest.raises(ValueError, match="0 poses: expected 2"):
        m.path_to_corner(Path())
    corner = CornerEstimate(1.0, Pose(0, 0, 0), 4.0, 20.0, 2.5, np.eye(2), 0.0, 0.0)
    path = m.corner_to_path(corner)
    path.poses[1].header.stamp = path.poses[0].header.stamp
    with pytest.raises(ValueError, match="expected both"):
        m.path_to_corner(path)


def test_fix_round_trip():
    fix = Fix(1558092195.25, 43.6, 1.4, 342.9, np.array([[4.0, 1.0], [1.0, 9.0]]))
    back = m.message_to_fix(m.fix_to_message(fix))
    assert back.covariance_m2 == pytest.approx(fix.covariance_m2)
    assert back.time_s == pytest.approx(fix.time_s, abs=1e-6)
    none = m.message_to_fix(m.fix_to_message(Fix(1.0, 1.0, 2.0, has_fix=False)))
    assert none.covariance_m2 is None
    assert not none.has_fix
    assert m.message_to_fix(m.datum_message(Datum(1.0, 2.0, 3.0), 0.0)).altitude_m == 3.0


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_quaternion_keeps_the_yaw(yaw, pitch, roll):
    q = m.to_quaternion(yaw, pitch, roll)
    assert math.hypot(q.w, q.x, q.y, q.z) == pytest.approx(1.0)
    assert math.cos(m.to_yaw(q) - yaw) == pytest.approx(1.0, abs=1e-6)


def test_points_round_trip():
    points = np.array([[1.0, 2.0], [3.0, 4.0]])
    assert m.path_to_points(m.points_to_path(points, 7.0)) == pytest.approx(points)
    assert m.path_to_points(m.points_to_path(np.empty((0, 2)), 7.0)).shape == (0, 2)


def test_stamps_tell_the_speed_that_a_path_is_planned_with():
    points = np.array([[0.0, 0.0], [30.0, 40.0], [30.0, 140.0]])
    path = m.points_to_path(points, 7.0, speed_mps=20.0)
    assert [m.from_stamp(pose.header.stamp) for pose in path.poses] == pytest.approx(
        [7.0, 9.5, 14.5]
    )
    assert m.path_speed_mps(path) == pytest.approx(20.0)
    assert m.path_speed_mps(m.points_to_path(points, 7.0)) is None
    assert m.path_speed_mps(m.points_to_path(points[:1], 7.0, speed_mps=20.0)) is None


def test_diagnostics_level_follows_the_problem():
    good = m.diagnostics(1.0, "x", problem="", values={"a": 1}).status[0]
    bad = m.diagnostics(1.0, "x", problem="broken", values={}).status[0]
    assert (good.level, good.message, good.values[0].value) == (b"\x00", "ok", "1")
    assert (bad.level, bad.message) == (b"\x01", "broken")
