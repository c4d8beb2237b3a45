"""Injected faults in whole flights: what is said and done, and that the aircraft stay apart."""

import dataclasses
import json
from itertools import pairwise

import pytest
import yaml

from sar_estimator.bags.bag import read_messages
from sar_estimator.common import topics
from sar_sim.launch.dds_cut import IN_OWN_NETWORK, own_network_possible
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Fault, load_scenario, scenario_document

pytestmark = [pytest.mark.graph, pytest.mark.timeout(180)]


def scenario(folder, *faults):
    base = load_scenario(find_scenario("short"))
    file = folder / "faults.yaml"
    document = scenario_document(dataclasses.replace(base, faults=list(faults)))
    file.write_text(yaml.safe_dump(document), encoding="utf-8")
    return str(file)


def flown(flight):
    """Return the least separation [m], the planner's modes and all problems told, by time [s]."""
    code, _, errors = flight.wait(150.0)
    assert (code, errors) == (0, "")
    metrics = json.loads((flight.out / "metrics.json").read_text(encoding="utf-8"))
    modes, told = [], []
    for topic, time_s, message in read_messages(flight.out / "bag"):
        if topic == topics.MODE:
            modes.append((time_s, message.data))
        elif topic == topics.DIAGNOSTICS:
            told += [(time_s, s.name, s.message) for s in message.status if s.level > 0]
    return metrics["min_separation_m"], modes, told


def test_clock_autopilot_and_mode_in_one_flight(launch, tmp_path):
    faults = scenario(
        tmp_path,
        Fault("clock", "wrong", 30.0, size=40.0),
        Fault("autopilot", "off", 70.0, 2.0),
        Fault("mode", "wrong", 100.0),
    )
    least_m, modes, told = flown(launch("--scenario", faults, "--speed", "10"))
    assert least_m > 100.0
    # The clock shows 40 s more from 30 s on: led again after it, and let go once for all.
    led = [time_s for time_s, mode in modes if mode != "idle"]
    assert any(70.0 < time_s < 139.0 for time_s in led)
    assert max(led) < 145.0
    released = [t for t, name, text in told if name == "bridge" and "chosen by somebody" in text]
    assert 139.0 < min(released) < 145.0


@pytest.mark.skipif(not own_network_possible(), reason="unshare -rn or tc: not allowed or not here")
def test_when_dds_is_cut_the_heartbeats_stop_and_afterwards_all_goes_on(launch, tmp_path):
    faults = scenario(tmp_path, Fault("dds", "off", 30.0, 60.0))
    flight = launch("--scenario", faults, "--speed", "10", before=IN_OWN_NETWORK)
    least_m, modes, _ = flown(flight)
    assert least_m > 100.0
    log = (flight.out / "log" / "bridge.log").read_text(encoding="utf-8")
    # Cut off, it can tell nobody; how much of that arrives afterwards is chance.
    assert log.index("no heartbeats") < log.index("heartbeats to the autopilot go on")
    assert modes[-1][1] != "idle"
    recorded = [t for _, t, _ in read_messages(flight.out / "bag", {topics.UAV_ODOMETRY})]
    gaps = [after - before for before, after in pairwise(recorded)]
    assert 40.0 < max(gaps) < 80.0
    assert (flight.out / "report.html").exists()
