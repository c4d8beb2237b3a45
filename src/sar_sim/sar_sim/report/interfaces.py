"""The text of ``docs/interfaces.md``: topics and services, from what nodes declare."""

from __future__ import annotations

import textwrap

from sar_bridge.monitor.component import MonitorComponent
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.parameters import MonitorParameters
from sar_bridge.services import SERVICES
from sar_bridge.session.component import BridgeComponent
from sar_estimator.common import topics
from sar_estimator.common.component import Component
from sar_estimator.common.wires import WIRES
from sar_estimator.estimation.component import EstimatorComponent
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_estimator.gps.component import GpsComponent
from sar_planner.component import PlannerComponent
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters

SHOWN = {"planner": (topics.MARKERS,)}
TAKEN = {"sim": (topics.UAV_CLOCK,)}
"""What nodes that run no component take."""
REST = """
Beside these: `/clock`, and the truth that a simulation tells: `/sim/helicopter`, `/sim/uav`,
`/sim/corner`, `/sim/scenario`.

SERVICES

Topics in bold are the same for all UAVs. All others, and the services, are relative: with
`--ros-args -r __ns:=/uav2` they are `/uav2/uav/odometry` and so on.

Frame `map`: x east, y north, about the datum (REP-103, REP-105); z of odometry is the altitude
above mean sea level, with a variance of 1e6 where it is not known. NED and 1e7 degrees exist only
inside the bridge.
"""


def _components() -> list[Component]:
    return [
        GpsComponent(),
        EstimatorComponent(EstimatorParameters()),
        PlannerComponent(CornerParameters(), MissionParameters()),
        MonitorComponent(MonitorParameters(), HelicopterModel()),
        BridgeComponent(altitude_m=150.0),
    ]


def interfaces_text() -> str:
    """Return the page."""
    takes = {one.name: tuple(one.inputs) for one in _components()}
    gives = {one.name: (*one.outputs, *SHOWN.get(one.name, ())) for one in _components()}
    takes |= TAKEN
    lines = [
        "# Interfaces",
        "",
        "Written by `ros2 run sar_sim interfaces > docs/interfaces.md`, from what nodes declare.",
        "",
        "| topic | type | what it is | from | to | quality |",
        "|---|---|---|---|---|---|",
    ]
    for topic, wire in WIRES.items():
        package = wire.kind.__module__.partition(".")[0]
        name = f"**`{topic}`**" if topic in topics.COMMON else f"`{topic}`"
        givers = ", ".join(node for node, given in gives.items() if topic in given)
        takers = ", ".join(node for node, taken in takes.items() if topic in taken)
        lines.append(
            f"| {name} | {package}/{wire.kind.__name__} | {wire.what} | {givers or 'every node'} | "
            f"{takers or 'you'} | {wire.quality} |"
        )
    services = ", ".join(f"`{service}`" for service in SERVICES.values())
    said = textwrap.fill(f"Services (std_srvs/Trigger): {services}.", 100)
    return "\n".join(lines) + "\n" + REST.replace("SERVICES", said)
