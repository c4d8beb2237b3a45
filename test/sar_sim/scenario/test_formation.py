"""Which formations can be flown."""

import pytest

from sar_planner.patterns.slot import Slot
from sar_sim.scenario.formation import Member
from sar_sim.scenario.scenario import Scenario, ScenarioError, scenario_document, scenario_of

BOTH = [{"name": "uav1"}, {"name": "uav2", "side": "outside", "tracks": 2}]


def test_one_uav_inside_and_without_a_name_is_what_is_flown_otherwise():
    assert Scenario().formation == [Member()]
    assert Scenario().formation[0].slot == Slot("inside", 1)


def test_a_formation_is_read_and_written_back_the_same():
    scenario = scenario_of({"formation": BOTH, "layer_m": 40.0})
    assert [one.slot for one in scenario.formation] == [Slot(), Slot("outside", 2)]
    assert [scenario.altitude_m(i) for i in range(2)] == [150.0, 190.0]
    assert scenario_of(scenario_document(scenario)) == scenario


@pytest.mark.parametrize(
    ("formation", "message"),
    [
        ([], "formation = .*: expected one UAV or more"),
        ([{"name": "uav1"}, {"side": "outside"}], r"formation\[1\].name = '': expected a name"),
        ([{"name": "UAV 1"}], r"formation\[0\].name = 'UAV 1': expected a name of small"),
        ([{"name": "a"}, {"name": "a", "tracks": 2}], "formation name = 'a': expected each only"),
        ([{"name": "a"}, {"name": "b"}], "formation slot = 'inside': expected each only once"),
        (
            [
                {"name": "a", "autopilot": "tcp:h:1"},
                {"name": "b", "tracks": 2, "autopilot": "tcp:h:1"},
            ],
            "formation autopilot = 'tcp:h:1, system 1': expected another system_id",
        ),
        ([{"side": "above"}], "side"),
        ([{"tracks": 0}], "tracks"),
    ],
)
def test_what_cannot_be_flown_is_refused_by_name(formation, message):
    with pytest.raises(ScenarioError, match=message):
        scenario_of({"formation": formation})
