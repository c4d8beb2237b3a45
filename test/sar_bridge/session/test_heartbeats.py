"""Heartbeats: once a second, unless who leads the UAV is silent; every change is told once."""

from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.session.heartbeats import HEARTBEAT_PERIOD_S, Heartbeats


def test_the_first_at_once_then_one_a_second():
    beats = Heartbeats()
    sent = [len(beats.due(100.0 + 0.25 * step, leading=False)) for step in range(9)]
    assert sent == [1, 0, 0, 0, 1, 0, 0, 0, 1]


def test_withheld_they_come_at_once_when_they_go_on():
    beats = Heartbeats()
    beats.due(100.0, leading=True)
    beats.silent = "planner"
    assert beats.due(100.0 + 3.0 * HEARTBEAT_PERIOD_S, leading=True) == []
    assert "node planner is silent" in beats.withheld(leading=True)
    beats.silent = ""
    assert len(beats.due(103.1, leading=True)) == 1


@given(st.lists(st.tuples(st.sampled_from(["", "planner", "monitor"]), st.booleans()), max_size=30))
def test_only_a_led_uav_is_left_without_and_each_change_is_told_once(steps):
    beats, told, is_withheld = Heartbeats(), [], False
    for silent, leading in steps:
        beats.silent = silent
        assert bool(beats.withheld(leading=leading)) is bool(silent and leading)
        news = beats.news(leading=leading)
        assert (news is not None) is (bool(silent and leading) is not is_withheld)
        is_withheld = bool(silent and leading)
        told += [] if news is None else [news.level]
    assert told == ["error", "info"] * (len(told) // 2) + ["error"] * (len(told) % 2)
