"""Node ``sim``: the world, the simulated autopilots on MAVLink links, and ``/clock``.

The node is the graph's clock, so it runs its own loop instead of an executor's timers.
"""

from __future__ import annotations

import math
import os
import sys
import time
from pathlib import Path
from typing import Any

import rclpy
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import NavSatFix

from sar_estimator.common import topics
from sar_estimator.common.component_node import publisher, subscribe
from sar_estimator.common.conversions import from_stamp, odometry_to_motion, to_stamp
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import (
    LATCHED,
    RELIABLE,
    Answers,
    Persistent,
    end_process,
    hear_until,
    now_s,
    start_ros,
)
from sar_estimator.common.pose import Pose
from sar_estimator.common.priorities import set_priority
from sar_estimator.common.reports import Target
from sar_sim.bags.tracks import load_track
from sar_sim.nodes.autopilot_links import links_of
from sar_sim.nodes.find_caller_node import FindCaller
from sar_sim.nodes.sim_parameters import SimParameters
from sar_sim.scenario.scenario import Scenario, load_scenario
from sar_sim.world.pacer import AutopilotPacer, Pacer, RealTimePacer
from sar_sim.world.wires import ALL_WIRES
from sar_sim.world.world import World

TOLD = (
    topics.FIX,
    topics.VELOCITY,
    topics.TRUE_HELICOPTER,
    topics.TRUE_CORNER,
    topics.SCENARIO,
    topics.TARGET,
)
STEPS_PER_TRUTH = 2
SPIN_PERIOD_S = 0.02
LONGEST_WAIT_S = 0.02
ENGAGE_PERIOD_S = 0.5
SETTLE_S = 3.5  # longer than DDS takes to repeat what was lost in discovery, 3 s
FLYING_MPS = 5.0


