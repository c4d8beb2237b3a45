import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad_vec
from scipy.linalg import expm

from sar_estimator.motion_filter import (
    MotionFilters,
    carried,
    models,
    normalised_innovation,
    singer_noise,
    singer_transition,
)


def continuous(tau):
    return np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / tau]])


@given(st.floats(0.05, 10.0), st.floats(0.5, 20.0))
def test_transition_is_the_matrix_exponential(dt, tau):
    assert singer_transition(dt, tau) == pytest.approx(expm(continuous(tau) * dt), rel=1e-6)


@pytest.mark.parametrize("dt", [0.1, 1.0, 5.0])
@pytest.mark.parametrize("tau", [1.0, 3.0])
def test_noise_is_the_integral_of_the_driven_system(dt, tau):
    sigma = 1.5
    drive = np.array([0.0, 0.0, 1.0])

    def integrand(s):
        column = expm(continuous(tau) * s) @ drive
        return np.outer(column, column) * 2.0 * sigma**2 / tau

    expected, _ = quad_vec(integrand, 0.0, dt)
    assert singer_noise(dt, tau, sigma) == pytest.approx(expected, rel=1e-5, abs=1e-12)


def filters(speed_sigma=10.0):
    return MotionFilters(
        0.0,
        (1.0, 2.0),
        np.eye(2),
        tau_s=3.0,
        speed_sigma_mps=speed_sigma,
        accel_sigmas_mps2=(0.2, 1.5),
    )


def test_predicting_leaves_the_filters_as_they_are():
    motion = filters()
    first = motion.agile(5.0)
    assert motion.time_s == 0.0
    assert first.motion == motion.agile(5.0).motion
    motion.advance(5.0)
    assert motion.agile(5.0).covariance == pytest.approx(first.covariance)


def test_velocity_update_sets_the_speed():
    motion = filters(40.0)
    motion.update_velocity((20.0, -3.0), 0.1)
    for estimate in (motion.agile(0.0).motion, motion.steady(0.0).motion):
        assert (estimate.vx_mps, estimate.vy_mps) == pytest.approx((20.0, -3.0), abs=0.01)


def test_each_filter_is_what_it_would_be_alone():
    both = filters()
    alone = KalmanFilter(dim_x=6, dim_z=2)
    alone.x = np.array([1.0, 0.0, 0.0, 2.0, 0.0, 0.0])
    alone.P = np.diag([1.0, 100.0, 1.0] * 2)
    for time, place in ((1.0, (20.0, 3.0)), (2.5, (48.0, 6.0)), (3.0, (60.0, 7.0))):
        f, q = models(round(time - both.time_s, 9), 3.0, 1.5)
        alone.predict(F=f, Q=q)
        alone.update(np.array(place), R=4.0 * np.eye(2), H=np.eye(6)[[0, 3]])
        both.advance(time)
        both.update_position(place, 4.0 * np.eye(2))
    agile, steady = both.agile(3.0), both.steady(3.0)
    assert agile.motion.pose.x_m == pytest.approx(alone.x[0])
    assert agile.motion.vx_mps == pytest.approx(alone.x[1])
    assert agile.covariance == pytest.approx(alone.P)
    assert steady.covariance[0, 0] < agile.covariance[0, 0]
    both.settle()
    assert both.steady(3.0).motion == agile.motion


@given(st.floats(0.05, 5.0), st.integers(0, 2**32 - 1))
def test_carrying_on_is_the_matrix_product(dt, seed):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((6, 6))
    state, covariance = rng.standard_normal(6), root @ root.T
    f, q = models(round(dt, 9), 3.0, 1.5)
    moved, spread = carried(state, covariance, f, q)
    assert moved == pytest.approx(f @ state)
    assert spread == pytest.approx(f @ covariance @ f.T + q)


def test_innovation_is_the_mahalanobis_distance():
    estimate = filters().agile(1.0)
    fix, noise = (4.0, -1.0), np.array([[3.0, 1.0], [1.0, 2.0]])
    spread = estimate.covariance[np.ix_([0, 3], [0, 3])] + noise
    off = np.array(fix) - (1.0, 2.0)
    assert normalised_innovation(estimate, fix, noise) == pytest.approx(
        off @ np.linalg.inv(spread) @ off
    )
