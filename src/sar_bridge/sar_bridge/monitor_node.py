"""Node ``monitor``: lets waypoint lists pass that keep the aircraft apart; sends the UAV away."""

from __future__ import annotations

import sys
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass
from rclpy.node import Node

from sar_bridge.monitor.component import MonitorComponent
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.checked import CHECKED
from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import run_node


@dataclass(frozen=True, config=CHECKED)
class MonitorNodeParameters:
    """Parameters of the node.

    guard_rate_hz: how often the list being flown is looked at. others: namespaces of the other
        UAVs, from which this one is kept apart as from the helicopter.
    """

    guard_rate_hz: Annotated[float, Field(ge=1.0, le=50.0)] = 2.0
    others: tuple[str, ...] = ()


PARAMETERS = (MonitorParameters, HelicopterModel, MonitorNodeParameters)


def make(node: Node) -> MonitorComponent:
    """Return the monitor that a node's parameters describe."""
    limits, model = parameters(node, MonitorParameters), parameters(node, HelicopterModel)
    own = parameters(node, MonitorNodeParameters)
    return MonitorComponent(limits, model, rate_hz=own.guard_rate_hz, others=own.others)


def main() -> int:
    """Run the node."""
    return run_node("monitor", lambda: ComponentNode("monitor", make))


if __name__ == "__main__":
    sys.exit(main())
