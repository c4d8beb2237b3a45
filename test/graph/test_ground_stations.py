"""Two ground stations of pymavlink's and one of MAVSDK's beside the bridge, while lists go out."""

import json
import socket
import subprocess
import sys
from pathlib import Path

import mavsdk
import pytest

pytestmark = [pytest.mark.graph, pytest.mark.timeout(150)]
ROOT = Path(__file__).parents[2]
LISTS = 30
BRIDGE = [255, 240]

# The autopilot, who gives the bridge its lists, and the stations. What the autopilot heard is told.
WORLD = """
import asyncio, json, subprocess, sys, threading, time
import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticStatus
from mavsdk import System
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from sar_bridge.mavlink.link import Link
from sar_estimator.common import topics
from sar_estimator.common.component_node import publisher, subscribe
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import WaypointList
from sar_estimator.common.wires import WIRES
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.autopilot.link import AutopilotLink
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav

LISTS = int(sys.argv[6])
DATUM = Datum(37.8, -122.8)
port, *stations = map(int, sys.argv[1:5])
uav = Uav(autopilot="arduplane", **AUTOPILOTS["arduplane"])
pilot = SimAutopilot(Pose(0.0, -250.0, 0.0), speed_mps=20.0, datum=DATUM, uav=uav)
server = AutopilotServer(pilot, DATUM)
link = AutopilotLink(server, port, time.monotonic)
heard, handle = [], server.handle

def noted(message, now_s):
    sender = [message.get_srcSystem(), message.get_srcComponent()]
    kind = message.get_type()
    command = getattr(message, "command", 0) if kind == "COMMAND_LONG" else 0
    heard.append([kind, sender, command])
    return handle(message, now_s)

server.handle = noted
running, begun = True, time.monotonic()

def background(work):
    thread = threading.Thread(target=lambda: [work() for _ in iter(lambda: running, False)])
    thread.start()
    return thread

def fly():
    link.listen(0.01)
    now = time.monotonic() - begun
    while pilot.state.time_s < now:
        pilot.step(0.1)
    link.report(now)

class Station:
    '''Reads mission and parameters again and again; tries to write a mission now and then.'''

    def __init__(self, port, system):
        self.link = Link(f"udp:127.0.0.1:{port}", system=system, component=190)
        self.said, self.texts, self.denied, self.counts = 0.0, set(), 0, 0
        self.read, self.names, self.modes, self.turn = 0, set(), set(), 0
        self.acks, self.foreign, self.taken = [], 0, 0
        self.wanted, self.own = 0, (system, 190)
        self.writing = False

    def work(self):
        for message in self.link.receive(0.02):
            kind = message.get_type()
            to = getattr(message, "target_system", 0), getattr(message, "target_component", 0)
            self.foreign += to[0] not in (0, self.own[0]) or to[1] not in (0, 190)
            if kind == "MISSION_COUNT":
                self.counts, self.wanted = self.counts + 1, message.count
                self.ask(0)
            elif kind == "MISSION_ITEM_INT" and self.wanted:
                if message.seq + 1 < self.wanted:
                    self.ask(message.seq + 1)
                else:
                    self.read, self.wanted = self.read + 1, 0
                    self.link.send([mavlink.MAVLink_mission_ack_message(1, 1, 0, 0)])
            elif kind in ("MISSION_REQUEST_INT", "MISSION_REQUEST"):
                self.link.send([mavlink.MAVLink_mission_item_int_message(
                    1, 1, message.seq, 3, 16, 0, 1, 0, 0, 0, 0, 379000000, -1228000000, 99.0, 0)])
            elif kind == "MISSION_ACK":
                self.denied += message.type == mavlink.MAV_MISSION_DENIED
                self.taken += message.type == mavlink.MAV_MISSION_ACCEPTED
            elif kind == "COMMAND_ACK":
                self.acks.append([message.command, message.result])
            elif kind == "STATUSTEXT":
                self.texts.add(message.text)
            elif kind == "PARAM_VALUE":
                self.names.add(message.param_id)
            elif kind == "HEARTBEAT":
                self.modes.add(message.custom_mode)
        if time.monotonic() - self.said > 1.0:
            self.said, self.turn = time.monotonic(), self.turn + 1
            beat = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
            more = (
                mavlink.MAVLink_mission_request_list_message(1, 1, 0),
                mavlink.MAVLink_param_request_list_message(1, 1),
                mavlink.MAVLink_mission_count_message(1, 1, 4, 0),
            )[self.turn % 3]
            if self.turn == 5:
                arm = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
                more = mavlink.MAVLink_command_long_message(1, 1, arm, 0, 1, 0, 0, 0, 0, 0, 0)
            self.link.send([beat] if self.writing else [beat, more])

    def ask(self, seq):
        self.link.send([mavlink.MAVLink_mission_request_int_message(1, 1, seq, 0)])

first, second = Station(stations[0], 255), Station(stations[1], 254)
rclpy.init()
node = rclpy.create_node("world")
lists, datum = publisher(node, topics.CLEARED), publisher(node, topics.DATUM)
uploaded, states, health = [], [], []
subscribe(node, topics.UPLOADED, lambda m: uploaded.append(WIRES[topics.UPLOADED].from_message(m)))
subscribe(node, topics.UAV_STATE, lambda m: states.append(WIRES[topics.UAV_STATE].from_message(m)))
datum.publish(WIRES[topics.DATUM].to_message(DATUM, 0.0))

def spin(until, within_s):
    ends = time.monotonic() + within_s
    while not until():
        if time.monotonic() > ends:
            return False
        rclpy.spin_once(node, timeout_sec=0.02)
    return True

threads = [background(fly), background(first.work), background(second.work)]
command = [sys.argv[5], "-p", str(stations[2] + 1000), f"udpin://127.0.0.1:{stations[2]}"]
mavsdk = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
found, given = {}, []

async def third(hold):
    system = System(mavsdk_server_address="127.0.0.1", port=stations[2] + 1000)
    await asyncio.wait_for(system.connect(), 30.0)
    async for state in system.core.connection_state():
        if state.is_connected:
            break
    mode = await asyncio.wait_for(anext(aiter(system.telemetry.flight_mode())), 20.0)
    if hold:
        await asyncio.wait_for(system.action.hold(), 20.0)
    return str(mode)

try:
    there = spin(lambda: states and states[-1].connected and first.modes and second.modes, 40.0)
    assert there, "bridge or stations not there"
    spin(lambda: False, 1.0)
    before = len(heard)
    for number in range(1, LISTS + 1):
        list_id = node.get_clock().now().nanoseconds
        given.append(list_id)
        ahead = pilot.motion.x_m + 300.0 + 400.0 * np.arange(3 + number % 5)
        points = np.column_stack((ahead, np.full(len(ahead), -250.0 + number)))
        waypoints = WaypointList(list_id, list_id * 1e-9, points)
        lists.publish(WIRES[topics.CLEARED].to_message(waypoints, list_id * 1e-9))
        if not spin(lambda: uploaded and uploaded[-1].list_id == list_id, 20.0):
            sys.exit(f"list {number} not taken: {len(uploaded)} were")
        spin(lambda: False, 0.3)
    found["mode"] = pilot.mode.name
    found["tracking"] = states[-1].tracking_list
    found["denied"] = first.denied + second.denied
    found["given"], found["lists"] = given, [one.list_id for one in uploaded]
    found["slowest_ms"] = max(one.upload_ms for one in uploaded)
    found["heard"] = heard[before:]
    found["reads"] = spin(lambda: first.read and second.read, 20.0)
    found["armed"] = [one[1] for one in heard if one[2] == 400]
    first.writing = second.writing = True
    found["third"] = asyncio.run(third(True))
    found["released"] = spin(lambda: "LOITER" in states[-1].taken, 10.0)
    were = first.taken
    first.link.send([mavlink.MAVLink_mission_count_message(1, 1, 4, 0)])
    found["written"] = spin(lambda: first.taken > were, 10.0)
    found["items"] = [item.altitude_m for item in pilot.items]
    found["commands"] = [one[2] for one in heard if one[2] == mavlink.MAV_CMD_DO_SET_MODE]
finally:
    running = False
    mavsdk.kill()
    for thread in threads:
        thread.join()
for name, one in (("first", first), ("second", second)):
    found[name] = {
        "read": one.read, "names": len(one.names), "acks": one.acks, "foreign": one.foreign,
        "texts": sorted(one.texts), "modes": sorted(one.modes),
    }
print(json.dumps(found))
"""


