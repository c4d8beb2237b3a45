"""The graph with an autopilot that is not its own: nothing is flown before an operator engages."""

import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_bridge.mission.mission_slots import SLOT_ITEMS, SLOTS
from sar_estimator.bags.bag import read_messages
from sar_estimator.common import topics
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.wires import WIRES
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.link import AutopilotLink
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.launch.launch_cli import free_port
from sar_sim.scenario.scenario import Scenario

pytestmark = [pytest.mark.graph, pytest.mark.timeout(300)]
ROOT = Path(__file__).parents[2]


class Vehicle(threading.Thread):
    """An airborne autopilot in this process, on the bridge's UDP port, at a clock of its own."""

    def __init__(self, port, speed=1.0, north_m=-500.0):
        super().__init__(daemon=True)
        self.speed = speed
        scenario = Scenario()
        self.autopilot = SimAutopilot(
            Pose(250.0, north_m, 1.5708),
            speed_mps=20.0,
            datum=Datum(scenario.datum.latitude_deg, scenario.datum.longitude_deg),
        )
        self.heartbeats = []
        server = AutopilotServer(self.autopilot, scenario.datum)
        self.handle, server.handle = server.handle, self.hear
        self.link = AutopilotLink(server, port, time.monotonic)
        self.running = True

    def hear(self, message, now_s):
        if message.get_type() == "HEARTBEAT":
            self.heartbeats.append(now_s)
        return self.handle(message, now_s)

    def run(self):
        begun, steps = time.monotonic(), 0
        while self.running:
            due = begun + 0.05 * steps / self.speed
            self.link.listen(max(0.0, due - time.monotonic()))
            if time.monotonic() >= due:
                self.autopilot.step(0.05)
                steps += 1
                self.link.report(0.05 * steps)
                # A thread that was held up does not make its clock run faster.
                begun = max(begun, time.monotonic() - 0.05 * steps / self.speed - 0.2)
        self.link.close()


def operator(flight, action):
    done = flight.operator(action)
    return done.returncode, done.stdout


def await_true(condition, timeout_s=60.0):
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.1)


def test_engage_release_engage_and_return_home(launch):
    port = free_port()
    vehicle = Vehicle(port)
    pilot = vehicle.autopilot
    flight = launch("--autopilot", f"udp:127.0.0.1:{port}")
    vehicle.start()
    try:
        await_true(lambda: vehicle.link.heard)
        time.sleep(12.0)  # the planner may be ready by now, and must not engage by itself
        assert pilot.mode is FlightMode.GUIDED
        assert pilot.items == []

        await_true(lambda: operator(flight, "engage") == (0, "engage: engaged\n"))
        await_true(lambda: pilot.mode is FlightMode.AUTO)
        assert len(pilot.items) >= 1 + SLOTS * SLOT_ITEMS  # a long first list makes them larger
        assert (len(pilot.items) - 1) % SLOTS == 0

        pilot.set_mode(FlightMode.LOITER)  # the pilot takes it back
        time.sleep(4.0)
        assert pilot.mode is FlightMode.LOITER
        code, text = operator(flight, "engage")
        assert code == 1
        assert "UAV in mode LOITER: expected AUTO or GUIDED" in text

        pilot.set_mode(FlightMode.GUIDED)
        await_true(lambda: operator(flight, "engage")[0] == 0)
        await_true(lambda: pilot.mode is FlightMode.AUTO)

        assert operator(flight, "return_home")[0] == 0
        await_true(lambda: pilot.mode is FlightMode.RTL)
        time.sleep(3.0)
        assert pilot.mode is FlightMode.RTL
        assert operator(flight, "disengage") == (0, "disengage: disengaged\n")
    finally:
        vehicle.running = False
        vehicle.join(timeout=5.0)
    flight.process.terminate()
    code, _, errors = flight.wait()
    assert (code, errors) == (0, "")


