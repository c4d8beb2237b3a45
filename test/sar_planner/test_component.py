"""The planner as a component: what comes of every input, and of an operator's wishes."""

import math

import numpy as np
import pytest

from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import (
    HelicopterReport,
    MonitorReport,
    UavReport,
    UavStatus,
    Uploaded,
)
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.component import PlannerComponent
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters

FLYING = UavStatus("AUTO", armed=True, connected=True)


def fed(now_s=100.0, component=None):
    """A planner that knows both aircraft on a leg."""
    component = component or PlannerComponent(CornerParameters(), MissionParameters())
    for topic, value in (
        (topics.UAV_STATE, FLYING),
        (topics.HELICOPTER_ODOMETRY, HelicopterReport(Motion(now_s, 0, 0, 20.0, 0.0), 1.0, 0.1)),
        (topics.UAV_ODOMETRY, UavReport(Motion(now_s, 0.0, -250.0, 20.0, 0.0), 0.0)),
        (topics.PHASE, Phase.CRUISE),
        (topics.LEG, LegEstimate(now_s, Pose(0.0, 0.0, 0.0), 20.0, 0.3, 0.001, 0.02)),
        (topics.WIND, (1.0, 0.0)),
    ):
        assert component.handle(topic, value, now_s) == []
    return component


def of(outputs, topic):
    return [value for one, value in outputs if one == topic]


def test_what_it_flies_with_is_told_first():
    ((topic, record),) = PlannerComponent(CornerParameters(), MissionParameters()).start(0.0)
    assert topic == topics.MISSION
    assert record["corner"]["spacing_m"] == 250.0
    assert record["mission"]["rules"] == "deadbeat"


def test_engaged_it_decides_at_once_and_tells_a_speed_when_it_changes():
    component = fed()
    assert component.tick(100.0) == []
    answer = component.services[topics.ENGAGE](100.0)
    assert (answer.success, answer.message) == (True, "engaged")
    assert of(answer.outputs, topics.WAYPOINTS)[0].mode == "leg"
    assert of(answer.outputs, topics.SPEED) == [pytest.approx(20.0, abs=1.0)]
    assert of(component.tick(100.5), topics.SPEED) == []
    late = HelicopterReport(Motion(101.0, 50.0, 0.0, 20.0, 0.0), 1.0, 0.1)
    component.handle(topics.HELICOPTER_ODOMETRY, late, 101.0)
    assert of(component.tick(101.0), topics.SPEED)[0] > 20.0


def test_an_engagement_that_cannot_be_is_refused_with_its_reason():
    component = PlannerComponent(CornerParameters(), MissionParameters())
    answer = component.services[topics.ENGAGE](0.0)
    assert (answer.success, answer.message) == (False, "no heartbeat from the autopilot")


@pytest.mark.parametrize("how", ["operator", "human"])
def test_a_list_is_withdrawn(how):
    component = fed()
    component.services[topics.ENGAGE](100.0)
    if how == "operator":
        outputs = component.services[topics.DISENGAGE](101.0).outputs
    else:
        manual = UavStatus("MANUAL", armed=True, connected=True)
        outputs = component.handle(topics.UAV_STATE, manual, 101.0)
        assert "MANUAL" in of(outputs, NOTICES)[0].text
    (withdrawn,) = of(outputs, topics.WAYPOINTS)
    assert len(withdrawn.points) == 0
    assert withdrawn.list_id == 101_000_000_000
    assert component.tick(101.0) == []


def test_a_problem_is_said_once_however_its_figures_change():
    component = fed()
    component.services[topics.ENGAGE](100.0)
    said = [of(component.tick(106.0 + 0.2 * i), NOTICES) for i in range(10)]
    assert "position" in said[0][0].text
    assert said[1:] == [[]] * 9


def test_health_and_report_tell_what_is_flown():
    component = fed()
    component.services[topics.ENGAGE](100.0)
    told = dict(component.report(100.0))
    assert told[topics.MODE] == "leg"
    assert told[topics.LAG] == pytest.approx(0.0, abs=0.1)
    values = component.health(100.0).values
    assert values["separation_m"] == "250.0"
    assert values["wind_mps"] == "1.0"
    component.handle(topics.MONITOR, MonitorReport("escape", "sent away"), 100.2)
    component.tick(100.2)
    assert component.health(100.2).problem == "monitor: sent away"


def test_an_autopilot_that_must_be_warned_of_is():
    component = fed()
    outputs = component.handle(topics.AUTOPILOT, {"NAVL1_PERIOD": 40.0, "FS_GCS_ENABL": 0.0}, 0.0)
    assert of(outputs, NOTICES)[0].level == "warning"
    component.set_clock_back()
    assert component.planner.situation.helicopter is None


@pytest.mark.parametrize("rate", [0.0, -1.0, 1000.0, math.nan])
def test_a_rate_that_cannot_be_meant_is_named(rate):
    with pytest.raises(ValueError, match="decision_rate_hz"):
        PlannerComponent(CornerParameters(), MissionParameters(), rate_hz=rate)


