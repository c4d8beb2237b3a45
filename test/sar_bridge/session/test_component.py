"""The bridge's component: a session with a simulated autopilot, driven as the node drives it."""

import math

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.session.component import LINK, BridgeComponent
from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import Health, WaypointList
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav

DATUM = Datum(37.8, -122.8)
POINTS = np.array([[200.0, 0.0], [900.0, 10.0], [1800.0, 20.0]])
TICK_S, ROS_S = 0.05, 1000.0


class Flight:
    """A bridge and an autopilot that hand each other what they send, at 20 Hz."""

    def __init__(self, **settings):
        uav = Uav(autopilot="arduplane", **AUTOPILOTS["arduplane"])
        self.pilot = SimAutopilot(Pose(0.0, 0.0, 0.0), speed_mps=20.0, uav=uav, datum=DATUM)
        self.server = AutopilotServer(self.pilot, DATUM)
        self.bridge = BridgeComponent(altitude_m=150.0, **settings)
        self.now_s = 50.0
        self.told = []
        self.sent = []

    def take(self, outputs):
        for topic, value in outputs:
            if topic == LINK:
                for message in value:
                    self.sent.append(message.get_type())
                    self.back(self.server.handle(message, self.now_s))
            else:
                self.told.append((topic, value))

    def back(self, messages):
        for message in messages:
            message._header.srcSystem = message._header.srcComponent = 1
            self.take(self.bridge.receive(message, self.now_s))

    def run(self, for_s):
        for _ in range(round(for_s / TICK_S)):
            self.now_s += TICK_S
            self.bridge.ros_s = ROS_S + self.now_s
            self.pilot.step(TICK_S)
            self.back(self.server.telemetry(self.now_s) + self.server.tick(self.now_s))
            self.take(self.bridge.tick(self.now_s))

    def give(self, topic, value):
        self.take(self.bridge.handle(topic, value, self.now_s))

    def of(self, topic):
        return [value for name, value in self.told if name == topic]


@pytest.fixture
def flight():
    flight = Flight()
    flight.run(2.0)
    return flight


def a_list(list_id=7, time_s=ROS_S + 60.0, points=POINTS):
    return WaypointList(list_id, time_s, points)


def test_telemetry_goes_to_the_graph_once_the_map_is_known(flight):
    assert flight.of(topics.UAV_ODOMETRY) == []
    flight.give(topics.DATUM, DATUM)
    flight.run(1.0)
    report = flight.of(topics.UAV_ODOMETRY)[-1]
    truth = flight.pilot.motion
    assert math.hypot(report.motion.x_m - truth.x_m, report.motion.y_m - truth.y_m) < 3.0
    assert flight.of(topics.UAV_STATE)[-1].mode == "GUIDED"
    assert flight.of(topics.UAV_CLOCK)[-1] == pytest.approx(flight.now_s, abs=0.2)
    reported = dict(flight.bridge.report(flight.now_s))
    assert reported[topics.WIND] == pytest.approx((0.0, 0.0), abs=1e-6)


def test_the_helicopter_that_the_uav_hears_is_told_of():
    flight = Flight(helicopter_icao="00ABCD")
    flight.run(2.0)
    flight.give(topics.DATUM, DATUM)
    for icao in (0xABCD, 0xABCE):
        seen = mavlink.MAVLink_adsb_vehicle_message(
            icao, 378_000_000, -1_228_000_000, 0, 0, 0, 0, 0, b"CG6019", 7, 1, 1, 1200
        )
        flight.back([seen])
    (target,) = flight.of(topics.ADSB)
    assert target.time_s == pytest.approx(flight.bridge.ros_s - 1.0)


def test_a_list_is_uploaded_flown_and_told_of(flight):
    flight.give(topics.DATUM, DATUM)
    flight.give(topics.CLEARED, a_list())
    flight.run(2.0)
    (uploaded,) = flight.of(topics.UPLOADED)
    assert uploaded.list_id == 7
    assert flight.pilot.mode is FlightMode.AUTO
    assert flight.of(topics.UAV_STATE)[-1].tracking_list
    flight.give(topics.SPEED, 22.0)
    flight.run(0.2)
    assert flight.pilot.airspeed_mps == 22.0
    flight.give(topics.SPEED, math.nan)
    flight.run(0.2)
    assert flight.pilot.airspeed_mps == 22.0