class SimNode(Node):
    """Flies a scenario at a multiple of real time, then ends."""

    def __init__(self) -> None:
        """Read the scenario; create the world, the links and the topics."""
        super().__init__("sim")
        own = parameters(self, SimParameters)
        if not own.scenario:
            raise ValueError("parameter scenario: expected a scenario file")
        self._live = own.live_helicopter
        self._speed = 1.0 if self._live else own.speed
        scenario = load_scenario(Path(own.scenario))
        self._world = self._make_world(scenario, own.track)
        self._links = links_of(self._world, own.mavlink_ports, time.monotonic) if own.uav else {}
        self._follower: AutopilotPacer | None = None
        if own.follow_autopilot:
            self._follower = AutopilotPacer(self._speed)
            first = scenario.formation[0].name
            subscribe(self, topics.of_uav(topics.UAV_CLOCK, first), self._on_uav_clock)
        self._listeners, self._patience_s = own.wait_for_listeners, own.patience_s
        self._clock_sender = self.create_publisher(Clock, topics.CLOCK, RELIABLE)
        names = [member.name for member in scenario.formation]
        told = [*TOLD, *(topics.of_uav(topics.TRUE_UAV, name) for name in names)]
        self._senders = {topic: publisher(self, topic, ALL_WIRES) for topic in told}
        self._tell(topics.SCENARIO, scenario)
        self._corners = list(self._world.corners)
        # Simulated UAVs are engaged from here; a real one's operator does so himself.
        again_s = ENGAGE_PERIOD_S / self._speed
        self._engaging = {name: self._asking(topics.ENGAGE, name, again_s) for name in names}
        self._finds = FindCaller(
            self, scenario.finds, self._world.helicopter, self._mark, again_s, uav=names[0]
        )
        self._steps = 0
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self)

    def _asking(self, service: str, uav: str, again_s: float) -> Persistent:
        return Persistent(self, topics.name_of(topics.of_uav(service, uav)), again_s)

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
        """Close the links."""
        for link in self._links.values():
            link.close()

    def fly(self) -> None:
        """Wait until the graph listens, then fly to the end. Raises ``ValueError`` when alone."""
        self._await_graph()
        pacer: Pacer = self._follower or RealTimePacer(self._speed, time.monotonic())
        last_spin = 0.0
        while rclpy.ok() and not self._world.finished:
            if self._speed > 1.0:
                for link in self._links.values():
                    pacer.stood(link.hold())
            wait = pacer.wait_s(self._world.time_s, time.monotonic())
            self._listen(min(wait, LONGEST_WAIT_S))
            if pacer.wait_s(self._world.time_s, time.monotonic()) <= 0.0:
                self._step()
            now = time.monotonic()
            if now - last_spin > SPIN_PERIOD_S:
                last_spin = now
                self._executor.spin_once(timeout_sec=0.0)
                for name in self._links:
                    self._engaging[name].ask()
                self._finds.ask(self._world.time_s)

    def _on_uav_clock(self, message: Clock) -> None:
        """Go on by the autopilot's clock."""
        assert self._follower is not None
        self._follower.hear(from_stamp(message.clock), time.monotonic())

    def _await_graph(self) -> None:
        """Hold the clock at its start until the graph has been complete for a moment."""
        planners = [f"/{name}/planner" if name else "planner" for name in self._engaging]
        answers = Answers(self, ("estimator", *planners))
        deadline, ready_s = time.monotonic() + self._patience_s, math.inf
        while rclpy.ok():
            self._publish_clock()
            self._listen(0.05)
            self._executor.spin_once(timeout_sec=0.0)
            missing = answers.missing(time.monotonic())
            for name, link in self._links.items():
                link.report(self._world.time_s)
                if not link.heard:
                    missing.append(f"bridge {name}".rstrip())
            heard_by = self._senders[topics.FIX].get_subscription_count()
            absent = 0 if self._live else self._listeners - heard_by
            if absent > 0:
                missing.append(f"{absent} of the listeners on {topics.FIX}")
            for name, engaging in self._engaging.items():
                if not engaging.heard:
                    missing.append(f"the service {topics.of_uav(topics.ENGAGE, name)}")
            if missing:
                ready_s = math.inf
            elif time.monotonic() - (ready_s := min(ready_s, time.monotonic())) > SETTLE_S:
                return
            if time.monotonic() > deadline:
                names = ", ".join(missing)
                raise ValueError(f"not heard of within {self._patience_s} s: {names}")

    def _listen(self, timeout_s: float) -> None:
        if not self._links:
            self._executor.spin_once(timeout_sec=timeout_s)
        for link in self._links.values():
            link.listen(timeout_s / len(self._links))

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
            self._tell(topics.TRUE_CORNER, self._corners.pop(0))
        for reception in receptions:
            for topic, value in reception.told():
                self._tell(topic, value)
        if self._steps % STEPS_PER_TRUTH == 0:
            self._publish_truth()
        for link in self._links.values():
            link.report(self._world.time_s)

    def _publish_truth(self) -> None:
        stamp = now_s(self) if self._live else self._world.true_s
        for topic, truth in self._world.truth(stamp, uav=bool(self._links)):
            self._tell(topic, truth)

    def _mark(self, x_m: float, y_m: float) -> None:
        self._tell(topics.TARGET, Target(self._ros_time(), x_m, y_m))

    def _tell(self, topic: str, value: Any) -> None:
        message = ALL_WIRES[topics.plain(topic)].to_message(value, self._ros_time())
        self._senders[topic].publish(message)


def main() -> int:
    """Fly the scenario; 2 when it cannot be flown."""
    set_priority("sim", os.environ)
    start_ros()
    node: SimNode | None = None
    try:
        node = SimNode()
        node.fly()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except (ValueError, OSError) as error:
        sys.stderr.write(f"sim: {error}\n")
        end_process(2)
    if node is not None:
        node.close()
    return end_process(0)


if __name__ == "__main__":
    sys.exit(main())
