"""Whether the planner may lead the UAV, and can."""

import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import UavStatus
from sar_estimator.common.states import LegEstimate, Motion, Phase
from sar_planner.engagement import not_flying, obstacle
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.patterns.legs import PatternTerms
from sar_planner.prediction.situation import Situation

MISSION = MissionParameters()


@pytest.mark.parametrize(
    ("status", "reason"),
    [
        (UavStatus(), "no heartbeat from the autopilot"),
        (UavStatus("AUTO", connected=True), "UAV not armed: expected it in the air"),
        (
            UavStatus("MANUAL", armed=True, connected=True),
            "UAV in mode MANUAL: expected AUTO or GUIDED",
        ),
        (UavStatus("AUTO", armed=True, connected=True), ""),
        (UavStatus("GUIDED", armed=True, connected=True), ""),
    ],
)
def test_only_an_armed_uav_in_a_mode_that_lists_are_flown_in_is_led(status, reason):
    assert not_flying(status) == reason


def known(**changes):
    values = {
        "uav": Motion(100.0, 0.0, -250.0, 20.0, 0.0),
        "helicopter": Motion(100.0, 0.0, 0.0, 20.0, 0.0),
        "phase": Phase.CRUISE,
        "leg": LegEstimate(100.0, Pose(0.0, 0.0, 0.0), 20.0, 1.0, 0.001, 0.05),
    } | changes
    situation = Situation(CornerParameters(), PatternTerms(side=1))
    for name in ("uav", "helicopter", "leg"):
        if values[name] is not None:
            getattr(situation, f"set_{name}")(values[name])
    situation.set_phase(values["phase"])
    return situation


@pytest.mark.parametrize(
    ("changes", "now_s", "reason"),
    [
        ({}, 101.0, ""),
        ({"uav": None}, 101.0, "no UAV position"),
        ({"helicopter": None}, 101.0, "no helicopter position"),
        ({}, 106.0, "UAV position 6.0 s old (limit 5.0 s)"),
        ({"uav": Motion(106.0, 0.0, 0.0, 20.0, 0.0)}, 106.0, "helicopter position 6.0 s old"),
        (
            {"helicopter": Motion(100.0, 3e4, 0.0, 20.0, 0.0)},
            101.0,
            "helicopter 30 km from the UAV: expected within 20 km",
        ),
        ({"phase": Phase.LOST}, 101.0, "helicopter GPS lost"),
        ({"leg": None}, 101.0, "helicopter's leg not known yet"),
    ],
)
def test_what_is_missing_is_named(changes, now_s, reason):
    found = obstacle(known(**changes), MISSION, now_s)
    assert found.startswith(reason)
    assert bool(found) == bool(reason)
