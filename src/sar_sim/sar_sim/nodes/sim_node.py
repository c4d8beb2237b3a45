"""Node ``sim``: the world, the simulated autopilot on a MAVLink link, and ``/clock``.

The node is the graph's clock, so it runs its own loop instead of an executor's timers.
"""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path

import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import NavSatFix
from std_msgs.msg import String

from sar_estimator.common import topics
from sar_estimator.common.conversions import (
    fix_to_message,
    from_stamp,
    odometry_to_motion,
    text_message,
    to_stamp,
    velocity_message,
)
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.node_support import (
    LATCHED,
    RELIABLE,
    Answers,
    Persistent,
    end_process,
    hear_until,
    now_s,
    parameter,
    start_ros,
)
from sar_estimator.common.pose import Pose
from sar_sim.autopilot.link import AutopilotLink
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.bags.codecs import corner_truth_text, scenario_text
from sar_sim.bags.tracks import load_track
from sar_sim.scenario.scenario import Scenario, load_scenario
from sar_sim.world.pacer import AutopilotPacer, Pacer, RealTimePacer
from sar_sim.world.world import World

STEPS_PER_TRUTH = 2
SPIN_PERIOD_S = 0.02
LONGEST_WAIT_S = 0.02
ENGAGE_PERIOD_S = 0.5
SETTLE_S = 3.5  # longer than DDS takes to repeat what was lost in discovery, 3 s
FLYING_MPS = 5.0


