"""The planner's values as ROS messages and back."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point
from nav_msgs.msg import Path
from std_msgs.msg import ColorRGBA, Float64, String
from visualization_msgs.msg import Marker, MarkerArray

from sar_estimator.common import topics
from sar_estimator.common.conversions import (
    FRAME,
    diagnostics,
    points_to_path,
    text_message,
    to_stamp,
)
from sar_estimator.common.states import Motion
from sar_planner.guidance.vehicle import Vehicle
from sar_planner.mission_planner import (
    ActiveCorner,
    MissionPlanner,
    Mode,
    MonitorStatus,
    UavStatus,
    WaypointList,
)

SPEED_STEP_MPS = 0.05
TRACK_M = 20.0
RATIOS = (0.5, 2.0)

COLOURS = {
    "helicopter": (0.85, 0.35, 0.0, 1.0),
    "uav": (0.0, 0.35, 0.7, 1.0),
    "plan": (0.0, 0.6, 0.5, 1.0),
    "rule": (1.0, 1.0, 1.0, 1.0),
}


def list_to_path(waypoints: WaypointList) -> Path:
    """Return a waypoint list as a path: the whole list; its stamp is its identity."""
    return points_to_path(
        waypoints.points,
        waypoints.time_s,
        speed_mps=waypoints.speed_mps,
        list_id=waypoints.list_id,
    )


def corner_record(active: ActiveCorner, waypoints: WaypointList) -> dict[str, Any]:
    """Return what was decided at a corner, and the time of the list it went out with."""
    plan, estimate = active.plan, active.estimate
    return {
        "k": active.k,
        "rule": str(plan.rule),
        "lag_m": plan.lag_m,
        "next_lag_m": plan.next_lag_m,
        "length_m": plan.path.length_m,
        "list_time_s": waypoints.time_s,
        "onset_time_s": estimate.onset_time_s,
        "stop_time_s": estimate.stop_time_s,
        "estimated_at_s": estimate.time_s,
        "speed_mps": estimate.speed_mps,
        "accel_mps2": estimate.accel_mps2,
        "turn_radius_m": plan.parameters.turn_radius_m,
        "stop": [estimate.stop.x_m, estimate.stop.y_m, estimate.stop.heading_rad],
        "first_stop": [active.first_stop.x_m, active.first_stop.y_m],
        "path": [[round(float(v), 2) for v in xy] for xy in active.path.sample(10.0)],
    }


def corner_message(active: ActiveCorner, waypoints: WaypointList) -> String:
    """Return a corner's record as JSON."""
    return text_message(json.dumps(corner_record(active, waypoints)))


def mission_message(planner: MissionPlanner) -> String:
    """Return the parameters the planner flies with, as JSON."""
    return text_message(
        json.dumps(
            {"corner": asdict(planner.corner_parameters), "mission": asdict(planner.parameters)}
        )
    )


class MarkerTracks:
    """Both tracks, the waypoint list and the active rule as markers for RViz or Foxglove."""

    def __init__(self, keep: int = 1000) -> None:
        """Keep at most ``keep`` points of each track."""
        self._keep = keep
        self._tracks: dict[str, list[Point]] = {"helicopter": [], "uav": []}

    def add(self, name: str, motion: Motion | None) -> None:
        """Append a position to a track once it is ``TRACK_M`` on."""
        if motion is None:
            return
        track = self._tracks[name]
        if track and math.hypot(motion.x_m - track[-1].x, motion.y_m - track[-1].y) < TRACK_M:
            return
        track.append(Point(x=motion.x_m, y=motion.y_m))
        del track[: -self._keep]

    def message(self, planner: MissionPlanner, time_s: float) -> MarkerArray:
        """Return everything as one array."""
        plan = () if planner.list is None else planner.list.points.tolist()
        lines = {**self._tracks, "plan": [Point(x=x, y=y) for x, y in plan]}
        markers = [
            self._marker(i, name, Marker.LINE_STRIP, time_s, points=points)
            for i, (name, points) in enumerate(lines.items())
        ]
        text = self._marker(3, "rule", Marker.TEXT_VIEW_FACING, time_s, points=[])
        text.scale.z = 40.0
        lag = planner.lag_m()
        text.text = planner.rule if lag is None else f"{planner.rule}  L = {lag:.0f} m"
        if planner.uav is not None:
            text.pose.position.x, text.pose.position.y = planner.uav.x_m, planner.uav.y_m
        return MarkerArray(markers=[*markers, text])

    @staticmethod
    def _marker(number: int, name: str, kind: int, time_s: float, *, points: list[Point]) -> Marker:
        marker = Marker(ns=name, id=number, type=kind, action=Marker.ADD, points=points)
        marker.header.frame_id = FRAME
        marker.header.stamp = to_stamp(time_s)
        marker.pose.orientation.w = 1.0
        marker.scale.x = 4.0
        r, g, b, a = COLOURS[name]
        marker.color = ColorRGBA(r=r, g=g, b=b, a=a)
        return marker


