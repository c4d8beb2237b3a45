"""Where UAVs had their places, as the report takes them."""

from dataclasses import replace

import numpy as np
import pytest
from shapely import Point

from sar_estimator.bags.bag import BagWriter
from sar_estimator.common import topics
from sar_estimator.common.reports import MonitorReport
from sar_estimator.common.wires import WIRES
from sar_planner.component import PlannerComponent
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.patterns.slot import Slot
from sar_sim.flight.offline import OfflineFlight
from sar_sim.report.flight_data import FlightData, Track, read_flight
from sar_sim.report.metrics import coverage, ideal_slot
from sar_sim.scenario.scenario import Pattern, Scenario, Uav

NONE = Track(np.empty(0), np.empty((0, 2)), np.empty(0))
BESIDE = ((250.0, 700.0), (-250.0, 700.0), (900.0, 1250.0), (900.0, 1750.0))
"""The first leg, inside and outside, and the second."""
CORNERS_S = np.array([0.0, 100.0, 200.0, 300.0, 400.0])


def told(*changes, **mission):
    """Return a flight in which a planner took slots at times [s], as a bag has its records."""
    planner = PlannerComponent(CornerParameters(), MissionParameters(**mission))
    outputs = [(0.5, planner.start(0.5))]
    outputs += [(time_s, planner.change_slot(slot).outputs) for time_s, slot in changes]
    wire, missions = WIRES[topics.MISSION], []
    for time_s, given in outputs:
        (value,) = [one for topic, one in given if topic == topics.MISSION]
        missions.append((time_s, wire.from_message(wire.to_message(value, time_s))))
    return FlightData(NONE, NONE, {}, [], missions, {}, MonitorReport(), simulated=True)


def across_m(data):
    return list(ideal_slot(data, CORNERS_S).across_m)


def test_one_slot_is_that_of_all_legs():
    assert across_m(told()) == [250.0] * 4
    assert across_m(told(turn_side=-1, slot_tracks=2)) == [-500.0] * 4


def test_each_leg_has_the_slot_that_was_asked_for_while_it_was_flown():
    data = told((120.0, Slot("outside")), (290.0, Slot("inside", 3)))
    assert across_m(data) == [250.0, -250.0, -250.0, 750.0]
    late = told((170.0, Slot("outside")))  # for less than half of the second leg
    assert across_m(late) == [250.0, 250.0, -250.0, -250.0]


def test_of_a_pattern_that_leads_back_and_forth_it_is_that_of_the_leg_too():
    data = told((250.0, Slot("right")), pattern="parallel_track")
    assert across_m(data) == pytest.approx([250.0, -350.0, 250.0, 250.0])


def test_a_slot_that_was_told_late_is_that_of_the_legs_before_it():
    data = told()
    data.missions[0] = (350.0, data.missions[0][1])
    assert across_m(data) == [250.0] * 4
    with pytest.raises(LookupError):
        ideal_slot(replace(data, missions=[]), CORNERS_S)


def test_a_flight_whose_slot_was_changed_claims_both_places(tmp_path):
    """The second and third leg are flown outside; before, it was inside."""
    pattern = Pattern(1500.0, 1500.0, corners=2)
    bag = BagWriter(tmp_path / "bag")
    flight = OfflineFlight(
        replace(Scenario(), pattern=pattern, uav=replace(Uav(), lag_m=0.0)), bag=bag
    )
    (chain,), changed_s = flight.chains, flight.world.corners[0].stop_time_s

    def change(world):
        if world.time_s >= changed_s and chain.planner.planner.parameters.slot == Slot():
            flight._bus.publish_all(chain.planner.change_slot(Slot("outside")).outputs, chain.name)

    flight.run(observe=change)
    bag.close()
    data = read_flight(tmp_path / "bag")
    assert [time_s for time_s, _ in data.missions] == pytest.approx([0.0, changed_s], abs=0.3)
    area = coverage([data])
    claimed = [area.claimed.contains(Point(place)) for place in BESIDE]
    assert claimed == [True, False, False, True]