def free_ports(count):
    """Return ports that nobody uses, each with the one 1,000 above it free, too."""
    found = []
    while len(found) < count:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
            one.bind(("127.0.0.1", 0))
            port = one.getsockname()[1]
        if port + 1000 < 65536 and port not in found:
            found.append(port)
    return found


def test_stations_see_and_command_while_every_list_goes_out_whole(own_domain, tmp_path):
    port, *stations = free_ports(4)
    program = ROOT / "install" / "sar_bridge" / "lib" / "sar_bridge" / "bridge"
    urls = " ".join(f"udpout:127.0.0.1:{one}" for one in stations)
    options = ["-p", f"autopilot_url:=udp:127.0.0.1:{port}", "-p", f"gcs_url:={urls}"]
    with (tmp_path / "bridge.txt").open("wb") as log:
        bridge = subprocess.Popen(
            [str(program), "--ros-args", *options],
            env=own_domain,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            server = Path(mavsdk.__file__).parent / "bin" / "mavsdk_server"
            numbers = [str(one) for one in (port, *stations)]
            world = subprocess.run(
                [sys.executable, "-c", WORLD, *numbers, str(server), str(LISTS)],
                env=own_domain,
                timeout=130,
                capture_output=True,
                text=True,
                check=False,
            )
        finally:
            bridge.terminate()
            assert bridge.wait(timeout=15.0) == 0
    assert world.returncode == 0, world.stderr
    found = json.loads(world.stdout.splitlines()[-1])
    assert len(found["lists"]) == LISTS
    assert found["lists"] == found["given"]
    assert found["mode"] == "AUTO"
    assert found["tracking"]
    heard = found["heard"]
    assert {tuple(sender) for kind, sender, _ in heard if kind == "HEARTBEAT"} == {tuple(BRIDGE)}
    writers = {tuple(sender) for kind, sender, _ in heard if kind == "MISSION_ITEM_INT"}
    assert writers == {tuple(BRIDGE)}
    readers = {tuple(sender) for kind, sender, _ in heard if kind == "MISSION_REQUEST_LIST"}
    assert {(255, 190), (254, 190)} <= readers
    assert sorted(found["armed"]) == [[254, 190], [255, 190]]
    assert found["denied"] > 0
    assert found["reads"]
    for name in ("first", "second"):
        one = found[name]
        assert one["names"] > 5
        assert one["foreign"] == 0
        assert [number for number, _ in one["acks"]] == [400]
        assert "In formation: disengage to write a mission" in one["texts"]
        assert one["modes"][0] == 10  # AUTO, seen before LOITER
    assert found["released"]
    assert found["written"]
    assert found["items"] == [99.0] * 4
