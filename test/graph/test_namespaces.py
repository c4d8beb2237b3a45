"""Two UAVs, each with planner, monitor and bridge in a namespace, behind one estimator."""

import json
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.graph, pytest.mark.timeout(150)]
ROOT = Path(__file__).parents[2]

# The helicopter's receiver, the clock at four times real time, and two simulated autopilots, one on
# either side of it. Both are engaged; what each was told, and where it is, in the end.
WORLD = """
import json, sys, time
from dataclasses import replace
import rclpy
from nav_msgs.msg import Path
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import NavSatFix
from diagnostic_msgs.msg import DiagnosticStatus
from std_srvs.srv import Trigger
from sar_estimator.common import topics
from sar_estimator.common.conversions import fix_to_message, to_stamp
from sar_estimator.common.node_support import LATCHED, RELIABLE
from sar_estimator.common.wires import WIRES
from sar_sim.autopilot.link import AutopilotLink
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import load_scenario
from sar_sim.world.world import World

SPEED, LASTS_S = 4.0, 70.0
scenario = load_scenario(find_scenario("arduplane"))
worlds, links, engaged, uploaded, refused = {}, {}, {}, {}, {}
rclpy.init()
node = rclpy.create_node("world")
clock = node.create_publisher(Clock, topics.CLOCK, RELIABLE)
fix = node.create_publisher(NavSatFix, topics.FIX, qos_profile_sensor_data)
asked = {}
for name, port, side, lag_m in (("uav1", sys.argv[1], 1, 60.0), ("uav2", sys.argv[2], -1, 90.0)):
    pattern = replace(scenario.pattern, turn_side=side)
    one = replace(scenario, pattern=pattern, uav=replace(scenario.uav, lag_m=lag_m))
    worlds[name] = World(one)
    server = AutopilotServer(worlds[name].autopilot, worlds[name].datum)
    links[name] = AutopilotLink(server, int(port), time.monotonic)
    engaged[name] = node.create_client(Trigger, f"/{name}/planner/engage")
    uploaded[name], refused[name] = [], []
    take = WIRES[topics.UPLOADED].from_message
    node.create_subscription(DiagnosticStatus, f"/{name}/uav/uploaded",
        lambda message, name=name: uploaded[name].append(take(message).list_id), RELIABLE)
    hear = WIRES[topics.MONITOR].from_message
    node.create_subscription(DiagnosticStatus, f"/{name}/monitor/state",
        lambda message, name=name: refused[name].append(hear(message).alert), LATCHED)
first, begun, started = worlds["uav1"], time.monotonic(), None
while first.time_s < LASTS_S:
    if time.monotonic() - begun > 100.0:
        sys.exit(f"only at {first.time_s:.0f} s; engaged: {sorted(asked)}")
    clock.publish(Clock(clock=to_stamp(first.time_s)))
    for name, link in links.items():
        link.listen(0.005)
        link.report(first.time_s)
    rclpy.spin_once(node, timeout_sec=0.005)
    there = all(link.heard for link in links.values()) and fix.get_subscription_count() >= 1
    if started is None and there and all(c.service_is_ready() for c in engaged.values()):
        started = time.monotonic() + 3.5
    if started is None or time.monotonic() < started:
        continue
    while first.time_s < SPEED * (time.monotonic() - started):
        for name, world in worlds.items():
            for item in world.step():
                if world is first:
                    fix.publish(fix_to_message(item.fix))
    for name, client in engaged.items():
        answer = asked.get(name)
        if answer is None or (answer.done() and not answer.result().success):
            asked[name] = client.call_async(Trigger.Request())
found = {}
leader = first.helicopter.motion(first.time_s)
for name, world in worlds.items():
    pose = leader.pose
    at = world.autopilot.motion
    found[name] = {
        "across_m": pose.across(at.x_m, at.y_m),
        "along_m": pose.along(at.x_m, at.y_m),
        "mode": world.autopilot.mode.name,
        "uploaded": uploaded[name],
        "alerts": refused[name],
    }
print(json.dumps(found))
"""


def free_ports(count):
    sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


@pytest.fixture
def graph(tmp_path, own_domain):
    """Start one estimator and two chains of nodes; give their environment and ports."""
    ports = free_ports(2)
    wanted = [("sar_estimator", "estimator", "", {})]
    for name, port, side in (("uav1", ports[0], 1), ("uav2", ports[1], -1)):
        url = {"autopilot_url": f"udp:127.0.0.1:{port}"}
        wanted += [
            ("sar_planner", "planner", name, {"turn_side": side}),
            ("sar_bridge", "monitor", name, {}),
            ("sar_bridge", "bridge", name, url),
        ]
    running = []
    for package, executable, namespace, values in wanted:
        program = ROOT / "install" / package / "lib" / package / executable
        options = ["-p", "use_sim_time:=true"]
        for key, value in values.items():
            options += ["-p", f"{key}:={value}"]
        if namespace:
            options += ["-r", f"__ns:=/{namespace}"]
        with (tmp_path / f"{namespace}{executable}.txt").open("wb") as log:
            running.append(
                subprocess.Popen(
                    [str(program), "--ros-args", *options],
                    env=own_domain,
                    stdout=log,
                    stderr=subprocess.STDOUT,
                )
            )
    yield own_domain, ports
    for process in running:
        process.send_signal(signal.SIGINT)
    for process in running:
        try:
            process.wait(timeout=10.0)
        except subprocess.TimeoutExpired:
            process.kill()


def test_two_uavs_fly_on_either_side_of_one_helicopter(graph):
    environment, ports = graph
    world = subprocess.run(
        [sys.executable, "-c", WORLD, *map(str, ports)],
        env=environment,
        timeout=130,
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert world.returncode == 0, world.stderr
    found = json.loads(world.stdout.splitlines()[-1])
    assert found["uav1"]["across_m"] == pytest.approx(-250.0, abs=30.0)
    assert found["uav2"]["across_m"] == pytest.approx(250.0, abs=30.0)
    for one in found.values():
        assert one["mode"] == "AUTO"
        assert abs(one["along_m"]) < 120.0
        assert one["uploaded"]
        assert set(one["alerts"]) == {"none"}
