"""Flying faster in a corner: which speeds, and what they do."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest

from sar_planner.guidance.turn_radius import Turns
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.separation import closest_approach
from sar_planner.rules.corner_speed import (
    CornerSpeed,
    catching_up_mps,
    corner_speeds,
    lag_to_begin_with_m,
    sped_up_plan,
)
from sar_planner.rules.deadbeat_rules import CONVERGED_M, DeadbeatRules
from sar_planner.rules.paper_rules import Rule

CORNER = CornerParameters()
SEEN, WIDE = Turns(100.0), Turns(160.0, is_wide=True)


def test_no_faster_than_the_envelope_allows_on_any_course() -> None:
    for air, expected in (
        (AirEnvelope(), (1.1, 1.0)),
        (AirEnvelope(10.0, 25.0, (4.0, 0.0)), (1.05, 1.0)),
        (AirEnvelope(10.0, 30.0, (0.0, 10.0)), (1.0,)),
    ):
        found = corner_speeds(air, 20.0, 0.1, SEEN)
        assert [one.speed_up for one in found] == pytest.approx(expected)
        assert {(one.turn_radius_m, one.is_seen) for one in found} == {(100.0, False)}


def test_one_that_turns_wide_is_flown_slower_as_far_as_it_can_be() -> None:
    found = corner_speeds(AirEnvelope(), 20.0, 0.1, WIDE)
    assert [one.speed_up for one in found] == pytest.approx((0.8, 0.9, 1.0, 1.1))
    assert [one.turn_radius_m for one in found] == pytest.approx((102.4, 129.6, 160.0, 193.6))
    assert all(one.is_seen for one in found)
    found = corner_speeds(AirEnvelope(17.0, 30.0), 20.0, 0.1, WIDE)
    assert [one.speed_up for one in found] == pytest.approx((0.85, 0.9, 1.0, 1.1))


def test_one_that_was_not_seen_to_turn_is_flown_at_v() -> None:
    found = corner_speeds(AirEnvelope(), 20.0, 0.1, Turns(100.0, is_sure=False))
    assert found == (CornerSpeed(1.0, 100.0),)


def test_one_that_turns_wide_sees_more_slower_and_with_a_lag() -> None:
    def left_out(lag_m: float, speeds: Sequence[CornerSpeed]) -> float:
        found = sped_up_plan(
            CORNER,
            lag_m,
            lead_m=100.0,
            separations_m=(200.0,),
            speeds=speeds,
            path_efficiency=1.0,
            aim_m=lag_m,
        )
        assert found is not None
        plan = found[0]
        assert abs(plan.next_lag_m - lag_m) <= CONVERGED_M
        return DeadbeatRules(plan.parameters).uncovered_m2(plan) / 250.0**2

    speeds = corner_speeds(AirEnvelope(), 20.0, 0.1, WIDE)
    assert left_out(0.0, speeds) > 1.0
    assert left_out(150.0, speeds) < 0.2
    assert left_out(150.0, speeds[-1:]) > 0.5


def test_the_lag_to_begin_with_is_what_a_corner_needs_and_no_more() -> None:
    def lag_m(turns: Turns, share: float) -> float:
        speeds = corner_speeds(AirEnvelope(), 20.0, 0.1, turns)
        values = {"lead_m": 100.0, "separation_m": 200.0, "path_efficiency": share}
        return lag_to_begin_with_m(CORNER, speeds, **values)

    assert lag_m(SEEN, 1.0) == 0.0
    assert lag_m(WIDE, 1.0) == 0.0  # it would save less than it is worth
    assert 100.0 <= lag_m(Turns(180.0, is_wide=True), 1.0) <= 200.0
    sloppy = lag_m(SEEN, 0.7)
    assert 100.0 < sloppy < 300.0
    rules = DeadbeatRules(CORNER, path_efficiency=0.7)
    assert rules.plan(0.0, lead_m=100.0, separation_m=200.0).next_lag_m > 500.0
    assert lag_m(Turns(400.0, is_wide=True, by_bank=False), 0.5) == 0.0


@pytest.mark.parametrize("lead_m", [80.0, 93.0, 103.0])
def test_a_faster_weave_sees_more(lead_m: float) -> None:
    uncovered = []
    for speed_ups in ((1.0,), (1.1, 1.0)):
        planned = sped_up_plan(
            CORNER,
            0.0,
            lead_m=lead_m,
            separations_m=(215.0, 200.0),
            speeds=[CornerSpeed(one, 100.0) for one in speed_ups],
            path_efficiency=1.0,
        )
        assert planned is not None
        plan, speed_up = planned
        assert plan.rule is Rule.D4
        assert speed_up == speed_ups[0]
        assert abs(plan.next_lag_m) <= CONVERGED_M
        rules = DeadbeatRules(CORNER, path_efficiency=speed_up)
        weave = rules._best_weave(rules.paths.problem(0.0), lead_m, 215.0)
        assert weave is not None
        uncovered.append(float(rules.paths.uncovered_m2(weave)[0]))
    assert uncovered[1] < 0.9 * uncovered[0]


def test_the_slower_speed_is_taken_where_the_faster_has_no_path() -> None:
    planned = sped_up_plan(
        CORNER,
        900.0,
        lead_m=93.0,
        separations_m=(200.0,),
        speeds=[CornerSpeed(1.1, 100.0), CornerSpeed(1.0, 100.0)],
        path_efficiency=1.0,
    )
    assert planned is not None
    plan, speed_up = planned
    assert speed_up == 1.0
    assert closest_approach(plan.path, CORNER).distance_m >= 200.0


def test_catching_up_stays_within_the_trim() -> None:
    assert catching_up_mps(
        500.0, 0.0, 20.0, speed_up=1.1, share=1.0, most_mps=22.0
    ) == pytest.approx(22.0)
    assert catching_up_mps(
        500.0, 25.0, 20.0, speed_up=1.0, share=1.0, most_mps=22.0
    ) == pytest.approx(20.0 / 0.95)
    most = catching_up_mps(500.0, 200.0, 20.0, speed_up=1.1, share=1.0, most_mps=22.0)
    assert math.isclose(most, 22.0)
