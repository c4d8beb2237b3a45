"""The circle about a mark, whatever the helicopter does meanwhile."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sar_estimator.common.reports import MonitorReport
from sar_estimator.common.states import Motion, Phase
from sar_planner.strategies.active_corner import Mode

D = 250.0


@pytest.mark.parametrize(
    "place", [(0.0, 0.0), (-600.0, 0.0), (800.0, -700.0), (300.0, 900.0), (0.0, -1200.0)]
)
def test_it_flies_there_and_around_and_keeps_apart(bench, place):
    start = bench.helicopter
    bench.plan.find.mark(bench.now, (start.x_m + place[0], start.y_m + place[1]))
    assert bench.plan.orbit(bench.now) == ""
    least = bench.fly(240.0)
    assert bench.plan.mode is Mode.ORBIT
    assert least >= 200.0
    mark = bench.plan.find.marks.newest
    off = math.hypot(bench.uav.x_m - mark.x_m, bench.uav.y_m - mark.y_m)
    assert off == pytest.approx(300.0, abs=1.0)
    assert any(one.mode == "orbit" for one in bench.lists)


def test_the_circle_goes_on_by_new_lists(bench):
    bench.plan.find.mark(bench.now, (bench.helicopter.x_m - 800.0, -900.0))
    bench.plan.orbit(bench.now)
    bench.fly(600.0)
    orbits = [one for one in bench.lists if one.mode == "orbit"]
    assert 4 <= len(orbits) <= 12
    mark = bench.plan.find.marks.newest
    for one in orbits[1:]:
        radii = np.hypot(*(one.points[:10] - (mark.x_m, mark.y_m)).T)
        assert radii == pytest.approx(300.0, abs=15.0)
    assert max(len(one.points) for one in orbits) <= 60


def test_it_does_not_cross_ahead_of_the_helicopter(bench):
    # The mark is on the helicopter's other side, ahead: the UAV has to go behind it.
    bench.plan.find.mark(bench.now, (bench.helicopter.x_m + 600.0, 700.0))
    assert bench.plan.orbit(bench.now) == ""
    was = -D
    for _ in range(400):
        bench.fly(0.5)
        if was * bench.uav.y_m < 0.0:
            assert not 0.0 < bench.uav.x_m - bench.helicopter.x_m < 1000.0
        was = bench.uav.y_m or was
    assert bench.uav.y_m > 0.0


def test_resuming_leads_back_to_the_formation(bench):
    bench.plan.find.mark(bench.now)
    bench.plan.orbit(bench.now)
    bench.fly(60.0)
    assert bench.plan.resume() == ""
    bench.fly(2.0)
    assert bench.plan.mode is not Mode.ORBIT
    assert bench.lists[-1].mode != "orbit"


def test_a_mark_that_is_moved_is_followed(bench):
    bench.plan.find.mark(bench.now, (-500.0, -800.0))
    bench.plan.orbit(bench.now)
    bench.fly(120.0)
    bench.plan.find.mark(bench.now, (-450.0, -760.0))
    bench.fly(120.0)
    off = math.hypot(bench.uav.x_m + 450.0, bench.uav.y_m + 760.0)
    assert off == pytest.approx(300.0, abs=1.0)


def test_an_escape_ends_in_a_new_way_to_the_circle(bench):
    bench.plan.find.mark(bench.now, (-500.0, -800.0))
    bench.plan.orbit(bench.now)
    bench.fly(60.0)
    bench.plan.set_monitor(MonitorReport("escape", "sent away"))
    before = len(bench.lists)
    bench.fly(5.0)
    assert len(bench.lists) == before
    bench.plan.set_monitor(MonitorReport())
    bench.fly(5.0)
    assert bench.lists[-1].mode == "orbit"


def test_a_list_that_the_monitor_refuses_is_made_anew(bench):
    bench.plan.find.mark(bench.now, (-500.0, -800.0))
    bench.plan.orbit(bench.now)
    bench.fly(2.0)
    refused = bench.lists[-1].list_id
    bench.plan.set_monitor(MonitorReport(reason="list refused: near", refused_id=refused))
    before = len(bench.lists)
    bench.fly(6.0)
    assert len(bench.lists) > before


def test_without_the_helicopters_position_it_stays_on_its_circle(bench):
    bench.plan.find.mark(bench.now, (-500.0, -800.0))
    bench.plan.orbit(bench.now)
    bench.fly(60.0)
    before = len(bench.lists)
    bench.plan.situation.set_phase(Phase.LOST)
    assert bench.plan.update(bench.now + 1.0) is None
    assert bench.plan.problem == "helicopter GPS lost"
    assert len(bench.lists) == before
    assert bench.plan.mode is Mode.ORBIT


def test_a_place_far_away_has_a_way_too(make_bench):
    bench = make_bench()
    bench.plan.engage(0.0)
    bench.plan.find.mark(0.0, (0.0, -9000.0))
    bench.plan.orbit(0.0)
    bench.fly(500.0)
    assert math.hypot(bench.uav.x_m, bench.uav.y_m + 9000.0) < 310.0


# A helicopter that comes to the mark --------------------------------------------------------------


@pytest.fixture
def circled(bench):
    """Return a bench whose UAV is on its circle about the mark."""
    bench.plan.find.mark(bench.now, (-500.0, -800.0))
    bench.plan.orbit(bench.now)
    bench.fly(120.0)
    return bench


def standing(x_m, y_m):
    return lambda now_s: Motion(now_s, x_m, y_m, 0.2, 0.1)


def off_circle(bench, radius_m):
    """Fly on, and return how far the UAV is beside a circle about the mark at most [m]."""
    mark, worst = bench.plan.find.marks.newest, 0.0
    for _ in range(200):
        bench.fly(0.5, phase=Phase.STOPPED, helicopter=bench.stands)
        away = math.hypot(bench.uav.x_m - mark.x_m, bench.uav.y_m - mark.y_m)
        worst = max(worst, abs(away - radius_m))
    return worst


def test_a_helicopter_that_hovers_over_the_mark_is_circled_for_good(circled):
    """It may leave any way at any time: that is no reason to leave the circle."""
    circled.stands = standing(-490.0, -805.0)
    circled.fly(30.0, phase=Phase.STOPPED, helicopter=circled.stands)
    lists = len(circled.lists)
    assert off_circle(circled, 300.0) < 2.0
    assert len(circled.lists) <= lists + 2


def test_a_wider_circle_is_flown_about_one_that_hovers_beside_the_mark(circled):
    circled.stands = standing(-500.0, -680.0)
    circled.fly(100.0, phase=Phase.STOPPED, helicopter=circled.stands)
    assert off_circle(circled, 400.0) < 2.0
    assert "circles at 400 m: the helicopter is inside" in circled.plan.problem
    circled.stands = standing(5000.0, 5000.0)
    circled.fly(250.0, phase=Phase.STOPPED, helicopter=circled.stands)
    assert off_circle(circled, 300.0) < 2.0
    assert circled.plan.problem == ""


def test_one_that_circles_is_given_room_and_kept_apart_from(circled):
    def circling(now_s):
        angle = 0.1 * now_s
        x_m, y_m = -500.0 + 150.0 * math.cos(angle), -800.0 + 150.0 * math.sin(angle)
        return Motion(now_s, x_m, y_m, -15.0 * math.sin(angle), 15.0 * math.cos(angle))

    circled.fly(60.0, helicopter=circling)
    least = circled.fly(400.0, helicopter=circling)
    assert least > 200.0
    assert circled.plan.mode is Mode.ORBIT


def test_there_is_nothing_to_resume_to_while_the_helicopter_hovers(bench):
    bench.plan.find.mark(bench.now, (-500.0, -800.0))
    bench.plan.orbit(bench.now)
    bench.fly(60.0)
    bench.fly(15.0, phase=Phase.STOPPED, helicopter=standing(-500.0, -800.0))
    assert bench.plan.resume() == "the helicopter is stopped: there is no leg to fly beside yet"
    assert bench.plan.mode is Mode.ORBIT
    leaving = Motion(0.0, -400.0, -800.0, 20.0, 0.0)
    bench.fly(5.0, helicopter=lambda now_s: leaving._replace(time_s=now_s))
    assert "not straight on" in bench.plan.resume()  # not yet for long
    bench.fly(10.0, helicopter=lambda now_s: leaving._replace(time_s=now_s))
    assert bench.plan.resume() == ""


def test_there_is_nothing_to_resume_to_while_it_circles_or_is_slow(bench):
    bench.plan.find.mark(bench.now, (-500.0, -800.0))
    bench.plan.orbit(bench.now)
    bench.fly(60.0)

    def circling(now_s):
        course = 0.1 * now_s
        return Motion(now_s, 0.0, 0.0, 18.0 * math.cos(course), 18.0 * math.sin(course))

    bench.fly(20.0, helicopter=circling)
    assert "not straight on" in bench.plan.resume()
    slow = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
    bench.fly(20.0, helicopter=lambda now_s: slow._replace(time_s=now_s))
    leg = bench.plan.situation.leg
    bench.plan.situation.set_leg(replace(leg, speed_mps=11.0))
    assert bench.plan.resume() == "helicopter's speed 11.0 m/s: expected 15.0 to 25.0"
