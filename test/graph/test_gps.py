"""A receiver at a pseudo-terminal, read by the node; its cable is pulled, and put back."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.graph, pytest.mark.timeout(100)]
ROOT = Path(__file__).parents[2]

# A receiver that speaks UBX at 5 Hz at a link to a pseudo-terminal, and who listens to the node.
WORLD = """
import json, os, pty, sys, time, tty
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistWithCovarianceStamped
from pyubx2 import GET, UBXMessage
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import NavSatFix
from sar_estimator.common import topics
from sar_estimator.common.node_support import RELIABLE

link = sys.argv[1]
rclpy.init()
node = rclpy.create_node("world")
fixes, speeds, problems = [], [], []
node.create_subscription(NavSatFix, topics.FIX, fixes.append, qos_profile_sensor_data)
node.create_subscription(
    TwistWithCovarianceStamped, topics.FIX_VELOCITY, speeds.append, qos_profile_sensor_data
)

def note(message):
    for status in message.status:
        if status.name == "gps" and (not problems or problems[-1] != status.message):
            problems.append(status.message)

node.create_subscription(DiagnosticArray, topics.DIAGNOSTICS, note, RELIABLE)

def plug():
    controller, device = pty.openpty()
    tty.setraw(device)
    if os.path.islink(link):
        os.unlink(link)
    os.symlink(os.ttyname(device), link)
    return controller, device

def solution(at_s):
    at = time.gmtime(at_s)
    return UBXMessage(
        "NAV", "NAV-PVT", GET, year=at.tm_year, month=at.tm_mon, day=at.tm_mday, hour=at.tm_hour,
        min=at.tm_min, second=at.tm_sec, nano=round(1e9 * (at_s % 1.0)), validDate=1, validTime=1,
        gnssFixOk=1, fixType=3, numSV=12, lat=37.5, lon=-122.5, hMSL=30000, hAcc=1500, vAcc=2000,
        velN=10000, velE=0, velD=0, sAcc=100, gSpeed=10000,
    ).serialize()

def speak(until, ends, with_port=True):
    begun = time.monotonic()
    last = 0.0
    while time.monotonic() - begun < ends and not until():
        if with_port and time.monotonic() - last > 0.2:
            last = time.monotonic()
            os.write(ports[0], solution(time.time()))
        rclpy.spin_once(node, timeout_sec=0.02)

ports = plug()
speak(lambda: len(fixes) >= 20, 30.0)
first = len(fixes)
os.close(ports[0]); os.close(ports[1])
speak(lambda: any("silent" in one or link in one for one in problems), 30.0, with_port=False)
ports = plug()
speak(lambda: len(fixes) >= first + 20, 30.0)
speak(lambda: problems[-1] == "ok", 10.0)
stamps = [fix.header.stamp.sec + 1e-9 * fix.header.stamp.nanosec for fix in fixes]
print(json.dumps({
    "first": first, "all": len(fixes), "speeds": len(speeds), "problems": problems,
    "place": [fixes[-1].latitude, fixes[-1].longitude], "north": speeds[-1].twist.twist.linear.y,
    "variance": fixes[-1].position_covariance[0], "late": time.time() - stamps[-1],
    "back": sum(after <= before for before, after in zip(stamps, stamps[1:])),
}))
"""


def test_a_receiver_is_read_unplugged_and_read_again(own_domain, tmp_path):
    link = tmp_path / "receiver"
    program = ROOT / "install" / "sar_estimator" / "lib" / "sar_estimator" / "gps"
    with (tmp_path / "gps.txt").open("wb") as log:
        gps = subprocess.Popen(
            [str(program), "--ros-args", "-p", f"receiver:={link},38400"],
            env=own_domain,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            world = subprocess.run(
                [sys.executable, "-c", WORLD, str(link)],
                env=own_domain,
                timeout=90,
                capture_output=True,
                text=True,
                check=False,
            )
        finally:
            gps.terminate()
            assert gps.wait(timeout=15.0) == 0
    assert world.returncode == 0, world.stderr
    found = json.loads(world.stdout.splitlines()[-1])
    assert found["first"] >= 20
    assert found["all"] >= found["first"] + 20
    assert abs(found["speeds"] - found["all"]) <= 2
    assert found["place"] == pytest.approx([37.5, -122.5])
    assert found["north"] == pytest.approx(10.0)
    assert found["variance"] == pytest.approx(0.5 * 1.5**2)
    assert found["late"] < 5.0
    assert found["back"] == 0
    assert found["problems"][-1] == "ok"
    assert any("receiver" in one for one in found["problems"])
