"""Node ``bridge``: waypoint lists to the autopilot, its telemetry to the graph, over MAVLink 2."""

from __future__ import annotations

import math
import sys
import threading
import time
from typing import Annotated

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Path
from pydantic import Field
from pydantic.dataclasses import dataclass
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rosgraph_msgs.msg import Clock as ClockMessage
from sensor_msgs.msg import NavSatFix
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from sar_bridge.mavlink.link import Link
from sar_bridge.mavlink.signing import Signer
from sar_bridge.session.interface import INPUTS, OUTPUTS
from sar_bridge.session.liveness import Liveness
from sar_bridge.session.session import AutopilotSession
from sar_estimator.common import topics
from sar_estimator.common.checked import CHECKED
from sar_estimator.common.component_node import publisher, subscribe
from sar_estimator.common.conversions import motion_to_odometry, to_quaternion, to_stamp
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import RELIABLE, now_s, report_each_second, run_node
from sar_estimator.common.reports import Health, UavStatus, Uploaded, WaypointList
from sar_estimator.common.wires import WIRES

TICK_S = 0.05
WATCHED = ("planner", "monitor")


@dataclass(frozen=True, config=CHECKED)
class BridgeParameters:
    """Parameters of the node.

    autopilot_url: `udp:HOST:PORT` (listens), `tcp:HOST:PORT` (connects), `/dev/NAME,BAUD`.
    altitude_m: of every waypoint, above the UAV's home. target_system: MAVLink system to talk to;
    0 for the first autopilot heard. signing_key_file: file with a MAVLink 2 signing key, mode 600;
    without one nothing is signed. node_timeout_s: planner or monitor silent for so long: no more
    heartbeats to the autopilot while a list is flown.
    """

    autopilot_url: str = "udp:127.0.0.1:14550"
    altitude_m: float = 150.0
    target_system: Annotated[int, Field(ge=0, le=255)] = 0
    signing_key_file: str = ""
    node_timeout_s: Annotated[float, Field(ge=2.0)] = 4.0


PARAMETERS = (BridgeParameters,)


