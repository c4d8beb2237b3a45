"""The estimator's values as ROS messages and back. Frame ``map``, REP-103."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import (
    AccelWithCovarianceStamped,
    Point,
    PointStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    TwistStamped,
    TwistWithCovarianceStamped,
    Vector3Stamped,
)
from geometry_msgs.msg import Pose as PoseMessage
from nav_msgs.msg import Odometry, Path
from sensor_msgs.msg import NavSatFix, NavSatStatus
from std_msgs.msg import Header, String

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import Mark, Velocity
from sar_estimator.common.states import (
    CornerEstimate,
    FloatArray,
    LegEstimate,
    Motion,
    MotionEstimate,
)

FRAME = "map"


NANOSECONDS = 1_000_000_000

Z_VARIANCE = 14
UNKNOWN_M2 = 1e6
"""A variance that stands for not known."""


def to_stamp(time_s: float) -> Time:
    """Return a time [s] as a stamp."""
    return _stamp_of(round(time_s * 1e9))


def _stamp_of(nanoseconds: int) -> Time:
    return Time(sec=nanoseconds // NANOSECONDS, nanosec=nanoseconds % NANOSECONDS)


def list_id_of(path: Path) -> int:
    """Return the identity of a waypoint list: its stamp in whole nanoseconds.

    An integer: seconds as a float differ by how they were worked out.
    """
    return int(path.header.stamp.sec) * NANOSECONDS + int(path.header.stamp.nanosec)


def from_stamp(stamp: Time) -> float:
    """Return a stamp as a time [s]."""
    return float(stamp.sec) + stamp.nanosec * 1e-9


def stamped_s(time_s: float) -> float:
    """Return a time [s] as a stamp carries it: ``from_stamp(to_stamp(time_s))``."""
    nanoseconds = round(time_s * 1e9)
    return float(nanoseconds // 1_000_000_000) + (nanoseconds % 1_000_000_000) * 1e-9


def to_quaternion(yaw_rad: float, pitch_rad: float = 0.0, roll_rad: float = 0.0) -> Quaternion:
    """Return yaw, pitch, roll [rad], applied in this order, as a quaternion."""
    cy, sy = math.cos(yaw_rad / 2), math.sin(yaw_rad / 2)
    cp, sp = math.cos(pitch_rad / 2), math.sin(pitch_rad / 2)
    cr, sr = math.cos(roll_rad / 2), math.sin(roll_rad / 2)
    return Quaternion(
        w=cr * cp * cy + sr * sp * sy,
        x=sr * cp * cy - cr * sp * sy,
        y=cr * sp * cy + sr * cp * sy,
        z=cr * cp * sy - sr * sp * cy,
    )


def to_yaw(q: Quaternion) -> float:
    """Return the yaw [rad] of a quaternion."""
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def _covariance(entries: dict[tuple[int, int], float]) -> FloatArray:
    """Return a row-major 6 x 6 covariance, symmetric, zero where nothing is given."""
    matrix = np.zeros((6, 6))
    for (row, column), value in entries.items():
        matrix[row, column] = matrix[column, row] = value
    return matrix.ravel()


def _rotated(block: FloatArray, yaw_rad: float) -> FloatArray:
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    turn = np.array([[c, s], [-s, c]])
    return np.asarray(turn @ block @ turn.T)


def motion_to_odometry(
    motion: Motion, *, child: str, yaw_rad: float | None = None, altitude_m: float = math.nan
) -> Odometry:
    """Return a motion as odometry: pose in the map, twist in the body's own axes (REP-105).

    z is the altitude above mean sea level; one that is not known is 0, with a huge variance.
    """
    message = Odometry()
    message.header.stamp = to_stamp(motion.time_s)
    message.header.frame_id = FRAME
    message.child_frame_id = child
    yaw = motion.course_rad if yaw_rad is None else yaw_rad
    message.pose.pose.position.x = motion.x_m
    message.pose.pose.position.y = motion.y_m
    if math.isfinite(altitude_m):
        message.pose.pose.position.z = altitude_m
    else:
        message.pose.covariance[Z_VARIANCE] = UNKNOWN_M2
    message.pose.pose.orientation = to_quaternion(yaw)
    c, s = math.cos(yaw), math.sin(yaw)
    message.twist.twist.linear.x = motion.vx_mps * c + motion.vy_mps * s
    message.twist.twist.linear.y = -motion.vx_mps * s + motion.vy_mps * c
    return message


def odometry_to_motion(message: Odometry) -> Motion:
    """Return odometry as a motion in the map frame."""
    yaw = to_yaw(message.pose.pose.orientation)
    c, s = math.cos(yaw), math.sin(yaw)
    twist = message.twist.twist.linear
    return Motion(
        from_stamp(message.header.stamp),
        message.pose.pose.position.x,
        message.pose.pose.position.y,
        twist.x * c - twist.y * s,
        twist.x * s + twist.y * c,
    )


def odometry_altitude_m(message: Odometry) -> float:
    """Return the altitude above mean sea level [m], NaN where it is not known."""
    known = float(message.pose.covariance[Z_VARIANCE]) < UNKNOWN_M2
    return float(message.pose.pose.position.z) if known else math.nan


def motion_as_published(motion: Motion, yaw_rad: float | None = None) -> Motion:
    """Return a motion as odometry carries it, to the last bit, without making a message.

    That is ``odometry_to_motion(motion_to_odometry(motion, yaw_rad=yaw_rad))``.
    """
    time_s, x_m, y_m, vx_mps, vy_mps, *_ = motion
    yaw = math.atan2(vy_mps, vx_mps) if yaw_rad is None else yaw_rad
    c, s = math.cos(yaw), math.sin(yaw)
    ahead, aside = vx_mps * c + vy_mps * s, -vx_mps * s + vy_mps * c
    yaw = _yaw_as_published(yaw)
    c, s = math.cos(yaw), math.sin(yaw)
    return Motion(stamped_s(time_s), x_m, y_m, ahead * c - aside * s, ahead * s + aside * c)


def _yaw_as_published(yaw_rad: float) -> float:
    """Return a yaw [rad] as a quaternion carries it: ``to_yaw(to_quaternion(yaw_rad))``."""
    w, z = math.cos(yaw_rad / 2), math.sin(yaw_rad / 2)
    return math.atan2(2.0 * (w * z), 1.0 - 2.0 * (z * z))


def leg_as_published(leg: LegEstimate) -> LegEstimate:
    """Return a leg as odometry carries it: ``odometry_to_leg(leg_to_odometry)`` to the last bit."""
    heading = leg.foot.heading_rad
    c, s = math.cos(heading), math.sin(heading)
    return LegEstimate(
        stamped_s(leg.time_s),
        Pose(leg.foot.x_m, leg.foot.y_m, _yaw_as_published(heading)),
        leg.speed_mps * c * c + leg.speed_mps * s * s,
        math.sqrt(leg.position_sigma_m**2),
        math.sqrt(leg.heading_sigma_rad**2),
        math.sqrt(leg.speed_sigma_mps**2),
    )


def odometry_sigmas(message: Odometry) -> tuple[float, float]:
    """Return the standard deviations of position [m] and velocity [m/s], along the worse axis."""
    position, velocity = message.pose.covariance, message.twist.covariance
    return math.sqrt(max(position[0], position[7], 0.0)), math.sqrt(
        max(velocity[0], velocity[7], 0.0)
    )


def estimate_to_odometry(estimate: MotionEstimate) -> Odometry:
    """Return the helicopter's estimate as odometry with covariance."""
    message = motion_to_odometry(
        estimate.motion, child="helicopter", altitude_m=estimate.altitude_m
    )
    p, up = estimate.covariance, float(message.pose.covariance[Z_VARIANCE])
    yaw = estimate.motion.course_rad
    message.pose.covariance = _covariance(
        {
            (0, 0): p[0, 0],
            (0, 1): p[0, 3],
            (1, 1): p[3, 3],
            (2, 2): up,
            (5, 5): _yaw_variance(estimate),
        }
    )
    twist = _rotated(p[np.ix_([1, 4], [1, 4])], yaw)
    message.twist.covariance = _covariance(
        {(0, 0): twist[0, 0], (0, 1): twist[0, 1], (1, 1): twist[1, 1]}
    )
    return message