def test_slot_and_leg_are_changed_in_flight_all_or_nothing():
    component = PlannerComponent(CornerParameters(), MissionParameters())
    progress = component.planner.situation.progress
    answer = component.change({"slot_side": "outside", "pattern_leg": 3})
    assert answer.success
    assert progress.leg == 2
    assert progress.slot.side == "outside"
    assert topics.MISSION in [topic for topic, _ in answer.outputs]
    refused = component.change({"slot_side": "above", "pattern_leg": 7})
    assert not refused.success
    assert "slot_side" in refused.message
    assert "\n" not in refused.message
    assert progress.leg == 2
    assert progress.slot.side == "outside"


def test_a_pattern_is_counted_on_from_the_leg_that_is_told():
    component = PlannerComponent(CornerParameters(), MissionParameters(pattern_leg=4))
    assert component.planner.situation.progress.leg == 3
    assert component.health(0.0).values["pattern_leg"] == 4


def reported(component, topic=topics.PATTERN):
    return of(component.report(100.0), topic)


def test_the_pattern_ahead_is_told_when_it_has_moved():
    mission = MissionParameters(first_leg_m=2000.0, track_spacing_m=500.0)
    component = PlannerComponent(CornerParameters(), mission)
    assert reported(component) == []
    (told,) = reported(fed(component=component))
    assert told[:3] == pytest.approx(np.array([[2000, 0], [2000, -2000], [-500, -2000]]))
    assert reported(component) == []
    aside = LegEstimate(130.0, Pose(600.0, 3.0, 0.0), 20.0, 0.3, 0.001, 0.02)
    component.handle(topics.LEG, aside, 130.0)
    assert reported(component) == []  # three metres are not worth it
    longer = LegEstimate(210.0, Pose(2200.0, 3.0, 0.0), 20.0, 0.3, 0.001, 0.02)
    component.handle(topics.LEG, longer, 210.0)
    (told,) = reported(component)
    assert told[:2] == pytest.approx(np.array([[2200.0, 3.0], [2200.0, -1997.0]]))


def test_the_pattern_ahead_follows_the_corner_that_is_predicted_and_the_leg_after_it():
    mission = MissionParameters(first_leg_m=2000.0, track_spacing_m=500.0)
    component = fed(component=PlannerComponent(CornerParameters(), mission))
    stop = Pose(1500.0, 0.0, 0.0)
    corner = CornerEstimate(168.0, stop, 179.0, 20.0, 2.5, np.eye(2), 0.01, 0.2)
    component.handle(topics.PREDICTION, corner, 168.0)
    (told,) = reported(component)
    assert told[:2] == pytest.approx(np.array([[1500.0, 0.0], [1500.0, -2000.0]]))
    component.handle(topics.PHASE, Phase.CRUISE, 200.0)
    turned = LegEstimate(200.0, Pose(1510.0, -300.0, -math.pi / 2), 20.0, 0.3, 0.001, 0.02)
    component.handle(topics.LEG, turned, 200.0)
    (told,) = reported(component)
    assert told[:2] == pytest.approx(np.array([[1510.0, -2000.0], [-990.0, -2000.0]]))


def test_of_no_pattern_nothing_is_told():
    assert reported(fed()) == []  # how long the legs are is not known


def test_fixes_that_come_late_are_told_of():
    component = fed()
    component.services[topics.ENGAGE](100.0)
    component.handle(topics.FIX_TIME, 98.2, 100.2)
    said = of(component.tick(100.2), NOTICES)
    assert [one.text for one in said] == ["laptop is late: fixes 2.0 s old at decision"]
    health = component.health(100.2)
    assert health.problem == "laptop is late: fixes 2.0 s old at decision"
    assert (health.values["fix_late_s"], health.values["reaction_s"]) == ("2.0", "1.0")
    assert component.health(180.0).values["fix_late_s"] == "0.1"


def test_a_planner_that_leads_nobody_tells_it_too():
    component = fed()
    component.handle(topics.FIX_TIME, 97.0, 100.0)
    component.tick(100.0)
    assert component.health(100.0).problem.startswith("laptop is late")


def rejoining(late_s):
    """Return the list of a UAV that is led back, a list having been flown so late before."""
    component = fed()
    (first,) = of(component.services[topics.ENGAGE](100.0).outputs, topics.WAYPOINTS)
    component.handle(topics.UPLOADED, Uploaded(first.list_id), 100.0 + late_s)
    assert component.planner.timing.reaction_s(100.0 + late_s) == max(late_s, 1.0)
    now = 104.0
    astray = UavReport(Motion(now, -300.0, -600.0, 20.0, 0.0), 0.0)
    component.handle(topics.UAV_ODOMETRY, astray, now)
    component.handle(
        topics.HELICOPTER_ODOMETRY, HelicopterReport(Motion(now, 80.0, 0, 20.0, 0.0), 1.0, 0.1), now
    )
    (found,) = of(component.tick(now), topics.WAYPOINTS)
    assert found.mode == "rejoin"
    return component.planner._strategy.state.path


@pytest.mark.parametrize("late_s", [0.3, 3.0])
def test_a_path_begins_where_the_uav_will_be_when_its_list_is_flown(late_s):
    path = rejoining(late_s)
    start = path.frame.path_to_map(path.path).start
    lead_s = max(late_s * 0.5 ** ((4.0 - late_s) / 20.0), 1.0)
    assert start.x_m == pytest.approx(-300.0 + 20.0 * lead_s, abs=2.1)  # steps of 0.1 s
    assert path.begun_s == pytest.approx(104.0 + lead_s, abs=0.11)
