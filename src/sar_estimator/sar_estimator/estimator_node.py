"""Node ``estimator``: the helicopter's GPS in; odometry, phase and corner out."""

from __future__ import annotations

import math
import sys

from rclpy.node import Node

from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_support import parameter, parameters, run_node
from sar_estimator.estimation.component import EstimatorComponent, given_datum
from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS, EstimatorParameters


def make(node: Node) -> EstimatorComponent:
    """Return the estimator that a node's parameters describe."""
    settings = parameters(node, EstimatorParameters)
    latitude = parameter(node, "datum_latitude_deg", math.nan)
    longitude = parameter(node, "datum_longitude_deg", math.nan)
    altitude = parameter(node, "datum_altitude_m", 0.0)
    return EstimatorComponent(
        settings,
        given_datum(latitude, longitude, altitude),
        velocity_sigma_mps=parameter(node, "velocity_sigma_mps", VELOCITY_SIGMA_MPS),
        rate_hz=parameter(node, "prediction_rate_hz", 5.0),
    )


def main() -> int:
    """Run the node."""
    return run_node("estimator", lambda: ComponentNode("estimator", make))


if __name__ == "__main__":
    sys.exit(main())
