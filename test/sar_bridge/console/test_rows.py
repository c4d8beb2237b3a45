"""A row for each UAV: always the same cells, grey when they are old."""

from dataclasses import replace

import pytest

from sar_bridge.console.banner import Urgency, banner
from sar_bridge.console.rows import row
from sar_bridge.console.snapshot import Snapshot
from sar_estimator.common.reports import MonitorReport, Uploaded


def cells(snapshot):
    return {one.name: one for one in row(snapshot, banner(snapshot)).cells}


def test_what_matters_of_a_uav_is_told(well, with_node):
    snapshot = replace(with_node(well, "planner", slot="left 2"), callsign="uav2")
    texts = {name: cell.text for name, cell in cells(snapshot).items()}
    assert texts == {
        "slot": "left 2",
        "rule": "leg",
        "lag L": "10 m",
        "apart": "250 m",
        "alert": "● IN FORMATION",
        "UAV mode": "AUTO",
        "link": "heartbeat 0.3 s, upload 40 ms",
        "list": "2 points, flown",
    }
    assert row(snapshot, banner(snapshot)).name == "uav2"
    assert row(well, banner(well)).name == "UAV"


def test_an_alert_has_its_urgency_and_whether_it_is_known(well):
    alerted = replace(well, monitor=MonitorReport("warning", "150 m in 9 s"))
    assert row(alerted, banner(alerted)).urgency is Urgency.WARNING
    known = replace(alerted, quiet=banner(alerted).key)
    assert cells(known)["alert"].text == "▲ SEPARATION (acknowledged)"


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"waypoints": None}, "–"),
        ({"uploaded": None}, "2 points, sent"),
        ({"uploaded": Uploaded(6)}, "2 points, sent"),
    ],
)
def test_how_far_the_list_has_come_is_told(well, change, text):
    assert cells(replace(well, **change))["list"].text == text


def test_what_is_old_is_grey_and_names_never_change(well, with_node):
    stale = {
        name for name, cell in cells(with_node(well, "bridge", age_s=4.0)).items() if cell.is_stale
    }
    assert stale == {"UAV mode", "link", "list"}
    assert list(cells(Snapshot())) == list(cells(well))
