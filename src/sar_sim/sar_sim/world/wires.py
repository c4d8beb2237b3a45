"""The simulation's own topics, in the table of the graph's: the truth, and the scenario."""

from __future__ import annotations

from diagnostic_msgs.msg import DiagnosticStatus
from nav_msgs.msg import Odometry

from sar_estimator.common import conversions, topics
from sar_estimator.common.reports import UavReport
from sar_estimator.common.statuses import to_status, values_of
from sar_estimator.common.wires import WIRES, Quality, Wire, reader
from sar_sim.scenario.scenario import Scenario
from sar_sim.world.helicopter import CornerTruth


def _truth(what: str, child: str) -> Wire:
    def to_message(report: UavReport, _time_s: float) -> Odometry:
        return conversions.motion_to_odometry(report.motion, child=child, yaw_rad=report.yaw_rad)

    back = WIRES[topics.UAV_ODOMETRY].from_message
    return Wire(what, Odometry, Quality.RELIABLE, to_message, back, lambda report: report)


def _scenario_message(scenario: Scenario, _time_s: float) -> DiagnosticStatus:
    return to_status("scenario", scenario, message=scenario.name)


def _corner_message(corner: CornerTruth, _time_s: float) -> DiagnosticStatus:
    return to_status(f"true corner {corner.k}", corner)


ALL_WIRES: dict[str, Wire] = {
    **WIRES,
    topics.SCENARIO: Wire(
        "what is simulated",
        DiagnosticStatus,
        Quality.LATCHED,
        _scenario_message,
        values_of,
        lambda scenario: scenario,
    ),
    topics.TRUE_CORNER: Wire(
        "a corner as it really is, when it begins",
        DiagnosticStatus,
        Quality.RELIABLE,
        _corner_message,
        reader(CornerTruth),
        lambda corner: corner,
    ),
    topics.TRUE_HELICOPTER: _truth("the helicopter's true motion", "helicopter"),
    topics.TRUE_UAV: _truth("the UAV's true motion", "uav"),
}
