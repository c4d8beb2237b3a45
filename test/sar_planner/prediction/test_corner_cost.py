"""What corners cost in time is learnt once each, and expected of the next."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate
from sar_planner.prediction.corner_cost import CornerCost, passed_s

STOP = CornerEstimate(104.0, Pose(80.0, 0.0, 0.0), 108.0, 20.0, 2.5, np.zeros((2, 2)), 0.0, 0.0)


def leg_after(lost_s, *, turned_deg=-90.0, speed_mps=20.0, sigma_mps=0.2, k_time_s=130.0):
    """The leg after a corner that cost so much time, told at ``k_time_s``."""
    heading = math.radians(turned_deg)
    away = speed_mps * (k_time_s - passed_s(STOP) - lost_s)
    foot = Pose(80.0, 0.0, heading).offset(away)
    return LegEstimate(k_time_s, foot, speed_mps, 1.0, 0.001, sigma_mps)


def test_a_stop_costs_twice_half_its_slow_down():
    assert passed_s(STOP) == 104.0  # 80 m from the onset at 100 s, at 20 m/s


@pytest.mark.parametrize("lost_s", [0.5, 3.0, 8.0, 20.0])
def test_the_first_corner_is_believed(lost_s):
    found = CornerCost().learnt(1, STOP, leg_after(lost_s))
    assert found.lost_s == pytest.approx(lost_s)
    assert found.learnt_k == 1


def test_the_next_one_by_half_and_each_once():
    one = CornerCost().learnt(1, STOP, leg_after(8.0))
    two = one.learnt(2, STOP, leg_after(4.0))
    assert two.lost_s == pytest.approx(6.0)
    assert two.learnt(2, STOP, leg_after(0.0)) is two


@pytest.mark.parametrize(
    "leg",
    [
        leg_after(8.0, turned_deg=-20.0),
        leg_after(8.0, speed_mps=2.0),
        leg_after(8.0, sigma_mps=1.0),
        replace(leg_after(8.0), time_s=107.0),
    ],
)
def test_nothing_is_learnt_of_what_is_not_known(leg):
    assert CornerCost().learnt(1, STOP, leg) == CornerCost()


@pytest.mark.parametrize("lost_s", [-3.0, 40.0])
def test_a_cost_that_cannot_be_is_seen_once_and_not_believed(lost_s):
    assert CornerCost(5.0, 1).learnt(2, STOP, leg_after(lost_s)) == CornerCost(5.0, 2)


def test_one_who_rolls_is_expected_to_roll_again_until_he_is_slow():
    cost = CornerCost(3.0, 1)
    rolled = cost.expected(STOP, 15.0)
    assert rolled.stop == STOP.stop
    assert passed_s(rolled) == pytest.approx(passed_s(STOP))
    assert rolled.speed_mps / rolled.accel_mps2 == pytest.approx(3.0)
    assert cost.expected(STOP, 7.0) is STOP
    assert CornerCost(7.5, 1).expected(STOP, 15.0) is STOP
    assert CornerCost().expected(STOP, 15.0) is STOP
