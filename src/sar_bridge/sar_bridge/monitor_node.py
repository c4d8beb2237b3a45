"""Node ``monitor``: lets waypoint lists pass that keep the aircraft apart; sends the UAV away."""

from __future__ import annotations

import sys

from rclpy.node import Node

from sar_bridge.monitor.component import MonitorComponent
from sar_bridge.monitor.helicopter_hypotheses import Habits
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_support import parameter, parameters, run_node


def make(node: Node) -> MonitorComponent:
    """Return the monitor that a node's parameters describe."""
    limits = parameters(node, MonitorParameters)
    habits = parameters(node, Habits)
    return MonitorComponent(limits, habits, rate_hz=parameter(node, "guard_rate_hz", 2.0))


def main() -> int:
    """Run the node."""
    return run_node("monitor", lambda: ComponentNode("monitor", make))


if __name__ == "__main__":
    sys.exit(main())
