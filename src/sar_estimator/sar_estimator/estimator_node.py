"""Node ``estimator``: the helicopter's GPS in; odometry, phase and corner out."""

from __future__ import annotations

import math
import sys
from typing import Annotated

from pydantic import ConfigDict, Field
from pydantic.dataclasses import dataclass
from rclpy.node import Node

from sar_estimator.common.checked import Positive
from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import run_node
from sar_estimator.estimation.component import EstimatorComponent, given_datum
from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS, EstimatorParameters


@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class EstimatorNodeParameters:
    """Parameters of the node.

    velocity_sigma_mps: standard deviation of `/helicopter/vel`, the least of
    `/helicopter/fix_velocity`. prediction_rate_hz: of odometry between fixes. datum_latitude_deg,
    datum_longitude_deg, datum_altitude_m: origin of the map; the first fix where they are not set.
    """

    velocity_sigma_mps: Positive = VELOCITY_SIGMA_MPS
    prediction_rate_hz: Annotated[float, Field(gt=0.0, le=100.0)] = 5.0
    datum_latitude_deg: float = math.nan
    datum_longitude_deg: float = math.nan
    datum_altitude_m: float = 0.0


PARAMETERS = (EstimatorParameters, EstimatorNodeParameters)


def make(node: Node) -> EstimatorComponent:
    """Return the estimator that a node's parameters describe."""
    settings, own = parameters(node, EstimatorParameters), parameters(node, EstimatorNodeParameters)
    return EstimatorComponent(
        settings,
        given_datum(own.datum_latitude_deg, own.datum_longitude_deg, own.datum_altitude_m),
        velocity_sigma_mps=own.velocity_sigma_mps,
        rate_hz=own.prediction_rate_hz,
    )


def main() -> int:
    """Run the node."""
    return run_node("estimator", lambda: ComponentNode("estimator", make))


if __name__ == "__main__":
    sys.exit(main())
