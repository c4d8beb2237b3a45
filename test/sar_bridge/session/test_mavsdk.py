"""The MAVLink peers of an implementation nobody here wrote: MAVSDK's client and server plugins."""

import asyncio
import math
import os
import socket
import subprocess
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import mavsdk
import numpy as np
import pytest
from mavsdk import System
from mavsdk.mission_raw import MissionItem as RawItem
from mavsdk.mission_raw_server_pb2 import SubscribeIncomingMissionRequest
from mavsdk.telemetry_server import Heading, Position, VelocityNed
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.autopilot_state import AutopilotState
from sar_bridge.mavlink.link import Link
from sar_bridge.mavlink.mission_items import waypoint_items
from sar_bridge.mavlink.mission_upload import MissionUpload, UploadState
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.autopilot.link import AutopilotLink
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.launch.launch_cli import free_port

pytestmark = pytest.mark.timeout(60)
DATUM = Datum(37.8, -122.8)
SERVER = Path(mavsdk.__file__).parent / "bin" / "mavsdk_server"


@contextmanager
def mavsdk_server(port, *options):
    """MAVSDK on a UDP port; yields the port of its own interface."""
    own = free_port()
    command = [str(SERVER), "-p", str(own), *options, f"udpin://127.0.0.1:{port}"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield own
    finally:
        process.kill()
        process.wait()


@contextmanager
def background(work):
    """Run ``work`` again and again in a thread."""
    running = True

    def loop():
        while running:
            work()

    thread = threading.Thread(target=loop)
    thread.start()
    try:
        yield
    finally:
        running = False
        thread.join()


async def connected(port):
    system = System(mavsdk_server_address="127.0.0.1", port=port)
    await asyncio.wait_for(system.connect(), 30.0)
    return system


def raw_item(seq, dx):
    latitude, longitude = 378000000 + 1000 * dx, -1228000000 + 500 * dx
    number = mavlink.MAV_CMD_NAV_WAYPOINT
    return RawItem(
        seq, 3, number, int(seq == 0), 1, 0.0, 7.0, 0.0, 0.0, latitude, longitude, 150.0, 0
    )


def test_mavsdk_uploads_to_downloads_from_and_hears_the_simulated_autopilot():
    port = free_port()
    pilot = SimAutopilot(
        Pose(0.0, 0.0, 0.0),
        speed_mps=20.0,
        datum=DATUM,
    )
    link = AutopilotLink(AutopilotServer(pilot, DATUM), port, time.monotonic)
    begun = time.monotonic()

    def serve():
        link.listen(0.02)
        link.report(time.monotonic() - begun)

    async def talk(own):
        system = await connected(own)
        position = await asyncio.wait_for(anext(aiter(system.telemetry.position())), 20.0)
        assert position.latitude_deg == pytest.approx(37.8, abs=1e-4)
        assert position.relative_altitude_m == pytest.approx(150.0, abs=0.1)
        sent = [raw_item(seq, seq) for seq in range(30)]
        await asyncio.wait_for(system.mission_raw.upload_mission(sent), 20.0)
        back = await asyncio.wait_for(system.mission_raw.download_mission(), 20.0)
        return sent, back

    try:
        with mavsdk_server(port) as own, background(serve):
            sent, back = asyncio.run(talk(own))
    finally:
        link.close()
    assert [(item.x, item.y, item.z) for item in back] == [(i.x, i.y, i.z) for i in sent]
    assert [item.param2 for item in back] == [7.0] * 30
    assert [item.latitude_e7 for item in pilot.items] == [item.x for item in sent]


def test_upload_and_telemetry_pass_against_mavsdks_server_plugins():
    port = free_port()
    link = Link(f"udpout:127.0.0.1:{port}")
    upload, state = MissionUpload(Address(1, 1)), AutopilotState()
    # MAVSDK opens its own interface only once it has heard some autopilot: this is one.
    decoy = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    autopilot = mavlink.MAVLink(None, srcSystem=2, srcComponent=1)
    ground = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3)
    beat_s = 0.0

    def bridge():
        nonlocal beat_s
        now = time.monotonic()
        for message in link.receive(0.02):
            if message.get_srcSystem() == 1:
                state.handle(message, monotonic_s=now, ros_s=now, datum=DATUM)
                link.send(upload.handle(message, now))
        link.send(upload.tick(now))
        if now - beat_s > 0.5:
            beat_s = now
            link.send([ground])
            some = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_FIXED_WING, 3, 0, 0, 4, 3)
            decoy.sendto(some.pack(autopilot), ("127.0.0.1", port))

    items = waypoint_items(np.array([[300.0 + 50.0 * k, 20.0] for k in range(40)]), DATUM, 150.0)

    async def talk(own):
        system = await connected(own)
        # Its Python wrapper ends the stream with the first mission instead of giving it.
        stub = system.mission_raw_server._stub
        missions = stub.SubscribeIncomingMission(SubscribeIncomingMissionRequest())
        await asyncio.sleep(1.0)
        link.send(upload.start(items, None, time.monotonic()))
        plan = (await asyncio.wait_for(anext(aiter(missions)), 30.0)).mission_plan
        position = Position(37.8, -122.8 + 1e-3, 150.0, 150.0)
        for _ in range(10):
            await system.telemetry_server.publish_position(
                position, VelocityNed(0.0, 20.0, 0.0), Heading(90.0)
            )
            await asyncio.sleep(0.1)
        return plan.mission_items

    try:
        with mavsdk_server(port, "--sysid", "1", "--compid", "1") as own, background(bridge):
            got = asyncio.run(talk(own))
    finally:
        link.close()
        decoy.close()
    assert upload.state is UploadState.ACCEPTED
    assert [(i.command, i.x, i.y) for i in got] == [
        (i.command, i.latitude_e7, i.longitude_e7) for i in items
    ]
    motion = state.telemetry.motion
    assert motion.x_m == pytest.approx(88.0, abs=1.0)
    assert math.hypot(motion.vx_mps, motion.vy_mps) == pytest.approx(20.0, abs=0.01)
    assert os.access(SERVER, os.X_OK)
