"""Node ``monitor``: lets waypoint lists pass that keep the aircraft apart; sends the UAV away."""

from __future__ import annotations

import json
import math
import sys

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped, Vector3Stamped
from nav_msgs.msg import Odometry, Path
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import NavSatFix
from std_msgs.msg import String

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.monitor.helicopter_hypotheses import Habits
from sar_bridge.monitor.separation_monitor import (
    Alert,
    MonitorNews,
    MonitorParameters,
    SeparationMonitor,
)
from sar_estimator.common import topics
from sar_estimator.common.conversions import (
    diagnostics,
    list_id_of,
    odometry_sigmas,
    odometry_to_leg,
    odometry_to_motion,
    path_speed_mps,
    path_to_corner,
    path_to_points,
    points_to_path,
    text_message,
)
from sar_estimator.common.node_support import (
    LATCHED,
    RELIABLE,
    now_s,
    parameter,
    parameters,
    report_each_second,
    run_node,
)
from sar_estimator.common.states import Phase


class MonitorNode(Node):
    """Stands between planner and bridge, with a process and a computation of its own."""

    def __init__(self) -> None:
        """Declare parameters, topics and timers."""
        super().__init__("monitor")
        limits = parameters(self, MonitorParameters)
        habits = parameters(self, Habits)
        rate = parameter(self, "guard_rate_hz", 2.0)
        if not 1.0 <= rate <= 50.0:
            raise ValueError(f"parameter guard_rate_hz = {rate}: expected 1 to 50")
        self._monitor = SeparationMonitor(limits, habits)
        self._covariance = np.zeros((2, 2))
        self._uav_up_m = self._datum_m = 0.0
        self._led = False
        self._early: Path | None = None
        self._news = MonitorNews()
        self._senders = {
            topic: self.create_publisher(kind, topic, qos)
            for topic, kind, qos in (
                (topics.CLEARED, Path, LATCHED),
                (topics.MONITOR, String, LATCHED),
                (topics.DIAGNOSTICS, DiagnosticArray, RELIABLE),
            )
        }
        for kind, topic, callback, qos in (
            (Path, topics.WAYPOINTS, self._on_list, LATCHED),
            (Odometry, topics.HELICOPTER_ODOMETRY, self._on_helicopter, RELIABLE),
            (Odometry, topics.LEG, self._on_leg, RELIABLE),
            (PoseWithCovarianceStamped, topics.CORNER, self._on_corner, RELIABLE),
            (Path, topics.PREDICTION, self._on_prediction, RELIABLE),
            (String, topics.PHASE, self._on_phase, LATCHED),
            (Odometry, topics.UAV_ODOMETRY, self._on_uav, RELIABLE),
            (Vector3Stamped, topics.WIND, self._on_wind, RELIABLE),
            (String, topics.UAV_STATE, self._on_state, LATCHED),
            (String, topics.UPLOADED, self._on_uploaded, RELIABLE),
            (String, topics.AUTOPILOT, self._on_autopilot, LATCHED),
            (NavSatFix, topics.FIX, self._on_fix, qos_profile_sensor_data),
            (NavSatFix, topics.DATUM, self._on_datum, LATCHED),
        ):
            self.create_subscription(kind, topic, callback, qos)
        self.create_timer(1.0 / rate, self._guard)
        report_each_second(self, self._on_diagnostics)
        self._tell()

    # What is known -----------------------------------------------------------------------------

    def _on_helicopter(self, message: Odometry) -> None:
        self._monitor.helicopter.set_motion(odometry_to_motion(message), *odometry_sigmas(message))

    def _on_leg(self, message: Odometry) -> None:
        self._monitor.helicopter.set_leg(odometry_to_leg(message))

    def _on_corner(self, message: PoseWithCovarianceStamped) -> None:
        covariance = np.asarray(message.pose.covariance).reshape(6, 6)[:2, :2]
        if np.isfinite(covariance).all():
            self._covariance = covariance.copy()

    def _on_prediction(self, message: Path) -> None:
        try:
            corner = path_to_corner(message, self._covariance)
        except ValueError as error:
            self.get_logger().warning(str(error), throttle_duration_sec=5.0)
            return
        self._monitor.helicopter.corner = corner

    def _on_phase(self, message: String) -> None:
        if message.data in tuple(Phase):
            self._monitor.helicopter.phase = Phase(message.data)

    def _on_fix(self, message: NavSatFix) -> None:
        if math.isfinite(message.altitude):
            self._monitor.above_m = self._uav_up_m - (message.altitude - self._datum_m)

    def _on_datum(self, message: NavSatFix) -> None:
        if math.isfinite(message.altitude):
            self._datum_m = message.altitude

    def _on_uav(self, message: Odometry) -> None:
        self._uav_up_m = message.pose.pose.position.z
        self._monitor.set_uav(odometry_to_motion(message))

    def _on_wind(self, message: Vector3Stamped) -> None:
        self._monitor.set_wind((message.vector.x, message.vector.y))

    def _on_state(self, message: String) -> None:
        try:
            self._led = json.loads(message.data)["mode"] in ("AUTO", "GUIDED")
        except (KeyError, TypeError, ValueError) as error:
            self.get_logger().warning(f"{topics.UAV_STATE}: {error}", throttle_duration_sec=5.0)

    def _on_uploaded(self, message: String) -> None:
        try:
            self._monitor.set_uploaded(int(json.loads(message.data)["list_id"]))
        except (KeyError, TypeError, ValueError) as error:
            self.get_logger().warning(f"{topics.UPLOADED}: {error}", throttle_duration_sec=5.0)

    def _on_autopilot(self, message: String) -> None:
        try:
            values = {str(k): float(v) for k, v in json.loads(message.data).items()}
        except (AttributeError, TypeError, ValueError) as error:
            self.get_logger().warning(f"{topics.AUTOPILOT}: {error}")
            return
        self._monitor.tuning = FollowerTuning.read(values)

    # Gate and guard ----------------------------------------------------------------------------

    def _on_list(self, message: Path) -> None:
        """Hand a list on when it may pass; a withdrawal always does."""
        if not message.poses:
            self._monitor.withdraw()
            self._senders[topics.CLEARED].publish(message)
            self._tell()
            return
        now = now_s(self)
        self._early = None
        if self._monitor.unseen:
            self._early = message
        elif self._monitor.passes(
            path_to_points(message), list_id_of(message), now, speed_mps=path_speed_mps(message)
        ):
            self._senders[topics.CLEARED].publish(message)
        else:
            self.get_logger().warning(self._monitor.reason)
        self._tell()

    def _guard(self) -> None:
        if self._early is not None and not self._monitor.unseen:
            self._on_list(self._early)
        if not self._led:
            return
        now = now_s(self)
        escape = self._monitor.update(now)
        if escape is not None:
            self.get_logger().error(self._monitor.reason)
            self._senders[topics.CLEARED].publish(
                points_to_path(escape.points, escape.time_s, climb_m=escape.climb_m)
            )
        self._tell()

    def _tell(self) -> None:
        """Publish the state when it has changed."""
        text = self._news.of(self._monitor)
        if text is not None:
            self._senders[topics.MONITOR].publish(text_message(text))

    def _on_diagnostics(self) -> None:
        monitor = self._monitor
        alert = "" if monitor.alert is Alert.NONE else f"{monitor.alert}: {monitor.nearest}"
        nearest = monitor.nearest.distance_m
        self._senders[topics.DIAGNOSTICS].publish(
            diagnostics(
                now_s(self),
                "monitor",
                problem=monitor.reason or alert,
                values={
                    "alert": monitor.alert,
                    "nearest_m": f"{nearest:.0f}" if math.isfinite(nearest) else "",
                    **{str(name): count for name, count in monitor.counts.items()},
                    **monitor.thresholds,
                },
            )
        )


def main() -> int:
    """Run the node."""
    return run_node("monitor", MonitorNode)


if __name__ == "__main__":
    sys.exit(main())
