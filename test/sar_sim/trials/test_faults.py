"""Injected faults: what they do, and that the UAV stays away whatever the receiver says."""

import math
from operator import itemgetter
from types import SimpleNamespace

import numpy as np
import pytest

from sar_estimator.bags.bag import BagWriter
from sar_estimator.common.checked import read
from sar_estimator.common.gps_fix import Fix
from sar_sim.campaign.missions import Observer
from sar_sim.flight.offline import OfflineFlight
from sar_sim.scenario.faults import AutopilotFaults, FaultyRadio, NodeFaults
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import FAULTS, Fault, load_scenario
from sar_sim.trials import fault_runs, faults_cli
from sar_sim.trials.fault_runs import (
    CASES,
    HEADER,
    NODES,
    fault_scenario,
    fault_speed,
    read_run,
    silent_s,
)
from sar_sim.world.faulty_receiver import FaultyReceiver
from sar_sim.world.gps import Reception
from sar_sim.world.world import World


class Northward:
    """A receiver that moves 1e-4 degrees a second, one fix a second."""

    def __init__(self):
        self.given = 0

    def due(self, time_s):
        fixes = []
        while self.given + 1 <= time_s:
            self.given += 1
            fix = Fix(float(self.given), 37.8 + 1e-4 * self.given, -122.8, 0.0, np.eye(2))
            fixes.append(Reception(fix))
        return fixes


def received(kind, size=0.5):
    """Return (time of reception, fix) of 60 s with a fault from 20 to 40 s."""
    receiver = FaultyReceiver(Northward(), [Fault("gps", kind, 20.0, 20.0, size)], seed=3)
    return [(t, item.fix) for t in range(1, 61) for item in receiver.due(float(t))]


def during(fixes):
    return [fix for t, fix in fixes if 20 <= t < 40]


@pytest.mark.parametrize("kind", FAULTS["gps"])
def test_before_and_after_a_fault_all_is_well(kind):
    fixes = received(kind, size=2.0 if kind in ("delayed", "slow") else 0.5)
    for t, fix in fixes:
        if t < 20 or t >= 43:
            assert fix.latitude_deg == pytest.approx(37.8 + 1e-4 * fix.time_s)
            assert fix.time_s == t


def test_receiver_faults_do_what_they_are_called():
    assert during(received("off")) == []
    stuck = during(received("stuck"))
    assert {fix.latitude_deg for fix in stuck} == {37.8 + 1e-4 * 19}
    assert [fix.time_s for fix in stuck] == list(range(20, 40))
    garbage = [fix.latitude_deg for fix in during(received("garbage"))]
    assert len(garbage) == 20
    assert any(math.isnan(value) for value in garbage)
    assert np.nanstd(garbage) > 20.0
    wrong = during(received("wrong", 150.0))
    metres = [(fix.latitude_deg - 37.8 - 1e-4 * fix.time_s) * 111_000.0 for fix in wrong]
    assert metres == pytest.approx([150.0] * 20, abs=1e-6)
    assert [fix.time_s for fix in during(received("slow", 4.0))] == [20, 24, 28, 32, 36]
    late = [(t, fix.time_s) for t, fix in received("delayed", 3.0) if 23 <= t < 43]
    assert all(t - stamp in (0.0, 3.0) for t, stamp in late)
    assert sum(t - stamp == 3.0 for t, stamp in late) == 20
    assert 4 < len(during(received("intermittent", 0.5))) < 16


def test_radio_faults_do_what_they_are_called():
    for kind, size, share in (("off", 0.5, 0.0), ("slow", 4.0, 0.25), ("intermittent", 0.4, 0.6)):
        radio = FaultyRadio([Fault("radio", kind, 10.0, 10.0, size)], seed=1)
        assert all(radio.gets_through(5.0) for _ in range(100))
        heard = sum(radio.gets_through(15.0) for _ in range(1000)) / 1000.0
        assert heard == pytest.approx(share, abs=0.05)
        assert all(radio.gets_through(20.0) for _ in range(100))


def test_nodes_are_killed_and_stopped_in_time():
    faults = [
        Fault("planner", "stuck", 20.0, 5.0),
        Fault("bridge", "off", 10.0),
        Fault("gps", "off", 1.0),
    ]
    nodes = NodeFaults(faults, NODES)
    assert nodes.due(9.0) == []
    assert nodes.due(20.0) == [("bridge", "kill"), ("planner", "stop")]
    assert nodes.due(24.0) == []
    assert nodes.due(99.0) == [("planner", "go on")]
    assert nodes.due(99.0) == []


