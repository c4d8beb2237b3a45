import math

import numpy as np
import pytest

from sar_estimator.leg import LegRow, LegTracker, fit_line, leg_fit


def straight(n, *, heading=0.6, speed=20.0, sigma=2.0, seed=0, start=0.0):
    rng = np.random.default_rng(seed)
    direction = speed * np.array((math.cos(heading), math.sin(heading)))
    return [
        LegRow(
            start + t, *(direction * t + sigma * rng.standard_normal(2)), sigma, is_velocity=False
        )
        for t in range(n)
    ]


def table(rows):
    return np.array([(r.time_s, r.x, r.y, r.sigma, r.is_velocity) for r in rows], dtype=float)


def fit_rows(rows):
    return leg_fit(rows, fit_line(rows))


def test_fit_recovers_the_line_within_its_own_sigma():
    misses = []
    for seed in range(40):
        fit, misfit = fit_rows(table(straight(30, seed=seed)))
        estimate = fit.estimate()
        assert misfit < 4.5
        misses.append((fit.heading_rad - 0.6) / estimate.heading_sigma_rad)
        assert estimate.speed_mps == pytest.approx(20.0, abs=5 * estimate.speed_sigma_mps)
    assert 0.6 < np.std(misses) < 1.4


def test_few_rows_make_no_leg():
    tracker = LegTracker(40.0)
    for row in straight(5):
        tracker.add(row)
    assert tracker.fit() is None


def test_old_course_is_forgotten_after_a_turn():
    tracker = LegTracker(40.0)
    rows = straight(30)
    corner = rows[-1]
    rows += [
        LegRow(30.0 + t, corner.x - 20.0 * t, corner.y, 2.0, is_velocity=False) for t in range(14)
    ]
    for row in rows:
        tracker.add(row)
        fit = tracker.fit()
    assert fit is not None
    assert abs(fit.heading_rad) == pytest.approx(math.pi, abs=0.15)
    assert fit.since_s >= 27.0


def test_velocities_count_in_the_fit():
    rows = [*straight(8, heading=0.0, sigma=5.0), LegRow(7.0, 20.0, 0.0, 0.05, is_velocity=True)]
    fit, _ = fit_rows(table(rows))
    assert fit.speed_mps == pytest.approx(20.0, abs=0.15)
    projected = fit.project(table(rows))
    assert projected.is_speed.tolist() == [False] * 8 + [True]
    assert projected.values[-1] == pytest.approx(20.0, abs=0.01)


def test_fit_is_the_weighted_least_squares_one():
    rows = table([*straight(20, seed=3), LegRow(12.5, 11.0, 16.0, 0.5, is_velocity=True)])
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    age, fast = rows[:, :1] - rows[-1, 0], rows[:, 4:] > 0.0
    design = np.where(fast, (0.0, 1.0), np.hstack((np.ones_like(age), age))) / rows[:, 3:4]
    wanted, *_ = np.linalg.lstsq(design, rows[:, 1:3] / rows[:, 3:4])
    fit, _ = fit_rows(rows)
    assert fit.position_m == pytest.approx(wanted[0])
    assert fit.velocity_mps == pytest.approx(wanted[1])
    covariance = np.linalg.inv(design.T @ design)
    assert fit.spread == pytest.approx((covariance[0, 0], covariance[0, 1], covariance[1, 1]))


def test_a_long_leg_at_a_high_rate_keeps_its_window():
    tracker = LegTracker(40.0)
    for i in range(3000):
        time = 0.41 * i
        tracker.add(LegRow(time, 20.0 * time, 0.0, 1.0, is_velocity=False))
        tracker.add(LegRow(time, 20.0, 0.0, 0.1, is_velocity=True))
    kept = tracker.rows
    assert kept[-1, 0] - kept[0, 0] <= 40.0 < kept[-1, 0] - kept[0, 0] + 0.41
    assert tracker.fit().since_s == kept[0, 0]
