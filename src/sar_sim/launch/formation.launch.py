"""A flight with nothing simulated, where ROS 2 Jazzy is installed.

``ros2 launch sar_sim formation.launch.py autopilot_url:=/dev/ttyUSB0,57600 params:=FILE``: a
receiver's driver gives ``/helicopter/fix``; the UAV is led after ``operator engage``. With
``namespace`` planner, monitor and bridge are another UAV's.
"""

from __future__ import annotations

from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription

ARGUMENTS = {
    "autopilot_url": ("udp:127.0.0.1:14550", "MAVLink link to the UAV"),
    "params": ("", "YAML file with the nodes' parameters, or nothing"),
    "namespace": ("", "of planner, monitor and bridge: one for each UAV"),
    "bag": ("", "folder of the recording, which must not exist, or nothing"),
    "estimator": ("true", "whether to start the estimator: one for all UAVs"),
}


def nodes(context: LaunchContext) -> list[Node]:
    """Return the nodes that the arguments ask for."""
    values = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    given = [values["params"]] if values["params"] else []
    found = []
    if values["estimator"] == "true":
        found.append(
            Node(
                package="sar_estimator",
                executable="estimator",
                name="estimator",
                parameters=given,
                output="screen",
            )
        )
    for package, name, own in (
        ("sar_planner", "planner", {}),
        ("sar_bridge", "monitor", {}),
        ("sar_bridge", "bridge", {"autopilot_url": values["autopilot_url"]}),
    ):
        found.append(
            Node(
                package=package,
                executable=name,
                name=name,
                namespace=values["namespace"],
                parameters=[*given, own] if own else given,
                output="screen",
            )
        )
    if values["bag"]:
        recorded = {"bag": values["bag"]}
        found.append(
            Node(
                package="sar_sim",
                executable="record",
                name="record",
                parameters=[*given, recorded],
                output="screen",
            )
        )
    return found


def generate_launch_description() -> LaunchDescription:
    """Return what is to be started."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, (default, description) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=nodes)])
