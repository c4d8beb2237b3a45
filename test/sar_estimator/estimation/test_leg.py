import math

import numpy as np
import pytest

from sar_estimator.estimation.leg import LegRow, LegTracker, leg_estimate
from sar_estimator.estimation.leg_process import LegProcess


def tracker():
    found = LegTracker(LegProcess(0.2))
    found.begin(0.0, (0.0, 0.0), (20.0, 0.0))
    return found


def position(time):
    return LegRow(time, 20.0 * time, 0.0, 2.0, is_velocity=False)


def test_old_rows_go_into_the_process_and_new_ones_wait():
    leg = tracker()
    for t in range(30):
        leg.add(position(float(t)))
    leg.settle(20.0, 0.0)
    assert leg.rows[:, 0].tolist() == [float(t) for t in range(20, 30)]
    assert leg.belief.time_s == 19.0
    assert leg.belief.means[0, 1] == pytest.approx(20.0, abs=0.5)


def test_rows_of_a_kind_too_close_are_left_out():
    leg = tracker()
    for i in range(100):
        leg.add(position(0.1 * i))
        leg.add(LegRow(0.1 * i, 20.0, 0.0, 0.1, is_velocity=True))
    kinds = leg.rows[:, 4]
    assert (kinds == 0.0).sum() == (kinds == 1.0).sum()
    assert 20 <= (kinds == 0.0).sum() <= 25


def test_a_long_leg_at_a_high_rate_keeps_what_is_new():
    leg = tracker()
    for i in range(3000):
        leg.add(position(0.41 * i))
        leg.settle(0.41 * i - 10.0, 0.0)
    assert 20 < len(leg.rows) < 30
    assert (np.diff(leg.rows[:, 0]) > 0.0).all()


def test_a_table_that_is_full_grows():
    leg = tracker()
    for i in range(600):
        leg.add(position(float(i)))
    assert leg.rows[:, 0].tolist() == [float(i) for i in range(600)]


def test_whether_velocities_come():
    leg = tracker()
    leg.add(position(0.0))
    assert not leg.has_velocities
    leg.add(LegRow(1.0, 20.0, 0.0, 0.1, is_velocity=True))
    assert leg.has_velocities


def test_a_leg_is_told_by_its_line_and_mean_speed():
    means = np.array(((100.0, 12.0, 3.0, 0.4), (50.0, 16.0, -2.0, 0.1)))
    covariance = np.diag((4.0, 0.01, 9.0, 0.25))
    leg = leg_estimate(7.0, means, covariance, math.atan2(16.0, 12.0))
    assert (leg.foot.x_m, leg.foot.y_m) == (100.0, 50.0)
    assert leg.speed_mps == pytest.approx(20.0)
    assert (leg.position_sigma_m, leg.speed_sigma_mps) == pytest.approx((2.0, 0.1))
    assert leg.heading_sigma_rad == pytest.approx(0.005)