def _yaw_variance(estimate: MotionEstimate) -> float:
    speed = max(estimate.motion.speed_mps, 0.1)
    variance = float(np.trace(estimate.covariance[np.ix_([1, 4], [1, 4])])) / 2.0
    return min(variance / speed**2, math.pi**2)


def estimate_to_accel(estimate: MotionEstimate) -> AccelWithCovarianceStamped:
    """Return the helicopter's acceleration, in the map's axes, with covariance."""
    message = AccelWithCovarianceStamped()
    message.header.stamp = to_stamp(estimate.motion.time_s)
    message.header.frame_id = FRAME
    message.accel.accel.linear.x = estimate.motion.ax_mps2
    message.accel.accel.linear.y = estimate.motion.ay_mps2
    p = estimate.covariance
    message.accel.covariance = _covariance({(0, 0): p[2, 2], (0, 1): p[2, 5], (1, 1): p[5, 5]})
    return message


def leg_to_odometry(leg: LegEstimate) -> Odometry:
    """Return a leg as odometry: pose on the leg with its heading, cruise speed along it."""
    c, s = math.cos(leg.foot.heading_rad), math.sin(leg.foot.heading_rad)
    motion = Motion(leg.time_s, leg.foot.x_m, leg.foot.y_m, leg.speed_mps * c, leg.speed_mps * s)
    message = motion_to_odometry(motion, child="helicopter_leg", yaw_rad=leg.foot.heading_rad)
    variance = leg.position_sigma_m**2
    message.pose.covariance = _covariance(
        {(0, 0): variance, (1, 1): variance, (5, 5): leg.heading_sigma_rad**2}
    )
    message.twist.covariance = _covariance({(0, 0): leg.speed_sigma_mps**2})
    return message


