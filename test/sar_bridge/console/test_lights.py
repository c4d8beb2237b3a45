"""Lights are grey for what is not known, red for what is lost."""

from dataclasses import replace

import pytest

from sar_bridge.console.banner import Urgency
from sar_bridge.console.lights import lights
from sar_bridge.console.snapshot import Snapshot
from sar_estimator.common.reports import UavStatus


def by_name(snapshot, free_gb=50.0):
    return {light.name: light for light in lights(snapshot, free_gb)}


def test_all_is_green_when_all_is_well(well):
    found = by_name(well)
    assert {light.urgency for light in found.values()} == {Urgency.NORMAL}
    assert found["GPS"].text == "0.2 s old, ±1.2 m"
    assert found["LINK"].text == "heartbeat 0.3 s, upload 40 ms"
    assert "record" in found


def test_all_is_grey_when_nothing_is_known():
    found = by_name(Snapshot())
    assert {light.urgency for name, light in found.items() if name != "disk"} == {Urgency.IDLE}


def test_what_is_lost_is_red_and_what_is_wrong_is_told(well, with_node):
    assert by_name(replace(well, helicopter_age_s=3.0))["GPS"].urgency is Urgency.WARNING
    dead = replace(well, status=UavStatus("AUTO", connected=False))
    assert by_name(dead)["LINK"].urgency is Urgency.WARNING
    silent = by_name(with_node(well, "planner", age_s=7.0))["planner"]
    assert (silent.urgency, silent.text) == (Urgency.WARNING, "silent for 7 s")
    wrong = by_name(with_node(well, "estimator", "no usable GPS fix", severe=True))["estimator"]
    assert (wrong.urgency, wrong.text) == (Urgency.WARNING, "no usable GPS fix")
    assert by_name(well, free_gb=1.0)["disk"].urgency is Urgency.CAUTION


def test_refused_fixes_and_the_radio_are_told(well, with_node):
    assert by_name(with_node(well, "estimator", refused="3"))["GPS"].text.endswith("3 refused")
    radio = with_node(well, "bridge", radio_rssi="180", radio_noise="40")
    assert by_name(radio)["LINK"].text.endswith("RSSI 180, noise 40")


@pytest.mark.parametrize("node", ["planner", "monitor"])
def test_a_late_node_is_yellow_and_says_how_late(well, with_node, node):
    late = "laptop is late: fixes 1.8 s old at decision"
    light = by_name(with_node(well, node, late))[node]
    assert (light.urgency, light.text) == (Urgency.CAUTION, late)
