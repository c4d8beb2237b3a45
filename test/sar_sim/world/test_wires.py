"""What the simulation tells comes out of its messages as it went in."""

import pytest

from sar_estimator.common import topics
from sar_estimator.common.checked import read
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import UavReport
from sar_estimator.common.states import Motion
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Fault, Scenario, load_scenario
from sar_sim.world.helicopter import CornerTruth
from sar_sim.world.wires import ALL_WIRES

TRUTH = CornerTruth(
    3, 10.0, Pose(1.0, 2.0, 0.1), 18.0, Pose(80.0, 5.0, 0.1), 20.0, 2.5, (81.0, 5.0)
)
FLOWN = UavReport(Motion(12.5, 1.0, 2.0, 15.0, 0.0), -0.5)


@pytest.mark.parametrize(
    ("topic", "value"),
    [(topics.TRUE_CORNER, TRUTH), (topics.TRUE_UAV, FLOWN), (topics.TRUE_HELICOPTER, FLOWN)],
)
def test_the_truth_is_carried(topic, value):
    wire = ALL_WIRES[topic]
    message = wire.to_message(value, 0.0)
    assert type(message) is wire.kind
    assert wire.from_message(message) == value


def test_the_aircraft_have_their_own_frames():
    for topic, child in ((topics.TRUE_UAV, "uav"), (topics.TRUE_HELICOPTER, "helicopter")):
        assert ALL_WIRES[topic].to_message(FLOWN, 0.0).child_frame_id == child


def test_a_whole_scenario_is_carried_as_texts():
    scenario = load_scenario(find_scenario("human"))
    faulty = Scenario(name="faulty", faults=[Fault("gps", "off", 3.0)])
    for one in (scenario, faulty):
        message = ALL_WIRES[topics.SCENARIO].to_message(one, 0.0)
        found = ALL_WIRES[topics.SCENARIO].from_message(message)
        assert read(Scenario, found, texts=True) == one
