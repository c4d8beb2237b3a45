"""Flying faster in a corner: which speeds, and what they do."""

from __future__ import annotations

import math

import pytest

from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.separation import closest_approach
from sar_planner.rules.corner_speed import catching_up_mps, sped_up_plan, speed_ups_of
from sar_planner.rules.deadbeat_rules import CONVERGED_M, DeadbeatRules
from sar_planner.rules.paper_rules import Rule

CORNER = CornerParameters()


def test_no_faster_than_the_envelope_allows_on_any_course() -> None:
    assert speed_ups_of(AirEnvelope(), 20.0, 0.1) == pytest.approx((1.1, 1.0))
    assert speed_ups_of(AirEnvelope(10.0, 25.0, (4.0, 0.0)), 20.0, 0.1) == pytest.approx(
        (1.05, 1.0)
    )
    assert speed_ups_of(AirEnvelope(10.0, 30.0, (0.0, 10.0)), 20.0, 0.1) == (1.0,)


@pytest.mark.parametrize("lead_m", [80.0, 93.0, 103.0])
def test_a_faster_weave_sees_more(lead_m: float) -> None:
    uncovered = []
    for speed_ups in ((1.0,), (1.1, 1.0)):
        planned = sped_up_plan(
            CORNER,
            0.0,
            lead_m=lead_m,
            separations_m=(215.0, 200.0),
            speed_ups=speed_ups,
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
        speed_ups=(1.1, 1.0),
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
