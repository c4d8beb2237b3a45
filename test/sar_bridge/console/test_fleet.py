"""Several UAVs: each console hears its own namespace, and what all share."""

import pytest

from sar_bridge.console.banner import banner, worst
from sar_bridge.console.component import ConsoleComponent
from sar_bridge.console.fleet import Fleet, uavs_in
from sar_estimator.common import topics
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import Health, MonitorReport
from sar_estimator.common.states import Phase


def handle(fleet, uav, topic, value, now_s=0.0):
    fleet.handle(topics.of_uav(topic, uav), value, now_s)


def warned(*uavs):
    """Return two UAVs' consoles, with a warning for some of them."""
    fleet = Fleet(("uav1", "uav2"))
    for uav in ("uav1", "uav2"):
        handle(fleet, uav, topics.DIAGNOSTICS, (Health("monitor"),))
        alert = "warning" if uav in uavs else "none"
        handle(fleet, uav, topics.MONITOR, MonitorReport(alert, "180 m in 9 s"))
    return fleet


def sounding(fleet):
    return {uav for uav, one in fleet.snapshots(0.1).items() if banner(one).sounds}


def test_one_without_a_name_hears_what_a_console_alone_does():
    assert set(Fleet().inputs) == set(ConsoleComponent().inputs)


def test_what_is_told_in_a_namespace_is_of_that_uav_and_what_is_shared_of_all():
    fleet = Fleet(("", "uav2"))
    fleet.handle(topics.DATUM, Datum(37.8, -122.8), 0.0)
    fleet.handle(topics.PHASE, Phase.CRUISE, 0.0)
    fleet.handle("/planner/mode", "leg", 0.0)
    fleet.handle("/uav2/planner/mode", "hold", 0.0)
    fleet.handle("/uav3/planner/mode", "rejoin", 0.0)
    found = fleet.snapshots(1.0)
    assert {uav: one.rule for uav, one in found.items()} == {"": "leg", "uav2": "hold"}
    assert {one.phase for one in found.values()} == {Phase.CRUISE}
    assert None not in {one.datum for one in found.values()}


def test_nodes_that_all_share_are_told_of_to_all_and_no_others():
    fleet = Fleet(("", "uav2"))
    for name in ("estimator", "planner", "record"):
        fleet.handle(topics.DIAGNOSTICS, (Health(name),), 0.0)
    fleet.handle("/uav2/diagnostics", (Health("bridge"),), 0.0)
    nodes = {uav: set(one.nodes) for uav, one in fleet.snapshots(0.0).items()}
    assert nodes == {
        "": {"estimator", "planner", "record"},
        "uav2": {"estimator", "bridge", "record"},
    }


def test_the_worst_is_shown_with_its_name_and_acknowledged_alone():
    fleet = warned("uav2")
    shown = worst(map(banner, fleet.snapshots(0.1).values()))
    assert shown.title == "uav2: SEPARATION"
    fleet.acknowledge(0.1)
    assert sounding(fleet) == set()
    fleet = warned("uav1", "uav2")
    fleet.acknowledge(0.1)
    assert len(sounding(fleet)) == 1
    fleet.acknowledge(0.1)  # what is not acknowledged yet is shown before what is
    assert sounding(fleet) == set()


def test_what_all_share_is_acknowledged_once_for_all():
    fleet = Fleet(("uav1", "uav2"))
    fleet.handle(topics.DIAGNOSTICS, (Health("estimator", "no usable GPS fix"),), 0.0)
    fleet.handle(topics.PHASE, Phase.LOST, 0.0)
    shown = worst(map(banner, fleet.snapshots(0.1).values()))
    assert shown.title == "HELICOPTER GPS LOST"
    assert sounding(fleet) == {"uav1", "uav2"}
    fleet.acknowledge(0.1)
    assert sounding(fleet) == set()


def test_answers_are_shown_whichever_uav_is_chosen():
    fleet = Fleet(("uav1", "uav2"))
    fleet.answered("uav1 engage: engaged")
    assert {one.answers for one in fleet.snapshots(0.0).values()} == {("uav1 engage: engaged",)}
    fleet.set_clock_back()
    assert {one.answers for one in fleet.snapshots(0.0).values()} == {()}


@pytest.mark.parametrize(
    ("names", "uavs"),
    [
        ([], ("",)),
        (
            [
                "/helicopter/odometry",
                "/diagnostics",
                "/sim/uav",
                "/uav1/sim/uav",
                "/rosout",
                "/clock",
            ],
            ("",),
        ),
        (["/uav/odometry", "/uav/clock", "/planner/mode"], ("",)),
        (["/uav2/uav/odometry", "/uav1/monitor/state", "/diagnostics"], ("uav1", "uav2")),
        (["/uav/odometry", "/uav2/uav/odometry", "/uav2/diagnostics"], ("", "uav2")),
    ],
)
def test_a_recordings_uavs_are_known_by_its_topics(names, uavs):
    assert uavs_in(names) == uavs
