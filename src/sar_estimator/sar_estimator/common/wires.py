"""The table of the graph's topics: message type, quality of service, and both conversions.

``WIRES[topic]`` makes a message of a value and back. An offline flight, which sends no messages,
hands on what a message would carry of a value: ``carried``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import (
    AccelWithCovarianceStamped,
    PointStamped,
    PoseWithCovarianceStamped,
    TwistStamped,
    TwistWithCovarianceStamped,
    Vector3Stamped,
)
from nav_msgs.msg import Odometry, Path
from pydantic import FiniteFloat
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import NavSatFix
from std_msgs.msg import Float64, String
from visualization_msgs.msg import MarkerArray

from sar_estimator.common import conversions, topics
from sar_estimator.common.checked import read
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import (
    CornerRecord,
    Health,
    HelicopterReport,
    MonitorReport,
    Target,
    UavReport,
    UavStatus,
    Uploaded,
    Velocity,
    WaypointList,
)
from sar_estimator.common.states import MotionEstimate, Phase
from sar_estimator.common.statuses import Level, level_of, to_status, values_of


class Quality(StrEnum):
    """Quality of service: reliable; latched, the newest for late joiners too; a sensor's."""

    RELIABLE = "reliable"
    LATCHED = "latched"
    SENSOR = "sensor"


@dataclass(frozen=True)
class Wire:
    """One topic: its message type, quality, and conversions.

    ``what``: in words. ``to_message(value, time_s)`` uses the time [s] for values that have none.
    ``from_message`` raises ``ValueError`` for what is no such value. ``carried``: the value that
    comes out of the message that it goes into.
    """

    what: str
    kind: type[Any]
    quality: Quality
    to_message: Callable[[Any, float], Any]
    from_message: Callable[[Any], Any]
    carried: Callable[[Any], Any]


def _same(value: Any) -> Any:
    return value