def odometry_to_leg(message: Odometry) -> LegEstimate:
    """Return a leg message as a leg."""
    motion = odometry_to_motion(message)
    pose = Pose(motion.x_m, motion.y_m, to_yaw(message.pose.pose.orientation))
    return LegEstimate(
        motion.time_s,
        pose,
        message.twist.twist.linear.x,
        math.sqrt(message.pose.covariance[0]),
        math.sqrt(message.pose.covariance[35]),
        math.sqrt(message.twist.covariance[0]),
    )


def corner_to_pose(corner: CornerEstimate) -> PoseWithCovarianceStamped:
    """Return a corner's stop pose with covariance, stamped with the stop time.

    The variance of z carries that of the stop time [s^2].
    """
    pose = PoseWithCovarianceStamped()
    pose.header.stamp = to_stamp(corner.stop_time_s)
    pose.header.frame_id = FRAME
    pose.pose.pose = _pose_message(corner.stop)
    p = corner.covariance
    pose.pose.covariance = _covariance(
        {
            (0, 0): p[0, 0],
            (0, 1): p[0, 1],
            (1, 1): p[1, 1],
            (2, 2): corner.stop_time_sigma_s**2,
            (5, 5): corner.heading_sigma_rad**2,
        }
    )
    return pose


def _pose_message(pose: Pose) -> PoseMessage:
    message = PoseMessage()
    message.position.x, message.position.y = pose.x_m, pose.y_m
    message.orientation = to_quaternion(pose.heading_rad)
    return message


def corner_to_path(corner: CornerEstimate) -> Path:
    """Return the predicted deceleration as two stamped poses: its onset and the stop.

    With s their distance and T their time apart, V = 2 s / T and a = V / T.
    """
    onset = corner.stop.offset(-corner.stopping_distance_m)
    path = Path()
    path.header.stamp = to_stamp(corner.time_s)
    path.header.frame_id = FRAME
    for pose, time_s in ((onset, corner.onset_time_s), (corner.stop, corner.stop_time_s)):
        stamped = PoseStamped(pose=_pose_message(pose))
        stamped.header.stamp = to_stamp(time_s)
        stamped.header.frame_id = FRAME
        path.poses.append(stamped)
    return path


