import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.apart_kernels import TOLERANCE_M
from sar_planner.paths.flight_path import FlightPath, Straight
from sar_planner.prediction.forecast import cornering, cruising
from sar_planner.prediction.separation import (
    apart_for_m,
    beside_apart_m,
    closest_approach,
    closest_over_time,
    corner_forecast,
    least_apart_m,
    least_distances_m,
)
from sar_planner.rules.deadbeat_paths import slot_frame
from sar_planner.rules.deadbeat_rules import DeadbeatRules
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_planner.rules.paper_rules import Rule, build

P = CornerParameters()
AUTOMATON = PaperAutomaton(P)


def test_the_papers_rules_come_close():
    """The closest approaches with perfect tracking, each inside its rule's own domain."""
    nearest = {}
    for lag in np.arange(-300.0, 640.0, 1.0):
        plan = AUTOMATON.plan(lag)
        found = closest_approach(plan.path, P)
        best = nearest.get(plan.rule)
        if best is None or found.distance_m < best[0].distance_m:
            nearest[plan.rule] = (found, lag)
    t2, t4 = nearest["T2"], nearest["T4"]
    assert t2[0].distance_m == pytest.approx(23.6, abs=0.1)
    assert t2[0].time_s == pytest.approx(29.0, abs=1.0)
    assert t2[1] == pytest.approx(480.0, abs=10.0)
    assert t4[0].distance_m == pytest.approx(17.25, abs=0.01)
    assert t4[0].time_s == pytest.approx(15.1, abs=0.1)
    assert t4[1] == -80.0


def test_the_outside_loop_just_outside_its_domain_is_closer_still():
    """15.8 m belongs to the loop flown from L = -78, 2 m beyond the domain's end."""
    found = closest_approach(build(Rule.T4, -78.0, P).path, P)
    assert found.distance_m == pytest.approx(15.8, abs=0.05)


def test_helicopter_motion():
    t = np.array([0.0, 4.0, 8.0, 12.0, 16.0, 20.0])
    expected = [(-80, 0), (-20, 0), (0, 0), (0, -20), (0, -80), (0, -160)]
    assert corner_forecast(P).positions(t) == pytest.approx(np.array(expected, dtype=float))


@settings(max_examples=60)
@given(st.floats(-500.0, 1400.0))
def test_closest_approach_is_what_a_fine_search_finds(lag):
    path = AUTOMATON.plan(lag).path
    found = closest_approach(path, P)
    times = np.linspace(0.0, max(path.length_m / P.speed_mps, 16.0), 20001)
    gap = path.points(times * P.speed_mps) - corner_forecast(P).positions(times)
    assert found.distance_m == pytest.approx(np.hypot(*gap.T).min(), abs=0.02)


@settings(max_examples=60)
@given(st.floats(-500.0, 1400.0), st.floats(0.0, 8.0))
def test_the_least_distance_is_bounded_from_below_by_no_more_than_a_tolerance(lag, hover_s):
    path = AUTOMATON.plan(lag).path
    corner = corner_forecast(P)
    longer = cornering(
        0.0, Pose(0.0, 0.0, 0.0), speed_mps=P.speed_mps, accel_mps2=P.accel_mps2, hover_s=hover_s
    )
    least = min(
        closest_over_time(path, one, start_s=1.0, speed_mps=18.0).distance_m
        for one in (corner, longer)
    )
    found = least_apart_m(path, (corner, longer), start_s=1.0, speed_mps=18.0)
    assert least - TOLERANCE_M - 0.01 <= found <= least
    soon = apart_for_m(path, longer, 5.0, start_s=1.0, speed_mps=18.0)
    assert soon >= found - TOLERANCE_M


@settings(max_examples=60)
@given(
    st.floats(-800.0, 1400.0),
    st.floats(0.0, 200.0),
    st.floats(0.6, 1.1),
    st.sampled_from(["curves", "weaves"]),
)
def test_every_paths_least_distance_is_what_a_fine_look_finds(lag, lead, path_efficiency, kind):
    rules = DeadbeatRules(P, path_efficiency=path_efficiency)
    problem = rules.paths.problem(lag)
    batch = (
        rules.paths.curves(problem, lead).batch
        if kind == "curves"
        else rules.paths.weaves(problem, lead, np.radians(np.array([[120.0, 40.0, 56.0]])))
    )
    batch = batch.take(range(0, len(batch), max(1, len(batch) // 5)))
    forecast = corner_forecast(P).in_frame(slot_frame(P))
    speed = P.speed_mps * path_efficiency
    found = least_distances_m(batch, forecast, start_s=0.0, speeds_mps=speed, lead_mps=P.speed_mps)
    for i, distance in enumerate(found):
        path, first = batch.path(i), float(batch.rows[i, 0])
        begun = first / P.speed_mps
        end = max(begun + (path.length_m - first) / speed, forecast.steady_s)
        times = np.linspace(0.0, end, 4001)
        flown = np.where(times < begun, P.speed_mps * times, first + speed * (times - begun))
        over = np.maximum(flown - path.length_m, 0.0)
        flown += over * (P.speed_mps / speed - 1.0)
        gap = path.points(flown) - forecast.positions(times)
        least = float(np.hypot(*gap.T).min())
        assert least - TOLERANCE_M - 0.02 <= distance <= least
        for kept_m in (least - 1.0, least + 1.0):
            kept = least_distances_m(
                batch.take([i]),
                forecast,
                start_s=0.0,
                speeds_mps=speed,
                lead_mps=P.speed_mps,
                kept_m=kept_m,
            )
            assert (kept[0] >= kept_m) == (kept_m < least)
            assert kept[0] <= least or kept[0] < kept_m


def test_a_uav_beside_its_path_is_looked_at_where_it_is():
    path = FlightPath.of(Pose(0.0, 0.0, 0.0), (Straight(2000.0),))
    forecast = cruising(0.0, Pose(0.0, 250.0, 0.0), 20.0)
    for beside, least in (((0.0, 0.0), 250.0), ((0.0, 40.0), 210.0), ((30.0, -40.0), 291.5)):
        found = beside_apart_m(path, beside, (forecast,), start_s=0.0, speed_mps=20.0)
        assert found == pytest.approx(least, abs=0.1)
