"""The console's component: what is told is kept, with its age."""

import math

import numpy as np
import pytest

from sar_bridge.console.banner import banner
from sar_bridge.console.component import TRACK_M, ConsoleComponent
from sar_estimator.common import topics
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import (
    Health,
    HelicopterReport,
    MonitorReport,
    UavReport,
    UavStatus,
)
from sar_estimator.common.states import Motion, Phase


def flown(seconds, *, console=None):
    console = console or ConsoleComponent()
    console.handle(topics.DATUM, Datum(37.8, -122.8, 5.0), 0.0)
    for step in range(int(5 * seconds)):
        now = 0.2 * step
        there = Motion(now, 20.0 * now, 0.0, 20.0, 0.0)
        console.handle(topics.HELICOPTER_ODOMETRY, HelicopterReport(there, 1.0, 0.1), now)
        beside = there._replace(y_m=-250.0 - now)
        console.handle(topics.UAV_ODOMETRY, UavReport(beside, 0.0, 150.0), now)
    return console


def test_tracks_are_kept_a_point_every_so_often():
    snapshot = flown(100.0).snapshot(100.0)
    for track in snapshot.tracks:
        steps = np.hypot(*np.diff(track, axis=0).T)
        assert steps[:-1] == pytest.approx(TRACK_M, abs=4.1)
        assert track[-1, 0] == pytest.approx(1996.0)


def test_ages_count_from_when_it_was_heard():
    snapshot = flown(10.0).snapshot(13.0)
    assert snapshot.helicopter_age_s == pytest.approx(3.2)
    assert ConsoleComponent().snapshot(5.0).uav_age_s == math.inf


def test_the_trend_is_of_the_last_minute():
    trend = flown(100.0).snapshot(99.8).trend
    assert trend[0, 0] <= 60.0
    assert trend[-1] == pytest.approx((0.0, 349.8))
    assert len(trend) == pytest.approx(301, abs=1)


def test_how_much_higher_the_uav_is_is_known_where_both_altitudes_are():
    console = flown(1.0)
    assert math.isnan(console.snapshot(1.0).vertical_m)
    here = HelicopterReport(Motion(1.0, 0.0, 0.0, 20.0, 0.0), 1.0, 0.1, 30.0)
    console.handle(topics.HELICOPTER_ODOMETRY, here, 1.0)
    assert console.snapshot(1.0).vertical_m == pytest.approx(120.0)


def test_everything_else_is_kept_as_it_is_told():
    console = ConsoleComponent()
    status = UavStatus("AUTO", armed=True, connected=True)
    for topic, value in (
        (topics.PHASE, Phase.CRUISE),
        (topics.UAV_STATE, status),
        (topics.MODE, "leg"),
        (topics.LAG, 12.0),
        (topics.DIAGNOSTICS, (Health("planner", "", {"rule": "leg"}),)),
    ):
        console.handle(topic, value, 3.0)
    snapshot = console.snapshot(4.0)
    assert (snapshot.phase, snapshot.status, snapshot.rule) == (Phase.CRUISE, status, "leg")
    assert snapshot.engaged
    assert snapshot.nodes["planner"].age_s == pytest.approx(1.0)
    assert snapshot.nodes["planner"].value("rule") == "leg"


def test_what_is_acknowledged_is_quiet():
    console = ConsoleComponent()
    console.handle(topics.DIAGNOSTICS, (Health("monitor"),), 0.0)
    console.handle(topics.MONITOR, MonitorReport("warning", "180 m in 9 s"), 0.0)
    assert banner(console.snapshot(0.1)).sounds
    console.acknowledge(0.1)
    assert not banner(console.snapshot(0.2)).sounds


def test_answers_are_kept_word_for_word_the_newest_last():
    console = ConsoleComponent()
    for n in range(8):
        console.answered(f"engage: no UAV position {n}")
    assert console.snapshot(0.0).answers[-1] == "engage: no UAV position 7"
    assert len(console.snapshot(0.0).answers) == 5


def test_another_flight_begins_with_nothing():
    console = flown(10.0)
    console.set_clock_back()
    snapshot = console.snapshot(20.0)
    assert snapshot.helicopter is None
    assert len(snapshot.tracks[0]) == 0