class BridgeNode(Node):
    """Joins one link to the graph; the reader thread and the callbacks share one lock."""

    def __init__(self) -> None:
        """Declare parameters, open the link, create topics, services and timers."""
        super().__init__("bridge")
        own = parameters(self, BridgeParameters)
        self._liveness = Liveness(WATCHED, own.node_timeout_s)
        self._session = AutopilotSession(altitude_m=own.altitude_m, target_system=own.target_system)
        key = own.signing_key_file
        self._link = Link(own.autopilot_url, signer=Signer(key, time.time()) if key else None)
        self._lock = threading.RLock()
        self._datum: Datum | None = None
        self._told_state: UavStatus | None = None
        self._told_boot_s = 0.0
        self._told_upload: object = None
        self._running = True
        self._started_s = 0.0
        self._early_list: WaypointList | None = None
        self._senders = {topic: publisher(self, topic) for topic in OUTPUTS}
        self._uav_clock = self.create_publisher(
            ClockMessage, topics.name_of(topics.UAV_CLOCK), RELIABLE
        )
        self._told_autopilot: dict[str, float] = {}
        takers = {
            topics.CLEARED: self._on_list,
            topics.SPEED: self._on_speed,
            topics.DATUM: self._on_datum,
            topics.DIAGNOSTICS: self._on_alive,
        }
        for topic in INPUTS:
            subscribe(self, topic, takers[topic])
        home = topics.name_of(topics.RETURN_HOME)
        self.create_service(Trigger, home, self._on_return_home)
        wall = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(TICK_S, self._on_tick, clock=wall)
        report_each_second(self, self._on_diagnostics)
        self._reader = threading.Thread(target=self._read, name="mavlink", daemon=True)
        self._reader.start()

    def close(self) -> None:
        """Stop reading and close the link."""
        self._running = False
        self._reader.join(timeout=2.0)
        self._link.close()

    def _read(self) -> None:
        while self._running:
            received = self._link.receive(0.05)
            if not received:
                continue
            with self._lock:
                for message in received:
                    self._take(message)

    def _take(self, message: object) -> None:
        out, moved = self._session.handle(
            message, now_s=time.monotonic(), ros_s=now_s(self), datum=self._datum
        )
        self._link.send(out)
        if moved and self._running:
            self._publish_odometry()
        boot_s = self._session.state.boot_s
        if boot_s != self._told_boot_s and self._running:
            self._told_boot_s = boot_s
            self._uav_clock.publish(ClockMessage(clock=to_stamp(boot_s)))
        uploaded = self._session.accepted
        if uploaded is not self._told_upload and uploaded is not None and self._running:
            self._told_upload = uploaded
            upload_ms = round(1e3 * uploaded.duration_s, 1)
            self._publish(topics.UPLOADED, Uploaded(uploaded.list_id, uploaded.items, upload_ms))

    def _publish(self, topic: str, value: object) -> None:
        self._senders[topic].publish(WIRES[topic].to_message(value, now_s(self)))

    def _publish_odometry(self) -> None:
        telemetry = self._session.state.telemetry
        assert telemetry is not None
        message = motion_to_odometry(
            telemetry.motion, child="uav", yaw_rad=telemetry.yaw_rad, up_m=telemetry.up_m
        )
        message.pose.pose.orientation = to_quaternion(
            telemetry.yaw_rad, telemetry.pitch_rad, telemetry.roll_rad
        )
        message.twist.twist.linear.z = telemetry.climb_mps
        self._senders[topics.UAV_ODOMETRY].publish(message)

    def _on_datum(self, message: NavSatFix) -> None:
        try:
            datum = WIRES[topics.DATUM].from_message(message)
        except ValueError as error:
            self.get_logger().error(str(error))
            return
        with self._lock:
            self._datum = datum
            if self._early_list is not None:
                self._take_list(self._early_list, datum)

    def _on_list(self, message: Path) -> None:
        waypoints = WIRES[topics.CLEARED].from_message(message)
        if not (np.isfinite(waypoints.points).all() and math.isfinite(waypoints.climb_m)):
            self.get_logger().error("waypoint list with a position that is no number: refused")
            return
        with self._lock:
            if self._datum is None:
                self._early_list = waypoints
            else:
                self._take_list(waypoints, self._datum)

    def _take_list(self, waypoints: WaypointList, datum: Datum) -> None:
        """Upload a list; one from before this node's start never changes the mode."""
        self._early_list = None
        self._link.send(
            self._session.set_list(
                waypoints.points,
                waypoints.list_id,
                datum,
                time.monotonic(),
                climb_m=waypoints.climb_m,
                may_engage=0.0 < self._started_s <= waypoints.time_s,
            )
        )

    def _on_alive(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self._liveness.hear(status.name, time.monotonic())

    def _on_speed(self, message: Float64) -> None:
        if math.isfinite(message.data):
            with self._lock:
                self._link.send(self._session.set_speed(message.data, time.monotonic()))

    def _on_return_home(
        self, _request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        with self._lock:
            now = time.monotonic()
            commands = self._session.return_home(now)
            self._link.send(commands)
            response.success = bool(commands) and self._session.connected(now)
            response.message = "RTL commanded" if response.success else "no autopilot heard"
        self.get_logger().info(f"return home: {response.message}")
        return response

    def _on_tick(self) -> None:
        now = time.monotonic()
        if self._started_s == 0.0:
            self._started_s = now_s(self)  # the first time a simulated clock is known
        with self._lock:
            self._session.silent = self._liveness.silent(now)
            self._link.send(self._session.tick(now))
            status = self._session.status(now)
        if status != self._told_state:
            self._told_state = status
            self._publish(topics.UAV_STATE, status)

    def _on_diagnostics(self) -> None:
        now = time.monotonic()
        with self._lock:
            session, uploaded = self._session, self._session.accepted
            values = {
                "mode": session.state.mode,
                "armed": session.state.armed,
                "current_item": session.state.current_item,
                "reboots": session.state.clock.reboots,
                "link_breaks": self._link.breaks,
                "upload_ms": "" if uploaded is None else f"{1e3 * uploaded.duration_s:.0f}",
            }
            problem, dead = session.problem(now), not session.connected(now)
            parameters = dict(session.parameters) if session.parameters_told else {}
            wind = session.state.wind.vector_mps
        self._publish(topics.DIAGNOSTICS, Health("bridge", problem, values, severe=dead))
        if parameters and parameters != self._told_autopilot:
            self._told_autopilot = parameters
            self._publish(topics.AUTOPILOT, parameters)
        if wind is not None:
            self._publish(topics.WIND, wind)


def main() -> int:
    """Run the node."""
    return run_node("bridge", BridgeNode)


if __name__ == "__main__":
    sys.exit(main())
