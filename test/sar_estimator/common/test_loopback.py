"""DDS stays on loopback unless the user asks for more."""

import os
import subprocess
import sys

import pytest

from sar_estimator.common.loopback import PROFILE, RANGE, stay_on_machine


@pytest.mark.parametrize("given", [{}, {RANGE: "LOCALHOST"}])
def test_by_default_it_stays_on_the_machine(given):
    environment = dict(given)
    stay_on_machine(environment)
    assert environment["FASTRTPS_DEFAULT_PROFILES_FILE"] == str(PROFILE)
    assert environment[RANGE] == "SYSTEM_DEFAULT"
    again = dict(environment)
    stay_on_machine(again)
    assert again == environment


@pytest.mark.parametrize(
    "given",
    [
        {RANGE: "SUBNET"},
        {RANGE: "OFF"},
        {"FASTRTPS_DEFAULT_PROFILES_FILE": "mine.xml"},
        {"FASTDDS_DEFAULT_PROFILES_FILE": "mine.xml", RANGE: "LOCALHOST"},
    ],
)
def test_what_the_user_chose_stays(given):
    environment = dict(given)
    stay_on_machine(environment)
    assert environment == given


def test_another_rmw_gets_the_range():
    environment = {"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"}
    stay_on_machine(environment)
    assert environment[RANGE] == "LOCALHOST"
    assert "FASTRTPS_DEFAULT_PROFILES_FILE" not in environment


SOCKETS = """
import os
from pathlib import Path
from sar_estimator.common.loopback import stay_on_machine
stay_on_machine(os.environ)
import rclpy
rclpy.init()
node = rclpy.create_node("alone")
mine = {os.readlink(f"/proc/self/fd/{n}") for n in os.listdir("/proc/self/fd") if n.isdigit()
        and os.path.exists(f"/proc/self/fd/{n}")}
for line in Path("/proc/self/net/udp").read_text().splitlines()[1:]:
    words = line.split()
    if f"socket:[{words[9]}]" in mine:
        print(words[1].split(":")[0])
print(*[name for name in mine if "fastrtps" in name])
"""


def test_a_nodes_sockets_are_on_loopback_and_it_maps_no_shared_memory():
    kept = {k: v for k, v in os.environ.items() if k != RANGE and "PROFILES_FILE" not in k}
    done = subprocess.run(
        [sys.executable, "-c", SOCKETS],
        env=dict(kept, ROS_DOMAIN_ID="95"),
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    addresses, mapped = done.stdout.split("\n")[:-2], done.stdout.split("\n")[-2]
    assert "0100007F" in addresses
    # 239.255.0.1 hears what other nodes of this machine send there.
    assert set(addresses) <= {"0100007F", "0100FFEF"}
    assert mapped == ""
