"""A helicopter that leaves its pattern for a find, and takes it up again."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Find, load_scenario
from sar_sim.world.detour import detoured, place
from sar_sim.world.human_helicopter import flown_by

BASE = load_scenario(find_scenario("human"))
PATTERN = flown_by(BASE.pilot, BASE.pattern, 20.0, 2.0)


def flown(*finds):
    return detoured(PATTERN, list(finds), BASE.pilot, speed_mps=20.0, accel_mps2=2.0)


STEP_S = 0.2


def sampled(helicopter, begin_s=0.0, end_s=math.inf):
    times = np.arange(begin_s, min(end_s, helicopter.end_s), STEP_S)
    motions = [helicopter.motion(at) for at in times.tolist()]
    places = np.array([(motion.x_m, motion.y_m) for motion in motions])
    velocities = np.array([(motion.vx_mps, motion.vy_mps) for motion in motions])
    return times, places, velocities


@settings(max_examples=25, deadline=None)
@given(
    st.floats(20.0, 900.0),
    st.floats(-1500.0, 1500.0),
    st.floats(-1500.0, 1500.0),
    st.sampled_from(("hovers", "circles", "stays")),
)
def test_it_moves_as_a_helicopter_can_wherever_and_whenever_it_is_called(at_s, ahead, left, what):
    helicopter = flown(Find(at_s, 200.0, ahead, left, what, 40.0))
    gone_s = helicopter.end_s - PATTERN.end_s if what != "stays" else 400.0
    _, places, velocities = sampled(helicopter, at_s - 5.0, at_s + gone_s + 5.0)
    means = 0.5 * (velocities[1:] + velocities[:-1])
    assert np.abs(np.diff(places, axis=0) / STEP_S - means).max() < 0.5
    assert np.hypot(*velocities.T).max() < 24.0
    assert np.hypot(*(np.diff(velocities, axis=0) / STEP_S).T).max() < 7.0


@pytest.mark.parametrize("what", ["hovers", "circles"])
def test_it_is_at_the_mark_and_then_on_its_pattern_again_as_much_later(what):
    find = Find(200.0, 300.0, -300.0, 500.0, what, 60.0)
    helicopter = flown(find)
    mark = place(find, PATTERN.motion(200.0), PATTERN.heading_rad(200.0))
    times, places, _ = sampled(helicopter)
    away = np.hypot(*(places - (mark.x_m, mark.y_m)).T)
    stays = away < (20.0 if what == "hovers" else 200.0)
    assert STEP_S * np.count_nonzero(stays & (times > 200.0)) > 55.0
    late_s = helicopter.end_s - PATTERN.end_s
    assert late_s > 60.0
    for at_s in (0.0, 100.0, 199.0):
        assert helicopter.motion(at_s) == PATTERN.motion(at_s)
    for at_s in (205.0, 400.0, 1000.0):
        late = helicopter.motion(at_s + late_s)
        there = PATTERN.motion(at_s)
        assert (late.x_m, late.y_m) == pytest.approx((there.x_m, there.y_m))
        assert helicopter.heading_rad(at_s + late_s) == PATTERN.heading_rad(at_s)


def test_corners_that_come_after_it_are_as_much_later():
    helicopter = flown(Find(300.0, 300.0, 100.0, 100.0, "hovers", 60.0))
    late_s = helicopter.end_s - PATTERN.end_s
    assert len(helicopter.corners) == len(PATTERN.corners)
    for corner, was in zip(helicopter.corners, PATTERN.corners, strict=True):
        moved_s = late_s if was.onset_time_s > 300.0 else 0.0
        assert corner.onset_time_s == pytest.approx(was.onset_time_s + moved_s)


def test_one_that_stays_ends_its_flight_there():
    find = Find(300.0, 120.0, 0.0, 400.0, "stays")
    helicopter = flown(find)
    mark = place(find, PATTERN.motion(300.0), PATTERN.heading_rad(300.0))
    last = helicopter.motion(helicopter.end_s)
    assert math.hypot(last.x_m - mark.x_m, last.y_m - mark.y_m) < 20.0
    assert helicopter.end_s > 300.0 + 120.0
    assert all(corner.onset_time_s <= 300.0 for corner in helicopter.corners)


def test_it_goes_on_where_it_is_not_called_and_two_finds_add_up():
    assert flown(replace(Find(300.0), helicopter="goes_on")) is PATTERN
    one = flown(Find(200.0, 100.0, 0.0, 300.0, "hovers", 30.0))
    two = flown(
        Find(200.0, 100.0, 0.0, 300.0, "hovers", 30.0),
        Find(one.end_s - 200.0, 100.0, 0.0, 300.0, "hovers", 30.0),
    )
    assert two.end_s > one.end_s + 30.0
