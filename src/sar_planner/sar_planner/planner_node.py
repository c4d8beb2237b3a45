"""Node ``planner``: what is known of both aircraft in; waypoint lists out."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from sar_estimator.common import topics
from sar_estimator.common.checked import CHECKED
from sar_estimator.common.component import Outputs
from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import run_node
from sar_planner.component import PlannerComponent
from sar_planner.markers import Markers
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters


class ShownPlanner(PlannerComponent):
    """The planner, and its markers, which are ROS messages."""

    outputs = (*PlannerComponent.outputs, topics.MARKERS)

    def __init__(
        self,
        corner: CornerParameters,
        mission: MissionParameters,
        *,
        rate_hz: float,
        yields_to: Sequence[str],
    ) -> None:
        """Begin idle, with nothing shown."""
        super().__init__(corner, mission, rate_hz=rate_hz, yields_to=yields_to)
        self._markers = Markers()

    def report(self, now_s: float) -> Outputs:
        """Tell what is told once a second, and show it."""
        told, planner, lag = super().report(now_s), self.planner, self.planner.lag_m()
        message = self._markers.message(
            now_s,
            helicopter=planner.situation.helicopter,
            uav=planner.situation.uav,
            plan=None if planner.list is None else planner.list.points,
            pattern=self.pattern,
            text=planner.rule if lag is None else f"{planner.rule}  L = {lag:.0f} m",
        )
        return [*told, (topics.MARKERS, message)]


@dataclass(frozen=True, config=CHECKED)
class PlannerNodeParameters:
    """Parameters of the node.

    decision_rate_hz: how often decisions are taken, beside those at every prediction. yields_to:
        namespaces of the UAVs whose lists this one plans around.
    """

    decision_rate_hz: Annotated[float, Field(gt=0.0, le=100.0)] = 5.0
    yields_to: tuple[str, ...] = ()


PARAMETERS = (CornerParameters, MissionParameters, PlannerNodeParameters)


class PlannerNode(ComponentNode):
    """Runs the planner; slot and leg can be changed in flight by the parameters that tell them."""

    def __init__(self) -> None:
        """Make it."""
        self._planner: ShownPlanner
        super().__init__("planner", self._make)
        self.add_on_set_parameters_callback(self._change)

    def _make(self, node: Node) -> ShownPlanner:
        self._planner = make(node)
        return self._planner

    def _change(self, given: list[Parameter]) -> SetParametersResult:
        with self.lock:
            answer = self._planner.change({one.name: one.value for one in given})
            self.publish(answer.outputs)
        return SetParametersResult(successful=answer.success, reason=answer.message)


def make(node: Node) -> ShownPlanner:
    """Return the planner that a node's parameters describe."""
    corner = parameters(node, CornerParameters)
    mission = parameters(node, MissionParameters)
    own = parameters(node, PlannerNodeParameters)
    return ShownPlanner(corner, mission, rate_hz=own.decision_rate_hz, yields_to=own.yields_to)


def main() -> int:
    """Run the node."""
    return run_node("planner", PlannerNode)


if __name__ == "__main__":
    sys.exit(main())
