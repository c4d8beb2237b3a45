"""Rejoining from any pose: the slot is met in time, apart from the helicopter."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.paths.slot_intercept import InterceptProblem, PathBatch, turn_to
from sar_planner.prediction.forecast import cornering, cruising, departing
from sar_planner.prediction.separation import closest_over_time
from sar_planner.rejoin import rejoin as rejoining
from sar_planner.rejoin.rejoin import RejoinTask, _Found, _Search, onto_track, rejoin
from sar_sim.trials.rejoin_bound.bound import unhindered_s

LEG = Pose(0.0, 250.0, 0.0)
FORECASTS = {
    "cruise": cruising(0.0, LEG, 20.0),
    "slow": departing(0.0, LEG, 5.0, speed_mps=20.0, accel_mps2=2.5),
    "corner": cornering(-3.0, Pose(0.0, 250.0, math.pi / 2), speed_mps=20.0, accel_mps2=2.5),
}


def task(start, name="cruise", separation=200.0):
    return RejoinTask(start, 0.0, (FORECASTS[name],), 100.0, 18.0, 22.0, separation)


@settings(max_examples=20, deadline=None)
@given(
    st.floats(300.0, 1500.0), st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi),
    st.sampled_from(sorted(FORECASTS)),
)  # fmt: skip
def test_any_start_meets_the_slot(distance, bearing, heading, name):
    forecast = FORECASTS[name]
    here = forecast.positions([0.0])[0]
    x, y = here + distance * np.array((math.cos(bearing), math.sin(bearing)))
    asked = task(Pose(float(x), float(y), heading), name)
    plan = rejoin(asked)
    assert plan is not None
    assert 18.0 - 1e-6 <= plan.speed_mps <= 22.0 + 1e-6
    slot = forecast.leg.x_m + forecast.along_m(plan.duration_s)
    assert (plan.path.end.x_m, plan.path.end.y_m) == pytest.approx((slot, 0.0), abs=0.01)
    assert math.cos(plan.path.end.heading_rad) == pytest.approx(1.0)
    assert plan.duration_s >= unhindered_s(asked)
    nearest = closest_over_time(plan.path, forecast, start_s=0.0, speed_mps=plan.speed_mps)
    if plan.kept:
        assert nearest.distance_m >= 200.0 - 1e-6
    assert plan.closest_m <= nearest.distance_m + 1e-6


def test_already_there():
    plan = rejoin(task(Pose(-2.0, 0.0, 0.0)))
    assert plan.duration_s < 5.0
    assert plan.path.length_m == pytest.approx(plan.duration_s * plan.speed_mps)


def test_behind_on_the_track_flies_straight_and_fast():
    plan = rejoin(task(Pose(-200.0, 0.0, 0.0)))
    assert plan.speed_mps == pytest.approx(22.0, abs=0.05)
    assert plan.duration_s == pytest.approx(100.0, abs=1.0)


def test_ahead_on_the_track_weaves_away_from_the_helicopter():
    plan = rejoin(task(Pose(150.0, 0.0, 0.0)))
    points = plan.path.sample(5.0)
    assert points[:, 1].min() < -20.0
    assert plan.duration_s < 60.0


def test_no_room_is_said():
    plan = rejoin(task(Pose(-150.0, 250.0, 0.0)))
    assert not plan.kept
    assert plan.closest_m < 200.0


@pytest.mark.parametrize("x", [-150.0, -60.0, 40.0, 120.0])
def test_where_nothing_keeps_the_separation_no_word_keeps_more(x):
    """Words and intercepts are both looked at for the way that stays the farthest away."""
    near = task(Pose(x, 250.0, 0.0))
    plan = rejoin(near)
    assert not plan.kept
    search = rejoining._Search(near)
    words = rejoining._Found(*rejoining.timed_words(near))
    best = rejoining._farthest(search, words)
    assert best is None or plan.closest_m >= best.closest_m - 1.0


def test_a_word_that_fits_for_a_moment_only_is_found():
    plan = rejoin(task(Pose(241.66, -161.27, math.radians(132.162))))
    assert plan.duration_s < 20.0
    assert plan.kept


def test_last_turn_and_speed_are_polished():
    # Around the helicopter, down across the slot track and back up: 61.6 s is the bound.
    plan = rejoin(task(Pose(184.42, 523.33, math.radians(-32.397)), separation=205.0))
    assert plan.kept
    assert plan.duration_s < 68.0


@pytest.mark.parametrize("start", [Pose(600.0, -300.0, 2.0), Pose(-500.0, 700.0, -1.0)])
@pytest.mark.parametrize("name", sorted(FORECASTS))
def test_the_soonest_capture_is_that_of_all_of_its_kind(start, name):
    search = _Search(task(start, name))
    grid = np.radians(np.arange(-180.0, 180.0, 15.0))
    h1, h2 = (g.ravel() for g in np.meshgrid(grid, grid, indexing="ij"))
    compared = 0
    for speed, last, sides in list(search.families())[::7]:
        problem = InterceptProblem(start, 100.0, 20.0 / speed, last)
        turn_1 = turn_to(np.full_like(h1, start.heading_rad), h1, sides[0])
        batch = problem.solve(
            problem.arcs(turn_1, turn_to(h1, h2, sides[1]), sides[2]), search.task.ahead_m
        )
        needed_m = search.task.separation_m
        found = _Found(batch.rows, np.full(len(batch), speed))
        distances = search.distances_m(found, kept_m=needed_m)
        kept = batch.lengths_m[distances >= needed_m] / speed
        found = search.soonest(speed, last, sides, (grid, grid), math.inf)
        if kept.size == 0:
            assert found is None
            continue
        compared += 1
        assert found.time_s == pytest.approx(kept.min(), abs=1e-6)
        assert search.soonest(speed, last, sides, (grid, grid), found.time_s) is None
        row = PathBatch(start, 100.0, found.row[None, :])
        assert problem.detours_m(row)[0] == pytest.approx(search.task.ahead_m, abs=1e-6)
        assert row.ends[0, 1] == pytest.approx(0.0, abs=1e-6)
    assert compared > 5


def test_a_way_that_hugs_the_moving_disc_is_looked_for():
    # Beside a helicopter that still slows for its corner: 343 s without the grids.
    stop = Pose(0.0, 250.0, math.pi / 2)
    corner = cornering(-0.2166, stop, speed_mps=20.0, accel_mps2=2.5)
    start = Pose(-285.8, 341.31, 0.0375)
    plan = rejoin(RejoinTask(start, 0.0, (corner,), 100.0, 18.0, 22.0, 205.0))
    assert plan.kept
    assert plan.duration_s < 160.0


@pytest.mark.parametrize("name", sorted(FORECASTS))
@pytest.mark.parametrize("start", [Pose(-900.0, -400.0, 2.0), Pose(-1500.0, 300.0, -1.0)])
def test_one_that_is_too_slow_is_led_onto_the_track_behind_the_slot(start, name):
    slow = replace(task(start, name), slowest_mps=15.0, fastest_mps=17.0)
    assert rejoin(slow) is None
    plan = onto_track(slow)
    assert plan.kept
    assert plan.speed_mps == 17.0
    end = plan.path.end
    assert (end.y_m, math.cos(end.heading_rad)) == pytest.approx((0.0, 1.0), abs=1e-6)
    forecast = FORECASTS[name]
    lag_m = forecast.leg.x_m + forecast.along_m(plan.duration_s) - end.x_m
    least_m = math.hypot(start.x_m, start.y_m) - 17.0 * 20.0
    assert 0.0 < lag_m < least_m + 1500.0
    nearest = closest_over_time(plan.path, forecast, start_s=0.0, speed_mps=17.0)
    assert nearest.distance_m >= 200.0 - 1e-6


def test_onto_the_track_where_the_helicopter_is_near_keeps_what_it_can():
    slow = replace(task(Pose(-150.0, 250.0, 0.0)), slowest_mps=15.0, fastest_mps=17.0)
    plan = onto_track(slow)
    assert not plan.kept
    assert plan.closest_m < 200.0