def path_to_corner(path: Path, covariance: FloatArray | None = None) -> CornerEstimate:
    """Return the corner of a predicted deceleration.

    ``covariance``: of the stop point, shape (2, 2) [m^2]; the path does not carry it. Raises
    ``ValueError`` when the path is not an onset and a later stop.
    """
    if len(path.poses) != 2:
        raise ValueError(f"predicted deceleration of {len(path.poses)} poses: expected 2")
    onset, stop = path.poses
    start_s, stop_s = from_stamp(onset.header.stamp), from_stamp(stop.header.stamp)
    a, b = onset.pose.position, stop.pose.position
    distance, duration = math.hypot(b.x - a.x, b.y - a.y), stop_s - start_s
    heading = to_yaw(stop.pose.orientation)
    if not math.isfinite(heading):
        raise ValueError(f"predicted stop with heading {heading}: expected a number")
    if not (math.isfinite(distance) and distance > 0.0 and duration > 0.0):
        raise ValueError(f"predicted deceleration over {distance} m in {duration} s: expected both")
    speed = 2.0 * distance / duration
    return CornerEstimate(
        time_s=from_stamp(path.header.stamp),
        stop=Pose(b.x, b.y, heading),
        stop_time_s=stop_s,
        speed_mps=speed,
        accel_mps2=speed / duration,
        covariance=np.zeros((2, 2)) if covariance is None else covariance,
        heading_sigma_rad=0.0,
        stop_time_sigma_s=0.0,
    )


def target_message(time_s: float, x_m: float, y_m: float) -> PointStamped:
    """Return a place of the map as a stamped point."""
    message = PointStamped(point=Point(x=float(x_m), y=float(y_m)))
    message.header.stamp = to_stamp(time_s)
    message.header.frame_id = FRAME
    return message


def marks_to_path(marks: Sequence[Mark], time_s: float) -> Path:
    """Return marks, in the order of their numbers from 1, as poses stamped with when each was."""
    path = Path()
    path.header.stamp = to_stamp(time_s)
    path.header.frame_id = FRAME
    for mark in marks:
        stamped = PoseStamped(pose=_pose_message(Pose(mark.x_m, mark.y_m, 0.0)))
        stamped.header.stamp = to_stamp(mark.time_s)
        stamped.header.frame_id = FRAME
        path.poses.append(stamped)
    return path


def path_to_marks(path: Path) -> tuple[Mark, ...]:
    """Return the marks of ``marks_to_path``."""
    return tuple(
        Mark(
            number,
            from_stamp(pose.header.stamp),
            pose.pose.position.x,
            pose.pose.position.y,
        )
        for number, pose in enumerate(path.poses, start=1)
    )


def points_to_path(
    points: FloatArray,
    time_s: float,
    *,
    climb_m: float = 0.0,
    speed_mps: float | None = None,
    list_id: int | None = None,
) -> Path:
    """Return points, shape (n, 2) [m], as a path; no points withdraw the list.

    ``climb_m``: how far above the usual altitude they are flown; it becomes their z. ``speed_mps``:
    over ground, as planned; each pose is then stamped with when it is passed, counted from the
    first. ``list_id``: of the list, that of its time where none is given.
    """
    path = Path()
    path.header.stamp = to_stamp(time_s) if list_id is None else _stamp_of(list_id)
    path.header.frame_id = FRAME
    flown_m = 0.0
    for i, (x, y) in enumerate(points.tolist()):
        pose = PoseStamped()
        pose.header = path.header
        if speed_mps is not None and i > 0:
            flown_m += math.dist((x, y), points[i - 1])
            pose.header = Header(frame_id=FRAME, stamp=to_stamp(time_s + flown_m / speed_mps))
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.position.z = climb_m
        pose.pose.orientation.w = 1.0
        path.poses.append(pose)
    return path


def path_speed_mps(path: Path) -> float | None:
    """Return the ground speed [m/s] that a path's stamps say, None where they say nothing."""
    if len(path.poses) < 2:
        return None
    (x0, y0), (x1, y1) = path_to_points(path)[:2].tolist()
    first, second = (from_stamp(pose.header.stamp) for pose in path.poses[:2])
    return math.hypot(x1 - x0, y1 - y0) / (second - first) if second > first else None


def path_to_points(path: Path) -> FloatArray:
    """Return a path's points, shape (n, 2) [m]."""
    return np.array(
        [(pose.pose.position.x, pose.pose.position.y) for pose in path.poses], dtype=np.float64
    ).reshape(-1, 2)


