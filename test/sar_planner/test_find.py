"""Marks, and who is led about them: every state, every event."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sar_estimator.common.reports import Mark, MonitorReport
from sar_estimator.common.states import Phase
from sar_planner.find import MOST_MARKS, Marks
from sar_planner.strategies.active_corner import Mode

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
    assert later.y_m == -250.0
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
def test_a_circle_in_which_the_helicopter_could_not_hover_is_refused(make_bench, radius):
    with pytest.raises(ValueError, match=r"orbit_radius_m = .*expected at least 2"):
        make_bench(orbit_radius_m=radius)


def test_a_refused_list_of_an_orbit_is_none_of_the_way_back(make_bench):
    bench = make_bench()
    bench.uav = bench.uav._replace(y_m=-700.0)
    bench.plan.engage(0.0)
    bench.fly(2.0)
    way_back = bench.plan._strategy.state
    assert way_back.mode is Mode.REJOIN
    bench.plan.find.mark(bench.now)
    assert bench.plan.orbit(bench.now) == ""
    bench.fly(2.0)
    assert bench.plan.mode is Mode.ORBIT
    refused = MonitorReport(reason="list refused: near", refused_id=bench.lists[-1].list_id)
    bench.plan.set_monitor(refused)
    bench.plan.update(bench.now + 0.5)
    assert "list refused: near" in bench.plan.problem
    assert bench.plan._strategy.state.refusals == 0


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


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(events=st.lists(st.sampled_from(list(EVENTS)), max_size=12))
def test_every_event_in_every_state(make_bench, events):
    bench = make_bench()
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
