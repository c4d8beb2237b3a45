"""Node ``planner``: what is known of both aircraft in; waypoint lists out."""

from __future__ import annotations

import re
import sys

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped
from nav_msgs.msg import Odometry, Path
from rclpy.node import Node
from std_msgs.msg import Float64, String
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from sar_estimator.common import topics
from sar_estimator.common.conversions import (
    odometry_to_leg,
    odometry_to_motion,
    path_to_corner,
    points_to_path,
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
from sar_planner.conversions import (
    MarkerTracks,
    decision_outputs,
    mission_message,
    monitor_from_text,
    planner_diagnostics,
    status_from_text,
    status_outputs,
    vehicle_from_text,
)
from sar_planner.mission_planner import MissionParameters, MissionPlanner, Mode
from sar_planner.parameters.corner import CornerParameters

FIGURES = re.compile(r"[\d.]+")


class PlannerNode(Node):
    """Feeds the mission planner and publishes its decisions."""

    def __init__(self) -> None:
        """Declare parameters, topics, services and timers."""
        super().__init__("planner")
        corner = parameters(self, CornerParameters)
        mission = parameters(self, MissionParameters)
        rate = parameter(self, "decision_rate_hz", 5.0)
        if not 0.0 < rate <= 100.0:
            raise ValueError(f"parameter decision_rate_hz = {rate}: expected 0 to 100")
        self._planner = MissionPlanner(corner, mission)
        self._markers = MarkerTracks()
        self._newest_s = 0.0
        self._senders = {
            topic: self.create_publisher(kind, topic, qos)
            for topic, kind, qos in (
                (topics.WAYPOINTS, Path, LATCHED),
                (topics.SPEED, Float64, LATCHED),
                (topics.MODE, String, LATCHED),
                (topics.LAG, Float64, RELIABLE),
                (topics.CORNER_PLAN, String, RELIABLE),
                (topics.MISSION, String, LATCHED),
                (topics.MARKERS, MarkerArray, RELIABLE),
                (topics.DIAGNOSTICS, DiagnosticArray, RELIABLE),
            )
        }
        for kind, topic, callback, qos in (
            (Odometry, topics.HELICOPTER_ODOMETRY, self._on_helicopter, RELIABLE),
            (Odometry, topics.UAV_ODOMETRY, self._on_uav, RELIABLE),
            (Odometry, topics.LEG, self._on_leg, RELIABLE),
            (Path, topics.PREDICTION, self._on_prediction, RELIABLE),
            (String, topics.PHASE, self._on_phase, LATCHED),
            (String, topics.UAV_STATE, self._on_state, LATCHED),
            (String, topics.AUTOPILOT, self._on_autopilot, LATCHED),
            (String, topics.MONITOR, self._on_monitor, LATCHED),
            (Vector3Stamped, topics.WIND, self._on_wind, RELIABLE),
        ):
            self.create_subscription(kind, topic, callback, qos)
        self.create_service(Trigger, topics.ENGAGE, self._on_engage)
        self.create_service(Trigger, topics.DISENGAGE, self._on_disengage)
        self.create_timer(1.0 / rate, self._decide)
        report_each_second(self, self._tell)
        self._senders[topics.MISSION].publish(mission_message(self._planner))

    def _on_helicopter(self, message: Odometry) -> None:
        self._planner.set_helicopter(odometry_to_motion(message))

    def _on_uav(self, message: Odometry) -> None:
        self._planner.set_uav(odometry_to_motion(message))

    def _on_leg(self, message: Odometry) -> None:
        self._planner.set_leg(odometry_to_leg(message))

    def _on_phase(self, message: String) -> None:
        if message.data in tuple(Phase):
            self._planner.set_phase(Phase(message.data))

    def _on_state(self, message: String) -> None:
        try:
            status = status_from_text(message.data)
        except ValueError as error:
            self.get_logger().warning(f"{topics.UAV_STATE}: {error}", throttle_duration_sec=5.0)
            return
        was = self._planner.mode
        self._planner.set_status(status)
        if was is not Mode.IDLE and self._planner.mode is Mode.IDLE:
            self._withdraw()

    def _on_autopilot(self, message: String) -> None:
        try:
            vehicle = vehicle_from_text(message.data)
        except ValueError as error:
            self.get_logger().warning(f"{topics.AUTOPILOT}: {error}")
            return
        self._planner.set_vehicle(vehicle)
        if warning := vehicle.warning():
            self.get_logger().warning(warning)

    def _on_monitor(self, message: String) -> None:
        try:
            self._planner.set_monitor(monitor_from_text(message.data))
        except ValueError as error:
            self.get_logger().warning(f"{topics.MONITOR}: {error}", throttle_duration_sec=5.0)

    def _on_wind(self, message: Vector3Stamped) -> None:
        self._planner.set_wind((message.vector.x, message.vector.y))

    def _on_prediction(self, message: Path) -> None:
        try:
            corner = path_to_corner(message)
        except ValueError as error:
            self.get_logger().warning(str(error))
            return
        self._planner.set_corner(corner)
        self._decide()

    def _on_engage(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        reason = self._planner.engage(now_s(self))
        response.success, response.message = not reason, reason or "engaged"
        self.get_logger().info(f"engage: {response.message}")
        self._decide()
        return response

    def _on_disengage(
        self, _request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        self._planner.disengage()
        self._withdraw()
        response.success, response.message = True, "disengaged"
        self.get_logger().info("disengaged")
        return response

    def _withdraw(self) -> None:
        """Tell the bridge that there is no list any more."""
        if self._planner.problem:
            self.get_logger().warning(self._planner.problem)
        self._senders[topics.WAYPOINTS].publish(points_to_path(np.empty((0, 2)), now_s(self)))

    def _decide(self) -> None:
        problem, now = self._planner.problem, now_s(self)
        if now < self._newest_s - 1.0:
            self.get_logger().warning(f"clock set back by {self._newest_s - now:.1f} s")
            self._planner.set_clock_back()
        self._newest_s = now
        waypoints = self._planner.update(now)
        for topic, output in decision_outputs(self._planner, waypoints):
            self._senders[topic].publish(output)
        if waypoints is not None:
            self.get_logger().info(
                f"list {waypoints.number}: {waypoints.mode}, {len(waypoints.points)} waypoints"
            )
        # Said once, however its figures change.
        if self._planner.problem and FIGURES.sub("", self._planner.problem) != FIGURES.sub(
            "", problem
        ):
            self.get_logger().warning(self._planner.problem)

    def _tell(self) -> None:
        now = now_s(self)
        for topic, output in status_outputs(self._planner):
            self._senders[topic].publish(output)
        self._senders[topics.DIAGNOSTICS].publish(planner_diagnostics(self._planner, now))
        self._markers.add("helicopter", self._planner.helicopter)
        self._markers.add("uav", self._planner.uav)
        self._senders[topics.MARKERS].publish(self._markers.message(self._planner, now))


def main() -> int:
    """Run the node."""
    return run_node("planner", PlannerNode)


if __name__ == "__main__":
    sys.exit(main())