def test_one_command_takes_a_uav_in_auto_into_formation_and_leaves_it_to_who_takes_it(launch):
    port = free_port()
    vehicle = Vehicle(port)
    pilot = vehicle.autopilot
    datum = Scenario().datum
    ahead = waypoint_items(
        np.array([(250.0, 20000.0)]), Datum(datum.latitude_deg, datum.longitude_deg), 150.0
    )
    pilot.load(ahead)
    pilot.set_current(1)
    pilot.set_mode(FlightMode.AUTO)
    flight = launch("--autopilot", f"udp:127.0.0.1:{port}", "--engage")
    vehicle.start()
    try:
        await_true(lambda: len(pilot.items) >= 1 + SLOTS * SLOT_ITEMS)
        assert pilot.mode is FlightMode.AUTO
        pilot.set_mode(FlightMode.LOITER)  # the pilot takes it, and keeps it
        time.sleep(2.0)
        pilot.set_mode(FlightMode.GUIDED)
        time.sleep(8.0)
        assert pilot.mode is FlightMode.GUIDED
    finally:
        vehicle.running = False
        vehicle.join(timeout=5.0)
    flight.process.terminate()
    code, output, errors = flight.wait()
    assert (code, errors) == (0, "")
    assert output.count("engage: engaged\n") == 1


def test_a_planner_that_hangs_stops_the_heartbeats_until_it_is_started_again(launch):
    port = free_port()
    vehicle = Vehicle(port)
    flight = launch("--autopilot", f"udp:127.0.0.1:{port}")
    vehicle.start()
    try:
        await_true(lambda: operator(flight, "engage")[0] == 0)
        await_true(lambda: vehicle.autopilot.mode is FlightMode.AUTO)
        time.sleep(3.0)
        hung = flight.nodes()["planner"]
        os.kill(hung, signal.SIGSTOP)
        begun = time.monotonic()
        await_true(lambda: time.monotonic() - vehicle.heartbeats[-1] > 2.5)
        assert vehicle.heartbeats[-1] - begun < 15.0
        await_true(lambda: flight.nodes().get("planner", hung) != hung)
        again = time.monotonic()
        await_true(lambda: vehicle.heartbeats[-1] > again)
        lists = len(vehicle.autopilot.items)
        assert lists > 0
        await_true(lambda: "engaged" in operator(flight, "engage")[1])  # it is led again: no harm
        time.sleep(3.0)  # until it has been told, and recorded
        assert vehicle.autopilot.mode is FlightMode.AUTO
    finally:
        vehicle.running = False
        vehicle.join(timeout=5.0)
    flight.process.terminate()
    _, _, errors = flight.wait()
    assert "node planner hangs: killed" in errors
    modes = [m.data for t, _, m in read_messages(flight.out / "bag") if t == "/planner/mode"]
    assert "idle" in modes[2:]  # the new planner's first word
    assert modes[-1] != "idle"


CROSSING = """
import time
import numpy as np
import rclpy
from nav_msgs.msg import Odometry, Path
from sar_estimator.common import topics
from sar_estimator.common.wires import WIRES
from sar_estimator.common.conversions import odometry_to_motion, points_to_path
from sar_estimator.common.node_support import LATCHED, RELIABLE
rclpy.init()
node = rclpy.create_node("stranger")
sender = node.create_publisher(Path, topics.WAYPOINTS, LATCHED)
seen = {}
for topic in (topics.HELICOPTER_ODOMETRY, topics.UAV_ODOMETRY):
    take = lambda message, topic=topic: seen.update({topic: odometry_to_motion(message)})
    node.create_subscription(Odometry, topic, take, RELIABLE)
deadline = time.monotonic() + 10.0
while time.monotonic() < deadline:  # the monitor and the recorder, and both aircraft
    rclpy.spin_once(node, timeout_sec=0.1)
    if sender.get_subscription_count() >= 2 and len(seen) == 2:
        break
helicopter, uav = seen[topics.HELICOPTER_ODOMETRY], seen[topics.UAV_ODOMETRY]
times = np.arange(5.0, 50.0, 0.5)
there = np.array((helicopter.x_m, helicopter.y_m)) + times[:, None] * np.array(
    (helicopter.vx_mps, helicopter.vy_mps)
)
way = np.hypot(*(there - (uav.x_m, uav.y_m)).T)
meeting = int(np.abs(way - uav.speed_mps * times).argmin())
beyond = there[meeting] + 100.0 * (there[-1] - there[0]) / np.hypot(*(there[-1] - there[0]))
sender.publish(points_to_path(np.array([there[meeting], beyond]), 777.0))
time.sleep(1.0)
"""


