"""The banner says what matters most, and is never calm about what is not well."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.console.banner import SHAPES, Urgency, banner
from sar_bridge.console.snapshot import LEADING, Snapshot, Told
from sar_estimator.common.reports import Health, MonitorReport, UavStatus
from sar_estimator.common.states import Phase


def alerted(snapshot, alert, reason=""):
    return replace(snapshot, monitor=MonitorReport(alert, reason))


def test_a_uav_in_its_place_is_normal(well):
    shown = banner(well)
    assert (shown.urgency, shown.state) == (Urgency.NORMAL, "IN FORMATION")
    assert not shown.sounds


@pytest.mark.parametrize(
    ("rule", "state"),
    [
        ("rejoin", "REJOINING"),
        ("hold", "HOLDING"),
        ("D4", "CORNER, RULE D4"),
        ("idle", "NOT ENGAGED"),
    ],
)
def test_what_is_flown_is_named(well, rule, state):
    assert banner(replace(well, rule=rule)).state == state


@pytest.mark.parametrize(
    ("alert", "urgency"),
    [
        ("caution", Urgency.CAUTION),
        ("warning", Urgency.WARNING),
        ("escape", Urgency.WARNING),
    ],
)
def test_every_alert_of_the_monitor_is_shown_with_what_to_do(well, alert, urgency):
    shown = banner(alerted(well, alert, "150 m in 12 s"))
    assert shown.urgency is urgency
    assert shown.reason == "150 m in 12 s"
    assert shown.action
    assert shown.sounds


@pytest.mark.parametrize(
    ("field", "state"), [("too_near", "TOO NEAR"), ("adsb", "HELICOPTER POSITION")]
)
def test_what_is_wrong_now_is_a_caution_and_no_alert_is_hidden_by_it(well, field, state):
    monitor = MonitorReport(**{field: "150 m"})
    shown = banner(replace(well, monitor=monitor))
    assert (shown.urgency, shown.state, shown.reason) == (Urgency.CAUTION, state, "150 m")
    assert shown.action
    warned = replace(well, monitor=replace(monitor, alert="warning"))
    assert banner(warned).urgency is Urgency.WARNING


@pytest.mark.parametrize("name", LEADING)
def test_a_silent_node_is_a_warning_while_the_uav_is_led(well, with_node, name):
    silent = with_node(well, name, age_s=6.0)
    assert banner(silent).urgency is Urgency.WARNING
    assert f"node {name} silent for 6 s" in banner(silent).reason
    assert banner(replace(silent, rule="idle")).urgency is Urgency.CAUTION


def test_lost_gps_and_lost_link_are_warnings(well, with_node):
    assert banner(replace(well, phase=Phase.LOST)).state == "HELICOPTER GPS LOST"
    assert banner(replace(well, helicopter_age_s=2.5)).state == "HELICOPTER GPS LOST"
    dead = replace(well, status=UavStatus("AUTO", armed=True, connected=False))
    dead = with_node(dead, "bridge", "autopilot's heartbeat lost", severe=True)
    shown = banner(dead)
    assert (shown.state, shown.urgency) == ("UAV LINK LOST", Urgency.WARNING)
    assert shown.reason == "autopilot's heartbeat lost"
    assert banner(replace(well, uav_age_s=3.0)).state == "UAV POSITION LOST"


def test_a_release_and_other_problems_are_cautions_word_for_word(well, with_node):
    released = with_node(
        replace(well, rule="idle"), "planner", "released: the UAV was taken to mode LOITER"
    )
    assert banner(released).state == "UAV RELEASED"
    full = with_node(well, "record", "nothing is recorded any more: No space left on device")
    assert banner(full).reason.endswith("No space left on device")
    assert banner(full).urgency is Urgency.CAUTION


def test_what_was_acknowledged_is_shown_and_not_heard_until_it_is_another(well):
    first = alerted(well, "warning", "180 m in 20 s")
    known = replace(first, quiet=banner(first).key)
    assert banner(known).acknowledged
    assert not banner(known).sounds
    nearer = replace(known, monitor=MonitorReport("warning", "150 m in 9 s"))
    assert not banner(nearer).sounds  # only its figures are others
    away = replace(known, monitor=MonitorReport("escape", "sent away: 90 m in 5 s"))
    assert banner(away).sounds


def test_before_anything_is_heard_it_waits():
    assert banner(Snapshot()).state == "WAITING"


def test_every_urgency_has_a_shape_of_its_own():
    assert len(set(SHAPES.values())) == len(Urgency)


@given(
    alert=st.sampled_from(("none", "caution", "warning", "escape")),
    rule=st.sampled_from(("", "idle", "leg", "rejoin", "hold", "T1", "D4")),
    connected=st.booleans(),
    phase=st.sampled_from((None, *Phase)),
    age_s=st.floats(0.0, 100.0),
)
def test_an_alert_is_never_hidden_by_anything_else(alert, rule, connected, phase, age_s):
    nodes = {name: Told(Health(name), 0.1) for name in LEADING}
    shown = banner(
        Snapshot(
            rule=rule,
            status=UavStatus(connected=connected),
            phase=phase,
            uav_age_s=age_s,
            monitor=MonitorReport(alert),
            nodes=nodes,
        )
    )
    least = {"caution": Urgency.CAUTION, "warning": Urgency.WARNING, "escape": Urgency.WARNING}
    assert shown.urgency >= least.get(alert, Urgency.IDLE)
    if alert == "escape":
        assert shown.state == "UAV SENT AWAY"


@pytest.mark.parametrize("node", ["planner", "monitor"])
def test_a_late_laptop_is_a_caution_with_what_to_do(well, with_node, node):
    late = "laptop is late: fixes 1.8 s old at decision"
    shown = banner(with_node(well, node, late))
    assert (shown.urgency, shown.state, shown.reason) == (Urgency.CAUTION, "LAPTOP LATE", late)
    assert "End" in shown.action
    other = banner(with_node(well, node, "something else"))
    assert other.state != "LAPTOP LATE"
