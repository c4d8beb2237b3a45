"""What is asked of the graph, of which UAV, and what its answers say."""

import pytest
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParametersAtomically
from std_srvs.srv import Trigger

from sar_bridge.requests import slot, trigger
from sar_bridge.services import SERVICES, SIDES, TRACKS
from sar_planner.parameters.mission import MissionParameters


@pytest.mark.parametrize("action", SERVICES)
@pytest.mark.parametrize("uav", ["", "uav2"])
def test_services_are_asked_of_the_uav_named(action, uav):
    prefix = f"/{uav}" if uav else ""
    request = trigger(action, uav)
    assert request.service == prefix + SERVICES[action]
    said = request.said(Trigger.Response(success=False, message="not engaged"))
    assert said == (False, "not engaged")


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("tracks", TRACKS)
def test_every_slot_that_can_be_given_is_one_of_the_planners(side, tracks):
    asked = slot("", side, tracks).asked.parameters
    told = {
        one.name: one.value.string_value or one.value.integer_value  # whichever it is
        for one in asked
    }
    mission = MissionParameters(**told)
    assert (mission.slot.side, mission.slot.tracks) == (side, tracks)


def test_an_answer_is_what_the_planner_says_or_what_it_took():
    request = slot("uav2", "outside", 2)
    assert request.service == "/uav2/planner/set_parameters_atomically"
    for done, reason, text in ((True, "", "outside 2"), (False, "too far out", "too far out")):
        result = SetParametersResult(successful=done, reason=reason)
        assert request.said(SetParametersAtomically.Response(result=result)) == (done, text)