def test_a_list_that_comes_before_the_map_waits_for_it(flight):
    flight.give(topics.CLEARED, a_list())
    flight.run(1.0)
    assert flight.of(topics.UPLOADED) == []
    flight.give(topics.DATUM, DATUM)
    flight.run(2.0)
    assert [one.list_id for one in flight.of(topics.UPLOADED)] == [7]


def test_a_list_from_before_the_bridge_never_changes_the_mode(flight):
    flight.give(topics.DATUM, DATUM)
    flight.give(topics.CLEARED, a_list(time_s=ROS_S + 1.0))
    flight.run(2.0)
    assert flight.pilot.mode is FlightMode.GUIDED


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_list_that_is_no_numbers_is_refused_aloud(flight, bad):
    flight.give(topics.DATUM, DATUM)
    flight.give(topics.CLEARED, a_list(points=np.full((3, 2), bad)))
    flight.run(1.0)
    (notice,) = flight.of(NOTICES)
    assert notice.level == "error"
    assert flight.of(topics.UPLOADED) == []


def test_home_is_commanded_and_answered(flight):
    flight.give(topics.DATUM, DATUM)
    flight.give(topics.CLEARED, a_list())
    flight.run(2.0)
    answer = flight.bridge.services[topics.RETURN_HOME](flight.now_s)
    flight.take(answer.outputs)
    flight.run(1.0)
    assert (answer.success, answer.message) == (True, "RTL commanded")
    assert flight.pilot.mode is FlightMode.RTL
    alone = BridgeComponent(altitude_m=150.0)
    refused = alone.services[topics.RETURN_HOME](0.0)
    assert (refused.success, refused.outputs) == (False, [])


def test_a_silent_planner_silences_the_heartbeats_while_a_list_is_flown(flight):
    flight.give(topics.DATUM, DATUM)
    flight.give(topics.DIAGNOSTICS, (Health("planner"), Health("record")))
    flight.give(topics.CLEARED, a_list())
    flight.run(3.0)
    assert flight.sent.count("HEARTBEAT") >= 3
    flight.run(2.0)
    before = flight.sent.count("HEARTBEAT")
    flight.run(3.0)
    assert flight.sent.count("HEARTBEAT") == before
    assert "node planner is silent" in flight.bridge.health(flight.now_s).problem
    flight.give(topics.DIAGNOSTICS, (Health("planner"),))
    flight.run(1.1)
    assert flight.sent.count("HEARTBEAT") > before
    assert [value for topic, value in flight.told if topic == NOTICES] == [
        ("error", "no heartbeats to the autopilot: node planner is silent"),
        ("info", "heartbeats to the autopilot go on"),
    ]


def test_a_dead_link_is_severe(flight):
    flight.bridge.link_breaks = 2
    healthy = flight.bridge.health(flight.now_s)
    assert not healthy.severe
    assert healthy.values["link_breaks"] == 2
    lost = flight.bridge.health(flight.now_s + 4.0)
    assert lost.severe
    assert lost.problem == "autopilot's heartbeat lost"


def test_parameters_are_told_once(flight):
    flight.run(8.0)
    first = dict(flight.bridge.report(flight.now_s))
    assert first[topics.AUTOPILOT]["NAVL1_PERIOD"] == 15.0
    assert topics.AUTOPILOT not in dict(flight.bridge.report(flight.now_s))


def test_it_tells_how_late_lists_come_but_not_of_those_from_before_its_start(flight):
    flight.give(topics.DATUM, DATUM)
    flight.give(topics.CLEARED, a_list(1, ROS_S + 40.0))
    assert flight.bridge.health(flight.now_s).values["list_late_s"] == "0.0"
    flight.give(topics.CLEARED, a_list(2, ROS_S + flight.now_s - 1.3))
    assert flight.bridge.health(flight.now_s).values["list_late_s"] == "1.3"