def test_a_list_into_the_helicopters_way_does_not_reach_the_autopilot(launch):
    port = free_port()
    vehicle = Vehicle(port, north_m=200.0)  # ahead of the helicopter: it can get in its way
    flight = launch("--autopilot", f"udp:127.0.0.1:{port}")
    vehicle.start()
    try:
        await_true(lambda: operator(flight, "engage")[0] == 0)
        await_true(lambda: vehicle.autopilot.mode is FlightMode.AUTO)
        time.sleep(2.0)
        subprocess.run(
            [sys.executable, "-c", CROSSING], env=flight.environment, timeout=60, check=True
        )
        time.sleep(2.0)
    finally:
        vehicle.running = False
        vehicle.join(timeout=5.0)
    flight.process.terminate()
    code, _, _ = flight.wait()
    assert code == 0
    told, cleared, offered = [], [], []
    for topic, _, message in read_messages(flight.out / "bag"):
        if topic == topics.MONITOR:
            told.append(WIRES[topic].from_message(message))
        elif topic == topics.CLEARED:
            cleared.append(message.header.stamp.sec)
        elif topic == topics.WAYPOINTS:
            offered.append(message.header.stamp.sec)
    assert 777 in offered
    assert 777 not in cleared
    assert cleared
    assert any(t.refused_id == 777 * 10**9 and "list refused: " in t.reason for t in told)


def times_by_autopilot(bag):
    """Return pairs of the autopilot's clock and the recording's [s]."""
    return np.array(
        [
            (message.clock.sec + 1e-9 * message.clock.nanosec, time_s)
            for _, time_s, message in read_messages(bag, {topics.UAV_CLOCK})
        ]
    )


def test_the_graphs_clock_is_the_autopilots(launch):
    port = free_port()
    vehicle = Vehicle(port, speed=3.0)
    flight = launch("--autopilot", f"udp:127.0.0.1:{port}", "--speed", "3")
    vehicle.start()
    try:
        await_true(lambda: operator(flight, "engage")[0] == 0)
        await_true(lambda: vehicle.autopilot.mode is FlightMode.AUTO)
        time.sleep(15.0)
    finally:
        flight.process.terminate()
        code, _, errors = flight.wait()
        vehicle.running = False
        vehicle.join(timeout=5.0)
    assert (code, errors) == (0, "")
    assert (flight.out / "report.html").exists()
    assert not list(read_messages(flight.out / "bag", {topics.TRUE_UAV}))
    autopilots, recordings = times_by_autopilot(flight.out / "bag").T
    # The clock stands until the graph is complete; the recorder may not even have heard it, and
    # then writes down with one time what came to it meanwhile.
    begun = recordings > recordings[0] + 5.0
    autopilots, recordings = autopilots[begun], recordings[begun]
    assert autopilots[-1] - autopilots[0] > 30.0
    behind = recordings - recordings[0] - (autopilots - autopilots[0])
    assert np.median(np.abs(behind)) < 0.3
    assert np.median(behind[-50:]) == pytest.approx(np.median(behind[:50]), abs=0.5)


def test_a_speed_that_is_not_the_autopilots_ends_the_flight(launch):
    port = free_port()
    vehicle = Vehicle(port)
    flight = launch("--autopilot", f"udp:127.0.0.1:{port}", "--speed", "8")
    vehicle.start()
    try:
        code, _, errors = flight.wait()
    finally:
        vehicle.running = False
        vehicle.join(timeout=5.0)
    assert code == 1
    assert re.search(r"sim: parameter speed = 8: expected (1|0\.9\d*|1\.0\d*), at which", errors)