class SimNode(Node):
    """Flies a scenario at a multiple of real time, then ends."""

    def __init__(self) -> None:
        """Read the scenario; create the world, the link and the topics."""
        super().__init__("sim")
        path = parameter(self, "scenario", "")
        if not path:
            raise ValueError("parameter scenario: expected a scenario file")
        self._speed = parameter(self, "speed", 10.0)
        if not 0.0 < self._speed <= 100.0:
            raise ValueError(f"parameter speed = {self._speed}: expected 0 to 100")
        track = parameter(self, "track", "")
        self._live = parameter(self, "live_helicopter", default=False)
        if self._live:
            self._speed = 1.0
        scenario = load_scenario(Path(path))
        self._world = self._make_world(scenario, track)
        self._link: AutopilotLink | None = None
        if parameter(self, "uav", default=True):
            server = AutopilotServer(self._world.autopilot, self._world.datum)
            port = parameter(self, "mavlink_port", 14550)
            seed = scenario.gps.seed
            self._link = AutopilotLink(server, port, time.monotonic, scenario.faults, seed)
        self._follower: AutopilotPacer | None = None
        if parameter(self, "follow_autopilot", default=False):
            self._follower = AutopilotPacer(self._speed)
            self.create_subscription(
                Clock, topics.name_of(topics.UAV_CLOCK), self._on_uav_clock, RELIABLE
            )
        self._listeners = parameter(self, "wait_for_listeners", 1)
        self._patience_s = parameter(self, "patience_s", 30.0)
        self._clock_sender = self.create_publisher(Clock, topics.CLOCK, RELIABLE)
        self._fix = self.create_publisher(NavSatFix, topics.FIX, qos_profile_sensor_data)
        self._velocity = self.create_publisher(
            TwistStamped, topics.VELOCITY, qos_profile_sensor_data
        )
        self._true_helicopter = self.create_publisher(Odometry, topics.TRUE_HELICOPTER, RELIABLE)
        self._true_uav = self.create_publisher(Odometry, topics.name_of(topics.TRUE_UAV), RELIABLE)
        self._true_corner = self.create_publisher(String, topics.TRUE_CORNER, RELIABLE)
        self._scenario = self.create_publisher(String, topics.SCENARIO, LATCHED)
        self._scenario.publish(text_message(scenario_text(scenario)))
        self._corners = list(self._world.corners)
        # A simulated UAV is engaged from here; a real one's operator does so himself.
        self._engaging = Persistent(
            self, topics.name_of(topics.ENGAGE), ENGAGE_PERIOD_S / self._speed
        )
        self._steps = 0
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self)

    def _make_world(self, scenario: Scenario, track: str) -> World:
        if self._live:
            return World(scenario, live=self._await_helicopter())
        return World(scenario, load_track(Path(track)) if track else None)

    def _await_helicopter(self) -> tuple[Datum, Pose]:
        """Wait until a real helicopter flies; the UAV begins at the scenario's lag behind it."""
        self.get_logger().info(f"waiting for a helicopter in flight on {topics.FIX}")
        topic, datum = topics.HELICOPTER_ODOMETRY, topics.DATUM
        heard = hear_until(
            self,
            [(NavSatFix, datum, LATCHED), (Odometry, topic, RELIABLE)],
            lambda it: len(it) > 1 and odometry_to_motion(it[topic]).speed_mps > FLYING_MPS,
        )
        origin, pose = heard[datum], odometry_to_motion(heard[topic]).pose
        return Datum(origin.latitude, origin.longitude, origin.altitude), pose

    def close(self) -> None:
        """Close the link."""
        if self._link is not None:
            self._link.close()

    def fly(self) -> None:
        """Wait until the graph listens, then fly to the end. Raises ``ValueError`` when alone."""
        self._await_graph()
        pacer: Pacer = self._follower or RealTimePacer(self._speed, time.monotonic())
        last_spin = 0.0
        while rclpy.ok() and not self._world.finished:
            if self._link is not None and self._speed > 1.0:
                pacer.stood(self._link.hold())
            wait = pacer.wait_s(self._world.time_s, time.monotonic())
            self._listen(min(wait, LONGEST_WAIT_S))
            if pacer.wait_s(self._world.time_s, time.monotonic()) <= 0.0:
                self._step()
            now = time.monotonic()
            if now - last_spin > SPIN_PERIOD_S:
                last_spin = now
                self._executor.spin_once(timeout_sec=0.0)
                if self._link is not None:
                    self._engaging.ask()

    def _on_uav_clock(self, message: Clock) -> None:
        """Go on by the autopilot's clock."""
        assert self._follower is not None
        self._follower.hear(from_stamp(message.clock), time.monotonic())

    def _await_graph(self) -> None:
        """Hold the clock at its start until the graph has been complete for a moment."""
        answers = Answers(self, ("estimator", "planner"))
        deadline, ready_s = time.monotonic() + self._patience_s, math.inf
        while rclpy.ok():
            self._publish_clock()
            self._listen(0.05)
            self._executor.spin_once(timeout_sec=0.0)
            missing = answers.missing(time.monotonic())
            if self._link is not None:
                self._link.report(self._world.time_s)
                if not self._link.heard:
                    missing.append("bridge")
            absent = 0 if self._live else self._listeners - self._fix.get_subscription_count()
            if absent > 0:
                missing.append(f"{absent} of the listeners on {topics.FIX}")
            if not self._engaging.heard:
                missing.append(f"the service {topics.ENGAGE}")
            if missing:
                ready_s = math.inf
            elif time.monotonic() - (ready_s := min(ready_s, time.monotonic())) > SETTLE_S:
                return
            if time.monotonic() > deadline:
                names = ", ".join(missing)
                raise ValueError(f"not heard of within {self._patience_s} s: {names}")

    def _listen(self, timeout_s: float) -> None:
        if self._link is None:
            self._executor.spin_once(timeout_sec=timeout_s)
        else:
            self._link.listen(timeout_s)

    def _ros_time(self) -> float:
        if self._live:
            return now_s(self)
        return self._world.ros_s

    def _publish_clock(self) -> None:
        if self._live:
            return
        self._clock_sender.publish(Clock(clock=to_stamp(self._ros_time())))

    def _step(self) -> None:
        receptions = self._world.step()
        self._steps += 1
        self._publish_clock()
        while self._corners and self._corners[0].onset_time_s <= self._world.time_s:
            self._true_corner.publish(text_message(corner_truth_text(self._corners.pop(0))))
        for reception in receptions:
            fix, velocity = reception.fix, reception.velocity
            if velocity is not None:
                self._velocity.publish(
                    velocity_message(fix.time_s, velocity.vx_mps, velocity.vy_mps)
                )
            self._fix.publish(fix_to_message(fix))
        if self._steps % STEPS_PER_TRUTH == 0:
            self._publish_truth()
        if self._link is not None:
            self._link.report(self._world.time_s)

    def _publish_truth(self) -> None:
        simulated = self._link is not None
        stamp = now_s(self) if self._live else self._world.true_s
        for topic, message in self._world.truth(stamp, uav=simulated):
            sender = self._true_uav if topic == topics.TRUE_UAV else self._true_helicopter
            sender.publish(message)


def main() -> int:
    """Fly the scenario; 2 when it cannot be flown."""
    start_ros()
    node: SimNode | None = None
    try:
        node = SimNode()
        node.fly()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except (ValueError, OSError) as error:
        sys.stderr.write(f"sim: {error}\n")
        return 2 if node is None else end_process(2)
    if node is not None:
        node.close()
    return end_process(0)


if __name__ == "__main__":
    sys.exit(main())
