"""Marks, and the circle about one: every state, every event, whatever the helicopter does."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import Mark, MonitorReport, UavStatus
from sar_estimator.common.states import LegEstimate, Motion, Phase
from sar_planner.find import MOST_MARKS, Marks
from sar_planner.mission_planner import MissionPlanner
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.strategies.active_corner import Mode

V, D = 20.0, 250.0
FLYING = UavStatus("AUTO", armed=True, connected=True, tracking_list=True)


class Bench:
    """A planner, a helicopter on its leg, and a UAV that flies its lists exactly."""

    def __init__(self, **parameters):
        self.plan = MissionPlanner(CornerParameters(), MissionParameters(**parameters))
        self.now = 0.0
        self.helicopter = Motion(0.0, 0.0, 0.0, V, 0.0)
        self.uav = Motion(0.0, 0.0, -D, V, 0.0)
        self.lists = []
        self.plan.set_status(FLYING)
        self.tell()

    def tell(self, phase=Phase.CRUISE):
        plan = self.plan
        plan.situation.set_phase(phase)
        plan.situation.set_helicopter(self.helicopter)
        plan.situation.set_uav(self.uav)
        plan.set_leg(LegEstimate(self.now, self.helicopter.pose, V, 1.0, 0.01, 0.1))

    def fly(self, seconds, *, step=0.5):
        """Fly on; both straight, the UAV along its orbit's path where it has one."""
        least = math.inf
        for _ in range(round(seconds / step)):
            self.now += step
            self.helicopter = self.helicopter.after(step)._replace(time_s=self.now)
            state = self.plan.find.orbit.state
            if state is not None and state.path is not None:
                pose = state.path.pose_at(state.flown_m + V * step)
                course = pose.heading_rad
                speeds = V * math.cos(course), V * math.sin(course)
                self.uav = Motion(self.now, pose.x_m, pose.y_m, *speeds)
            else:
                self.uav = self.uav.after(step)._replace(time_s=self.now)
            self.tell()
            found = self.plan.update(self.now)
            if found is not None:
                self.lists.append(found)
            least = min(least, self.plan.separation_m())
        return least


@pytest.fixture
def bench():
    bench = Bench()
    assert bench.plan.engage(0.0) == ""
    bench.fly(2.0)
    return bench


# Marks -------------------------------------------------------------------------------------------


def test_marks_have_numbers_and_move_where_they_are_set_again():
    marks = Marks(100.0)
    assert marks.newest is None
    assert marks.add(1.0, 0.0, 0.0) == Mark(1, 1.0, 0.0, 0.0)
    assert marks.add(2.0, 500.0, 0.0).number == 2
    assert marks.add(3.0, 60.0, 30.0) == Mark(1, 3.0, 60.0, 30.0)
    assert [mark.number for mark in marks.all] == [1, 2]
    assert marks.newest.number == 1


@given(st.lists(st.tuples(st.floats(-1e5, 1e5), st.floats(-1e5, 1e5)), max_size=120))
def test_numbers_are_places_in_the_list_and_there_are_never_too_many(places):
    marks = Marks(100.0)
    for time_s, place in enumerate(places):
        assert marks.add(float(time_s), *place) == marks.newest
    assert [mark.number for mark in marks.all] == list(range(1, len(marks.all) + 1))
    assert len(marks.all) <= MOST_MARKS


def test_without_a_place_the_helicopters_is_marked_else_the_uavs(bench):
    mark = bench.plan.find.mark(bench.now)
    assert (mark.x_m, mark.y_m) == (bench.helicopter.x_m, bench.helicopter.y_m)
    bench.plan.situation.set_uav(bench.uav._replace(time_s=bench.now + 20.0))
    later = bench.plan.find.mark(bench.now + 20.0)
    assert later.y_m == -D
    assert bench.plan.find.mark(bench.now + 60.0) is None


# Orders ------------------------------------------------------------------------------------------


def test_an_orbit_is_refused_with_its_reason(bench):
    assert bench.plan.orbit(bench.now) == "nothing is marked"
    bench.plan.find.mark(bench.now)
    assert "position 30.0 s old" in bench.plan.orbit(bench.now + 30.0)
    assert bench.plan.resume() == "no mark is orbited"
    bench.plan.disengage()
    assert bench.plan.orbit(bench.now) == "not engaged: the UAV is not led"


@pytest.mark.parametrize("radius", [150.0, 210.0])
def test_a_circle_in_which_the_helicopter_could_not_hover_is_refused(radius):
    with pytest.raises(ValueError, match=r"orbit_radius_m = .*expected at least 2"):
        Bench(orbit_radius_m=radius)


# Flown -------------------------------------------------------------------------------------------


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


EVENTS = {
    "mark": lambda plan, bench: plan.find.mark(bench.now),
    "elsewhere": lambda plan, bench: plan.find.mark(
        bench.now, (bench.uav.x_m - 700.0, bench.uav.y_m - 500.0)
    ),
    "orbit": lambda plan, bench: plan.orbit(bench.now),
    "resume": lambda plan, _: plan.resume(),
    "engage": lambda plan, bench: plan.engage(bench.now),
    "disengage": lambda plan, _: plan.disengage(),
    "escape": lambda plan, _: plan.set_monitor(MonitorReport("escape")),
    "clear": lambda plan, _: plan.set_monitor(MonitorReport()),
    "lost": lambda plan, _: plan.situation.set_phase(Phase.LOST),
}


@settings(max_examples=60)
@given(st.lists(st.sampled_from(list(EVENTS)), max_size=12))
def test_every_event_in_every_state(events):
    bench = Bench()
    bench.plan.engage(0.0)
    for event in events:
        plan = bench.plan
        EVENTS[event](plan, bench)
        plan.update(bench.now)
        bench.fly(3.0)
        assert (plan.mode is Mode.IDLE) is not plan.engaged
        if plan.mode is Mode.ORBIT:
            assert plan.find.marks.newest is not None
    for one in bench.lists:
        assert np.isfinite(one.points).all()


def test_poses_far_away_have_a_way_too():
    bench = Bench()
    bench.plan.engage(0.0)
    bench.plan.find.mark(0.0, (0.0, -9000.0))
    bench.plan.orbit(0.0)
    bench.fly(500.0)
    mark = Pose(0.0, -9000.0, 0.0)
    assert math.hypot(bench.uav.x_m - mark.x_m, bench.uav.y_m - mark.y_m) < 310.0