def decision_outputs(
    planner: MissionPlanner, waypoints: WaypointList | None
) -> list[tuple[str, Path | String | Float64]]:
    """Return what is published when a decision was taken: topic and message."""
    found: list[tuple[str, Path | String | Float64]] = []
    speed = planner.newly_asked_mps(SPEED_STEP_MPS)
    if speed is not None:
        found.append((topics.SPEED, Float64(data=speed)))
    if waypoints is not None:
        found.append((topics.WAYPOINTS, list_to_path(waypoints)))
        if planner.active is not None and waypoints.mode != Mode.LEG:
            found.append((topics.CORNER_PLAN, corner_message(planner.active, waypoints)))
    return found


def status_outputs(planner: MissionPlanner) -> list[tuple[str, String | Float64]]:
    """Return what is published all the time: the mode, and the lag where there is one."""
    lag = planner.lag_m()
    found: list[tuple[str, String | Float64]] = [(topics.MODE, text_message(planner.rule))]
    if lag is not None:
        found.append((topics.LAG, Float64(data=lag)))
    return found


def _airspeed_ratio(values: dict[str, Any]) -> float:
    ratio = float(values.get("airspeed_ratio", 1.0))
    if not RATIOS[0] <= ratio <= RATIOS[1]:
        raise ValueError(ratio)
    return ratio


def status_from_text(text: str) -> UavStatus:
    """Return the autopilot's status from its JSON. Raises ``ValueError`` when it is not one."""
    try:
        values = json.loads(text)
        return UavStatus(
            str(values["mode"]),
            armed=bool(values["armed"]),
            connected=bool(values["connected"]),
            led=bool(values.get("led", False)),
            airspeed_ratio=_airspeed_ratio(values),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(
            f"{text[:80]!r}: expected mode, armed and connected, airspeed_ratio 0.5 to 2"
        ) from error


def monitor_from_text(text: str) -> MonitorStatus:
    """Return the monitor's status from its JSON. Raises ``ValueError`` when it is not one."""
    try:
        values = json.loads(text)
        return MonitorStatus(
            values["alert"] == "escape", str(values["reason"]), int(values["refused_id"])
        )
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{text[:80]!r}: expected alert, reason and refused_id") from error


def vehicle_from_text(text: str) -> Vehicle:
    """Return the UAV that parameters in JSON describe. Raises ``ValueError`` for anything else."""
    try:
        values = {str(name): float(value) for name, value in json.loads(text).items()}
    except (AttributeError, TypeError, ValueError) as error:
        raise ValueError(f"{text[:80]!r}: expected names and numbers") from error
    if not all(math.isfinite(value) for value in values.values()):
        raise ValueError(f"{text[:80]!r}: expected finite numbers")
    return Vehicle(values)


def planner_diagnostics(planner: MissionPlanner, time_s: float) -> DiagnosticArray:
    """Return the planner's status."""
    separation, lag = planner.separation_m(), planner.lag_m()
    return diagnostics(
        time_s,
        "planner",
        problem=planner.problem,
        values={
            "corner": planner.corners_seen,
            "rule": planner.rule,
            "phase": planner.phase,
            "lag_m": "" if lag is None else f"{lag:.1f}",
            "separation_m": "" if separation is None else f"{separation:.1f}",
            "speed_asked_mps": "" if planner.speed_mps is None else f"{planner.speed_mps:.1f}",
            "airspeed_asked_mps": (
                "" if planner.airspeed_mps is None else f"{planner.airspeed_mps:.1f}"
            ),
            "wind_mps": f"{math.hypot(*planner.wind_mps):.1f}",
            "autopilot": planner.vehicle.warning(),
            "corrections": planner.corrections,
            "made_good": f"{planner.made_good:.2f}",
            "turn_radius_m": f"{planner.turn_radius_m:.0f}",
            "kept_lag_m": f"{planner.kept_lag_m:.0f}",
            "lists": 0 if planner.list is None else planner.list.number,
        },
    )