def path_climb_m(path: Path) -> float:
    """Return how far above the usual altitude a path is flown [m]: the z of its first pose."""
    return float(path.poses[0].pose.position.z) if path.poses else 0.0


def message_to_fix(message: NavSatFix) -> Fix:
    """Return a NavSatFix as a fix."""
    covariance = None
    if message.position_covariance_type != NavSatFix.COVARIANCE_TYPE_UNKNOWN:
        full = np.asarray(message.position_covariance, dtype=np.float64).reshape(3, 3)
        covariance = full[:2, :2].copy()
    return Fix(
        from_stamp(message.header.stamp),
        message.latitude,
        message.longitude,
        message.altitude,
        covariance,
        has_fix=message.status.status >= NavSatStatus.STATUS_FIX,
    )


def fix_to_message(fix: Fix) -> NavSatFix:
    """Return a fix as a NavSatFix."""
    message = NavSatFix()
    message.header.stamp = to_stamp(fix.time_s)
    message.header.frame_id = "gps"
    message.status.status = NavSatStatus.STATUS_FIX if fix.has_fix else NavSatStatus.STATUS_NO_FIX
    message.status.service = NavSatStatus.SERVICE_GPS
    message.latitude, message.longitude = fix.latitude_deg, fix.longitude_deg
    message.altitude = fix.altitude_m
    if fix.covariance_m2 is not None:
        full = np.zeros((3, 3))
        full[:2, :2] = fix.covariance_m2
        full[2, 2] = 4.0 * float(np.trace(fix.covariance_m2))
        message.position_covariance = full.ravel()
        message.position_covariance_type = NavSatFix.COVARIANCE_TYPE_KNOWN
    return message


def vector_message(time_s: float, x: float, y: float) -> Vector3Stamped:
    """Return a horizontal vector in the map frame."""
    message = Vector3Stamped()
    message.header.stamp = to_stamp(time_s)
    message.header.frame_id = FRAME
    message.vector.x, message.vector.y = x, y
    return message


def velocity_message(velocity: Velocity) -> TwistStamped:
    """Return a Doppler velocity, in the map's axes."""
    message = TwistStamped()
    message.header.stamp = to_stamp(velocity.time_s)
    message.header.frame_id = FRAME
    message.twist.linear.x, message.twist.linear.y = velocity.vx_mps, velocity.vy_mps
    return message


def velocity_with_covariance(velocity: Velocity) -> TwistWithCovarianceStamped:
    """Return a Doppler velocity and how sure it is, in the map's axes."""
    message = TwistWithCovarianceStamped(header=velocity_message(velocity).header)
    message.twist.twist = velocity_message(velocity).twist
    if velocity.sigma_mps is not None:
        message.twist.covariance[0] = message.twist.covariance[7] = velocity.sigma_mps**2
    return message


def message_to_velocity(message: TwistWithCovarianceStamped) -> Velocity:
    """Return the velocity; a variance that is not positive, or no number, says nothing."""
    linear, variances = message.twist.twist.linear, message.twist.covariance
    variance = max(float(variances[0]), float(variances[7]))
    sigma = math.sqrt(variance) if 0.0 < variance < math.inf else None
    return Velocity(from_stamp(message.header.stamp), linear.x, linear.y, sigma)


def datum_message(datum: Datum, time_s: float) -> NavSatFix:
    """Return the map's origin."""
    return fix_to_message(Fix(time_s, datum.latitude_deg, datum.longitude_deg, datum.altitude_m))


def text_message(text: object) -> String:
    """Return a text."""
    return String(data=str(text))


def diagnostics(
    time_s: float, name: str, *, problem: str, values: dict[str, object], severe: bool = False
) -> DiagnosticArray:
    """Return one status: OK with no problem, else a warning, or an error, that says it."""
    wrong = DiagnosticStatus.ERROR if severe else DiagnosticStatus.WARN
    status = DiagnosticStatus(
        level=wrong if problem else DiagnosticStatus.OK,
        name=name,
        message=problem or "ok",
        hardware_id="sar_formation",
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )
    array = DiagnosticArray(status=[status])
    array.header.stamp = to_stamp(time_s)
    return array
