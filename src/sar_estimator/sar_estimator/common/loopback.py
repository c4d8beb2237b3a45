"""DDS that stays on this machine: UDP on the loopback interface, no shared memory.

A process that is killed can leave shared memory locked, and hang every other node with it; and with
ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST rmw_fastrtps adds shared memory whatever
FASTDDS_BUILTIN_TRANSPORTS says, and listens on every interface.
"""

from __future__ import annotations

from collections.abc import MutableMapping
from pathlib import Path

PROFILE = Path(__file__).with_name("loopback.xml")
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PROFILE_FILES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")


def stay_on_machine(environment: MutableMapping[str, str]) -> None:
    """Set the variables that keep DDS on loopback, before ``rclpy.init``.

    Nothing changes where the user asks for more: another discovery range than LOCALHOST, a profile
    of his own. An RMW other than Fast DDS gets LOCALHOST.
    """
    wanted = environment.get(RANGE, "LOCALHOST")
    if wanted != "LOCALHOST" or any(name in environment for name in PROFILE_FILES):
        return
    if not environment.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps"):
        environment[RANGE] = "LOCALHOST"
        return
    environment[RANGE] = "SYSTEM_DEFAULT"  # the profile counts, and nothing is added to it
    for name in PROFILE_FILES:
        environment[name] = str(PROFILE)
