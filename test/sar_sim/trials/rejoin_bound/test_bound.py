"""The lower bound on rejoining: never above what a path takes, and above the unhindered time."""

import math

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_planner.prediction.forecast import cruising, departing
from sar_planner.rejoin.rejoin import RejoinTask, rejoin
from sar_sim.trials.rejoin_bound.around import Around, Limits
from sar_sim.trials.rejoin_bound.bound import lower_bound_s, unhindered_s

LIMITS = Limits(20.0, 18.0, 22.0, 100.0, 250.0, 205.0)
LEG = Pose(0.0, 250.0, 0.0)


def task(x, y, heading_deg, forecast=None):
    forecast = forecast or cruising(0.0, LEG, 20.0)
    start = Pose(x, y, math.radians(heading_deg))
    return RejoinTask(start, 0.0, (forecast,), 100.0, 18.0, 22.0, 205.0)


@pytest.mark.parametrize(("x", "y"), [(-300.0, 0.0), (500.0, 0.0), (300.0, -400.0)])
def test_a_point_with_a_free_way_flies_straight(x, y):
    way = np.array([[x, y]])
    assert Around(LIMITS).times_s(way) == pytest.approx(LIMITS.straight_s(-way))


def test_straight_time_meets_a_slot_that_moves():
    (time,) = LIMITS.straight_s(np.array([[300.0, 400.0]]))
    assert math.hypot(300.0 + 20.0 * time, 400.0) == pytest.approx(22.0 * time)


def test_a_point_behind_the_helicopter_goes_round_the_disc():
    beyond = np.array([[0.0, 700.0]])
    tangent = math.sqrt(450.0**2 - 205.0**2)
    straight = LIMITS.straight_s(-beyond)
    (around,) = Around(LIMITS).times_s(beyond)
    assert around > 1.05 * straight[0]
    # No quicker than its shortest way at the most that can be gained on the slot.
    assert around > tangent / 42.0


def test_first_fit_agrees_with_the_unhindered_time():
    for x, y, heading in ((-400.0, 300.0, 40.0), (200.0, -500.0, 170.0), (900.0, 900.0, -90.0)):
        asked = task(x, y, heading)
        h = math.radians(heading)
        seen = np.array(
            [
                [
                    -x * math.cos(h) - y * math.sin(h),
                    x * math.sin(h) - y * math.cos(h),
                    -h,
                    -h,
                ]
            ]
        )
        low = LIMITS.straight_s(np.array([[-x, -y]]))
        (fit,) = LIMITS.first_fit_s(seen, low, np.array([math.inf]))
        assert fit == pytest.approx(unhindered_s(asked), rel=0.006, abs=0.05)


STARTS = [
    (0.0, 600.0, -90.0),
    (300.0, 560.0, 120.0),
    (-200.0, 520.0, 0.0),
    (700.0, 600.0, 180.0),
    (-900.0, 300.0, 90.0),
    (400.0, -300.0, 10.0),
]


@pytest.mark.proof
@pytest.mark.timeout(600)
def test_no_plan_is_sooner_than_the_bound():
    leaving = departing(5.0, LEG, 0.0, speed_mps=20.0, accel_mps2=2.5)
    hindered = 0
    for x, y, heading in STARTS:
        for forecast in (None, leaving):
            asked = task(x, y, heading, forecast)
            plan = rejoin(asked)
            assert plan.kept
            bound = lower_bound_s(asked, plan.duration_s)
            assert unhindered_s(asked) <= bound <= plan.duration_s
            hindered += bound > 1.05 * unhindered_s(asked)
    assert hindered >= 3