def _newest(carry: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return ``carry``, worked out once for each value, not at every handing on."""
    known: tuple[Any, Any] | None = None

    def once(value: Any) -> Any:
        nonlocal known
        if known is None or known[0] is not value:
            known = value, carry(value)
        return known[1]

    return once


def reader(kind: Any, *needed: str) -> Callable[[DiagnosticStatus], Any]:
    """Return what reads a status as ``kind``; ``needed``: keys that it must have.

    A status without them is of something else, and must not be taken for one that says nothing.
    """

    def from_status(status: DiagnosticStatus) -> Any:
        values = values_of(status)
        for key in needed:
            if key not in values:
                raise ValueError(f"{status.name}.{key}: missing")
        return read(kind, values, status.name, texts=True)

    return from_status


def _text(value: object, _time_s: float) -> String:
    return conversions.text_message(value)


def _helicopter(message: Odometry) -> HelicopterReport:
    return HelicopterReport(
        conversions.odometry_to_motion(message),
        *conversions.odometry_sigmas(message),
        conversions.odometry_altitude_m(message),
    )


def _helicopter_carried(estimate: MotionEstimate) -> HelicopterReport:
    motion = conversions.motion_as_published(estimate.motion)
    return HelicopterReport(motion, *estimate.sigmas, estimate.altitude_m)


def _uav_message(report: UavReport, _time_s: float) -> Odometry:
    message = conversions.motion_to_odometry(
        report.motion, child="uav", yaw_rad=report.yaw_rad, altitude_m=report.altitude_m
    )
    attitude = report.yaw_rad, report.pitch_rad, report.roll_rad
    message.pose.pose.orientation = conversions.to_quaternion(*attitude)
    message.twist.twist.linear.z = report.climb_mps
    return message


def _uav(message: Odometry) -> UavReport:
    return UavReport(
        conversions.odometry_to_motion(message),
        conversions.to_yaw(message.pose.pose.orientation),
        conversions.odometry_altitude_m(message),
    )


def _uav_carried(report: UavReport) -> UavReport:
    motion = conversions.motion_as_published(report.motion, report.yaw_rad)
    return UavReport(motion, report.yaw_rad, report.altitude_m)


def _velocity(message: TwistStamped) -> Velocity:
    linear = message.twist.linear
    return Velocity(conversions.from_stamp(message.header.stamp), linear.x, linear.y)


def _datum(message: NavSatFix) -> Datum:
    return Datum(message.latitude, message.longitude, message.altitude)


def _stop_covariance(message: PoseWithCovarianceStamped) -> Any:
    covariance = np.asarray(message.pose.covariance).reshape(6, 6)[:2, :2].copy()
    if not np.isfinite(covariance).all():
        raise ValueError(f"covariance of the stop {covariance.tolist()}: expected numbers")
    return covariance


def _phase(message: String) -> Phase:
    return Phase(message.data)


def _status_message(status: UavStatus, _time_s: float) -> DiagnosticStatus:
    level = Level.OK if status.connected else Level.ERROR
    text = status.mode if status.connected else "not heard"
    return to_status("uav", status, level=level, message=text)


def _wind(message: Vector3Stamped) -> tuple[float, float]:
    return message.vector.x, message.vector.y


def _target(message: PointStamped) -> Target:
    x, y = message.point.x, message.point.y
    if message.header.frame_id not in ("", conversions.FRAME) or not math.isfinite(x + y):
        raise ValueError(
            f"point {x}, {y} in frame {message.header.frame_id!r}: expected numbers in "
            f"{conversions.FRAME!r}"
        )
    return Target(conversions.from_stamp(message.header.stamp), x, y)


def _list_message(waypoints: WaypointList, _time_s: float) -> Path:
    return conversions.points_to_path(
        waypoints.points,
        waypoints.time_s,
        climb_m=waypoints.climb_m,
        speed_mps=waypoints.speed_mps,
        list_id=waypoints.list_id,
    )


def _list(message: Path) -> WaypointList:
    return WaypointList(
        conversions.list_id_of(message),
        conversions.from_stamp(message.header.stamp),
        conversions.path_to_points(message),
        conversions.path_speed_mps(message),
        conversions.path_climb_m(message),
    )


ALERT_LEVELS = {"none": Level.OK, "escape": Level.ERROR}
"""Of a monitor's alerts; the others are warnings."""


def _monitor_message(report: MonitorReport, _time_s: float) -> DiagnosticStatus:
    level = ALERT_LEVELS.get(report.alert, Level.WARN)
    wrong = report.too_near or report.adsb
    if level is Level.OK and wrong:
        level = Level.WARN
    return to_status("monitor", report, level=level, message=report.reason or wrong or report.alert)


def _health(health: Health, time_s: float) -> DiagnosticArray:
    return conversions.diagnostics(
        time_s,
        health.name,
        problem=health.problem,
        values=dict(health.values),
        severe=health.severe,
    )


def _healths(array: DiagnosticArray) -> tuple[Health, ...]:
    """Return how nodes are; their figures as texts."""
    return tuple(
        Health(
            status.name,
            "" if level_of(status) is Level.OK else status.message,
            {item.key: item.value for item in status.values},
            severe=level_of(status) >= Level.ERROR,
        )
        for status in array.status
    )


def _float(value: float, _time_s: float) -> Float64:
    return Float64(data=value)


def _data(message: Any) -> Any:
    return message.data


RELIABLE, LATCHED, SENSOR = Quality
WIRES: dict[str, Wire] = {
    topics.FIX: Wire(
        "position of the helicopter, 0.5 to 10 Hz",
        NavSatFix,
        SENSOR,
        lambda fix, _: conversions.fix_to_message(fix),
        conversions.message_to_fix,
        _same,
    ),
    topics.VELOCITY: Wire(
        "its velocity in the map's axes, optional",
        TwistStamped,
        SENSOR,
        lambda velocity, _: conversions.velocity_message(velocity),
        _velocity,
        lambda velocity: velocity._replace(sigma_mps=None),
    ),
    topics.FIX_VELOCITY: Wire(
        "the same and how sure it is; where it comes, the other one does not count",
        TwistWithCovarianceStamped,
        SENSOR,
        lambda velocity, _: conversions.velocity_with_covariance(velocity),
        conversions.message_to_velocity,
        _same,
    ),
    topics.ADSB: Wire(
        "its position by ADS-B, as the UAV hears it",
        PointStamped,
        RELIABLE,
        lambda seen, _: conversions.target_message(*seen),
        _target,
        _same,
    ),
    topics.FIX_TIME: Wire(
        "when the newest fix was that motion, leg and corner rest on",
        Clock,
        RELIABLE,
        lambda fix_s, _: Clock(clock=conversions.to_stamp(fix_s)),
        lambda message: conversions.from_stamp(message.clock),
        conversions.stamped_s,
    ),
    topics.DATUM: Wire(
        "the map's origin", NavSatFix, LATCHED, conversions.datum_message, _datum, _same
    ),
    topics.HELICOPTER_ODOMETRY: Wire(
        "its motion, 5 Hz",
        Odometry,
        RELIABLE,
        lambda estimate, _: conversions.estimate_to_odometry(estimate),
        _helicopter,
        _helicopter_carried,
    ),
    topics.HELICOPTER_ACCEL: Wire(
        "its acceleration, 5 Hz",
        AccelWithCovarianceStamped,
        RELIABLE,
        lambda estimate, _: conversions.estimate_to_accel(estimate),
        _same,
        _same,
    ),
    topics.LEG: Wire(
        "the leg being flown and its cruise speed",
        Odometry,
        RELIABLE,
        lambda leg, _: conversions.leg_to_odometry(leg),
        conversions.odometry_to_leg,
        _newest(conversions.leg_as_published),
    ),
    topics.CORNER: Wire(
        "where it will stop, heading as it comes; stamped with the stop time",
        PoseWithCovarianceStamped,
        RELIABLE,
        lambda corner, _: conversions.corner_to_pose(corner),
        _stop_covariance,
        lambda corner: corner.covariance,
    ),
    topics.PREDICTION: Wire(
        "two stamped poses: onset of the slow-down, and stop",
        Path,
        RELIABLE,
        lambda corner, _: conversions.corner_to_path(corner),
        conversions.path_to_corner,
        _newest(lambda corner: conversions.path_to_corner(conversions.corner_to_path(corner))),
    ),
    topics.PHASE: Wire(
        "cruise, decelerating, stopped, accelerating, lost", String, LATCHED, _text, _phase, _same
    ),
    topics.UAV_ODOMETRY: Wire(
        "the UAV's motion, stamped with the autopilot's own clock",
        Odometry,
        RELIABLE,
        _uav_message,
        _uav,
        _uav_carried,
    ),
    topics.UAV_CLOCK: Wire(
        "the autopilot's time since boot",
        Clock,
        RELIABLE,
        lambda boot_s, _: Clock(clock=conversions.to_stamp(boot_s)),
        lambda message: conversions.from_stamp(message.clock),
        _same,
    ),
    topics.UAV_STATE: Wire(
        "mode, armed, connected, tracking_list, airspeed_ratio, taken",
        DiagnosticStatus,
        LATCHED,
        _status_message,
        reader(UavStatus, "mode", "armed", "connected"),
        _same,
    ),
    topics.AUTOPILOT: Wire(
        "the autopilot's parameters, by ArduPlane's newer names",
        DiagnosticStatus,
        LATCHED,
        lambda values, _: to_status("autopilot", values),
        reader(dict[str, FiniteFloat]),
        _same,
    ),
    topics.WIND: Wire(
        "where the wind blows to, m/s",
        Vector3Stamped,
        RELIABLE,
        lambda wind, time_s: conversions.vector_message(time_s, *wind),
        _wind,
        _same,
    ),
    topics.UPLOADED: Wire(
        "the list that the autopilot has accepted, and how long it took",
        DiagnosticStatus,
        RELIABLE,
        lambda one, _: to_status("uploaded", one),
        reader(Uploaded),
        _same,
    ),
    topics.WAYPOINTS: Wire(
        "the whole list, its identity in the stamp; empty withdraws it",
        Path,
        LATCHED,
        _list_message,
        _list,
        _same,
    ),
    topics.CLEARED: Wire(
        "the list that may be flown, or an escape; z: above the usual altitude",
        Path,
        LATCHED,
        _list_message,
        _list,
        _same,
    ),
    topics.SPEED: Wire(
        "the airspeed asked of the UAV, m/s", Float64, LATCHED, _float, _data, _same
    ),
    topics.MODE: Wire(
        "idle, leg, rejoin, hold, or the rule being flown", String, LATCHED, _text, _data, _same
    ),
    topics.LAG: Wire("L in metres; in a corner L(k)", Float64, RELIABLE, _float, _data, _same),
    topics.CORNER_PLAN: Wire(
        "a decision at a corner",
        DiagnosticStatus,
        RELIABLE,
        lambda record, _: to_status(f"corner {record.k}", record, message=record.rule),
        reader(CornerRecord),
        _same,
    ),
    topics.CORNER_PATH: Wire(
        "the curve that it is for, stamped as its list",
        Path,
        RELIABLE,
        _list_message,
        _list,
        _same,
    ),
    topics.PATTERN: Wire(
        "the corners of the pattern that are still expected, the end of the leg being flown first",
        Path,
        LATCHED,
        conversions.points_to_path,
        conversions.path_to_points,
        _same,
    ),
    topics.MISSION: Wire(
        "the parameters that are flown with",
        DiagnosticStatus,
        LATCHED,
        lambda values, _: to_status("mission", values),
        values_of,
        _same,
    ),
    topics.TARGET: Wire(
        "a place in the map to be marked, from a detector or the operator",
        PointStamped,
        RELIABLE,
        lambda target, _: conversions.target_message(*target),
        _target,
        _same,
    ),
    topics.MARKS: Wire(
        "what was marked, in the order of its numbers, stamped with when",
        Path,
        LATCHED,
        conversions.marks_to_path,
        conversions.path_to_marks,
        _same,
    ),
    topics.MARKERS: Wire(
        "tracks, list, pattern and rule for RViz and Foxglove",
        MarkerArray,
        RELIABLE,
        lambda markers, _: markers,
        _same,
        _same,
    ),
    topics.MONITOR: Wire(
        "alert, reason, identity of a list that did not pass, thresholds, counts",
        DiagnosticStatus,
        LATCHED,
        _monitor_message,
        reader(MonitorReport, "alert", "reason", "refused_id"),
        _same,
    ),
    topics.DIAGNOSTICS: Wire(
        "how every node is, 1 Hz",
        DiagnosticArray,
        RELIABLE,
        _health,
        _healths,
        lambda health: (health,),
    ),
}
