import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad_vec
from scipy.linalg import expm

from sar_estimator.motion_filter import MotionFilter, singer_noise, singer_transition


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


def test_predicting_leaves_the_filter_as_it_is():
    motion = MotionFilter(0.0, (1.0, 2.0), np.eye(2), tau_s=3.0, speed_sigma_mps=10.0)
    first = motion.predicted(5.0, 1.0)
    assert motion.time_s == 0.0
    assert first.motion == motion.predicted(5.0, 1.0).motion
    motion.advance(5.0, 1.0)
    assert motion.predicted(5.0, 1.0).covariance == pytest.approx(first.covariance)


def test_velocity_update_sets_the_speed():
    motion = MotionFilter(0.0, (0.0, 0.0), np.eye(2), tau_s=3.0, speed_sigma_mps=40.0)
    motion.update_velocity((20.0, -3.0), 0.1)
    estimate = motion.predicted(0.0, 1.0).motion
    assert (estimate.vx_mps, estimate.vy_mps) == pytest.approx((20.0, -3.0), abs=0.01)
