"""A recorded flight: any time of it can be shown, in any order, and it plays."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.console.map_view import Search
from sar_bridge.console.playback import PlaybackDesk
from sar_estimator.common import topics
from sar_estimator.common.reports import Health, UavReport
from sar_estimator.common.states import Motion

BEGUN_S = 1000.0


def standing():
    return 0.0


def flown():
    for second in range(101):
        at_s = BEGUN_S + second
        motion = Motion(at_s, 20.0 * second, 0.0, 20.0, 0.0)
        yield at_s, topics.UAV_ODOMETRY, UavReport(motion, 0.0, 150.0)
        yield at_s, topics.LAG, float(second)
        yield at_s, topics.DIAGNOSTICS, (Health("planner"),)


def test_it_begins_at_its_beginning_and_tells_its_span():
    desk = PlaybackDesk(flown(), Search(), standing)
    assert desk.span_s() == (BEGUN_S, BEGUN_S + 100.0)
    assert desk.snapshots()[""].uav is None


@given(st.lists(st.floats(BEGUN_S, BEGUN_S + 100.0), min_size=1, max_size=20))
def test_any_time_shows_what_was_known_then_whatever_was_shown_before(times):
    desk = PlaybackDesk(flown(), Search(), standing)
    for time_s in times:
        desk.seek(time_s)
        snapshot = desk.snapshots()[""]
        assert snapshot.lag_m == int(time_s - BEGUN_S)
        assert snapshot.uav_age_s == pytest.approx(time_s - BEGUN_S - int(time_s - BEGUN_S))
        assert len(snapshot.tracks[1]) == pytest.approx(int(time_s - BEGUN_S) + 2, abs=1)


def test_it_plays_and_stands():
    now = [7.0]
    desk = PlaybackDesk(flown(), Search(), lambda: now[0], speed=10.0)
    desk.ask("play")
    now[0] = 9.0
    assert desk.snapshots()[""].now_s == BEGUN_S + 20.0
    desk.ask("pause")
    now[0] = 50.0
    assert desk.snapshots()[""].now_s == BEGUN_S + 20.0
    desk.ask("play")
    now[0] = 100.0
    assert desk.snapshots()[""].now_s == BEGUN_S + 100.0


def test_what_can_be_recorded_alone_can_not_be_done():
    desk = PlaybackDesk(flown(), Search(), standing)
    assert "engage" not in desk.actions
    desk.mark(1.0, 2.0)
    assert desk.snapshots()[""].marks == ()


def test_an_empty_flight_is_one_line():
    with pytest.raises(ValueError, match="nothing to show"):
        PlaybackDesk([], Search(), standing)


def test_every_uav_of_a_flight_is_shown():
    told = [(at_s, topic.replace("/", "/uav2/", 1), value) for at_s, topic, value in flown()]
    told += [(at_s, topic.replace("/", "/uav1/", 1), value) for at_s, topic, value in flown()]
    told.append((BEGUN_S, topics.DIAGNOSTICS, (Health("estimator"),)))
    desk = PlaybackDesk(told, Search(), standing)
    desk.seek(BEGUN_S + 30.0)
    assert list(desk.snapshots()) == ["uav1", "uav2"]
    for uav, snapshot in desk.snapshots().items():
        assert (snapshot.callsign, snapshot.lag_m) == (uav, 30.0)
        assert set(snapshot.nodes) == {"planner", "estimator"}