def test_dds_is_cut_and_let_through_again():
    cut = NodeFaults([Fault("dds", "off", 20.0, 5.0), Fault("planner", "off", 1.0)], ("dds",))
    assert cut.due(20.0) == [("dds", "stop")]
    assert cut.due(25.0) == [("dds", "go on")]


def test_an_autopilot_boots_after_its_fault_and_its_mode_is_changed_once():
    faults = AutopilotFaults([Fault("autopilot", "off", 10.0, 3.0), Fault("mode", "wrong", 20.0)])
    assert not faults.booted(12.9)
    assert faults.booted(13.0)
    assert not faults.booted(14.0)
    assert not faults.taken(19.9)
    assert faults.taken(25.0)
    assert not faults.taken(26.0)
    radio = FaultyRadio([Fault("autopilot", "off", 10.0, 3.0)], seed=1)
    assert [radio.gets_through(t) for t in (9.9, 10.0, 12.9, 13.0)] == [True, False, False, True]


@pytest.mark.parametrize("step", [30.0, -30.0])
def test_a_clock_that_is_stepped_shows_in_the_fixes_and_not_in_the_truth(step):
    base = load_scenario(find_scenario("arduplane"))
    world = World(fault_scenario(base, Fault("clock", "wrong", 5.0, size=step)))
    stamps = []
    while world.time_s < 10.0:
        stamps += [item.fix.time_s - world.time_s for item in world.step()]
    assert stamps[0] == pytest.approx(0.0, abs=0.06)
    assert stamps[-1] == pytest.approx(step, abs=0.06)
    assert world.ros_s - world.true_s == step
    with pytest.raises(ValueError, match=r"at_s = -1.0: expected 0 or more"):
        read(Fault, {"component": "clock", "kind": "wrong", "at_s": -1.0, "size": step})


GPS_CASES = [fault for fault in CASES if fault.component == "gps"]


@pytest.mark.parametrize("fault", GPS_CASES, ids=lambda fault: f"{fault.kind}-{fault.for_s:g}")
def test_whatever_the_receiver_says_the_aircraft_stay_apart(fault):
    """From 15 s before the first corner on, or through it."""
    scenario = fault_scenario(load_scenario(find_scenario("arduplane")), fault)
    flight = OfflineFlight(scenario)
    seen = Observer(flight.world)
    flight.run(observe=seen)
    assert seen.separation_m > 180.0
    if fault.for_s <= 60.0:  # blind for longer, it is left behind further than it makes up for
        assert abs(seen.lags_m[0][-1]) < 300.0


def test_how_long_a_node_did_no_work_is_read_of_its_own_messages(tmp_path, monkeypatch):
    """Killed at 60 s, heard of again at 66.5 s."""
    mine = SimpleNamespace(status=[SimpleNamespace(name="monitor")])
    other = SimpleNamespace(status=[SimpleNamespace(name="planner")])
    said = [(time_s, mine) for time_s in (58.0, 59.0, 66.5, 67.5)]
    said += [(time_s, other) for time_s in (60.5, 61.5)]
    messages = [
        ("/diagnostics", time_s, message) for time_s, message in sorted(said, key=itemgetter(0))
    ]
    monkeypatch.setattr(fault_runs, "read_messages", lambda _bag, _topics: messages)
    assert silent_s(Fault("monitor", "off", 60.0), tmp_path) == 6.5
    assert silent_s(Fault("gps", "off", 60.0), tmp_path) is None


def test_a_flight_that_is_kept_is_not_flown_again(tmp_path, monkeypatch):
    flown = []

    def launch(command, **_options):
        flown.append(command)
        out = tmp_path / "00" / "run" / "bag"
        out.mkdir(parents=True)
        (out / "metadata.yaml").write_text("", encoding="utf-8")
        return SimpleNamespace(returncode=0)

    monkeypatch.setattr(faults_cli.subprocess, "run", launch)
    base = load_scenario(find_scenario("arduplane"))
    for fault in (CASES[0], CASES[0], CASES[1]):
        assert faults_cli.fly(fault, base, tmp_path / "00") == tmp_path / "00" / "run" / "bag"
    assert len(flown) == 2


def test_a_run_is_read_from_its_bag(tmp_path):
    fault = GPS_CASES[0]
    bag = BagWriter(tmp_path / "bag")
    try:
        scenario = fault_scenario(load_scenario(find_scenario("arduplane")), fault)
        OfflineFlight(scenario, bag=bag).run()
    finally:
        bag.close()
    run = read_run(fault, tmp_path / "bag")
    assert run.separation_m > 100.0
    assert len(run.lags_m) == 3
    assert 0.0 < run.after_s < 10.0
    assert run.said.startswith("planner: ")
    assert run.row().count("|") == HEADER.splitlines()[0].count("|")
    assert fault_speed(fault) > fault_speed(CASES[-1])
