"""The operator of an offline flight asks in order, again until it is granted."""

import math
from dataclasses import replace

from sar_estimator.common import topics
from sar_planner.strategies.active_corner import Mode
from sar_sim.flight.offline import OfflineFlight
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Find, load_scenario
from sar_sim.world.finder import Finder


def test_it_marks_orbits_and_resumes_each_until_it_is_granted():
    find = Find(time_s=10.0, orbit_s=20.0, ahead_m=300.0, left_m=-40.0)
    finder = Finder([find])
    assert finder.due(9.9) is None
    assert finder.due(10.0) == (topics.TARGET, find)
    finder.granted()
    assert finder.due(10.5) is None  # once a second
    asked = []
    for time_s in (11.0, 12.0, 13.0, 29.0, 31.0, 40.0):
        due = finder.due(time_s)
        if due is not None:
            asked.append((due[0], time_s))
            if len(asked) != 1:  # refused once
                finder.granted()
    assert asked == [(topics.ORBIT, 11.0), (topics.ORBIT, 12.0), (topics.RESUME, 31.0)]


def test_a_find_in_a_mission_is_orbited_and_left_again():
    base = load_scenario(find_scenario("arduplane"))
    scenario = replace(
        base,
        pattern=replace(base.pattern, corners=5),
        finds=[Find(time_s=200.0, orbit_s=200.0, ahead_m=-200.0, left_m=-600.0)],
    )
    flight = OfflineFlight(scenario)
    off, apart, modes = [], [], set()

    def observe(world):
        uav = world.autopilot.motion
        there = world.helicopter.motion(world.time_s)
        mark = flight.planner.find.marks.newest
        apart.append(math.hypot(there.x_m - uav.x_m, there.y_m - uav.y_m))
        if world.time_s > 200.0:
            modes.add(flight.planner.mode)
        if 300.0 < world.time_s < 400.0:
            off.append(abs(math.hypot(uav.x_m - mark.x_m, uav.y_m - mark.y_m) - 300.0))

    flight.run(observe=observe)
    assert Mode.ORBIT in modes
    assert max(off) < 20.0
    assert min(apart) > 180.0
    assert flight.planner.mode is Mode.LEG
    assert abs(flight.planner.lag_m()) < 60.0
