"""The checklist ticks what the graph tells, and nothing that it does not."""

from dataclasses import replace

import pytest

from sar_bridge.console.checklist import checklist
from sar_bridge.console.snapshot import Snapshot
from sar_estimator.common.reports import MonitorReport, UavStatus
from sar_estimator.common.states import Phase


def open_items(snapshot, free_gb=50.0):
    return [item.text for item in checklist(snapshot, free_gb) if not item.done]


def test_nothing_is_ticked_before_anything_is_heard():
    assert len(open_items(Snapshot())) == len(checklist(Snapshot(), 50.0))


def test_a_graph_that_is_ready_has_every_tick(well):
    assert open_items(replace(well, rule="idle")) == []


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"helicopter": None}, "Helicopter's GPS"),
        ({"helicopter_age_s": 9.0}, "Helicopter's GPS"),
        ({"phase": Phase.STOPPED}, "Helicopter on a leg"),
        ({"status": UavStatus("AUTO", armed=True, connected=False)}, "UAV heard"),
        (
            {"status": UavStatus("AUTO", armed=False, connected=True)},
            "UAV in the air, in AUTO or GUIDED",
        ),
        (
            {"status": UavStatus("RTL", armed=True, connected=True)},
            "UAV in the air, in AUTO or GUIDED",
        ),
        ({"parameters": {}}, "Autopilot's parameters"),
        ({"parameters": {"FS_GCS_ENABL": 0.0}}, "UAV's failsafe on"),
        ({"monitor": MonitorReport(watch_only=True)}, "Separation monitor on"),
        ({"uav": None}, "Aircraft well apart"),
    ],
)
def test_what_is_missing_takes_its_tick_away(well, change, text):
    assert text in open_items(replace(well, **change))


def test_nodes_recorder_and_disk(well, with_node):
    assert open_items(with_node(well, "monitor", age_s=9.0)) == [
        "All nodes answer",
        "Separation monitor on",
    ]
    assert open_items(with_node(well, "record", "nothing is recorded any more")) == [
        "Recorder runs"
    ]
    assert open_items(well, free_gb=0.5) == ["Recorder runs"]
    warned = with_node(well, "planner", autopilot="NAVL1_PERIOD 20: expected 10 to 15")
    assert open_items(warned) == ["Autopilot's parameters"]
