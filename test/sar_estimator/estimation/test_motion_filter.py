import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad_vec
from scipy.linalg import expm

from sar_estimator.estimation.motion_filter import (
    STATES,
    MotionFilters,
    both_axes,
    inverse_2x2,
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
        (1.0, 0.0, 1.0),
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


def filterpy_filter(position, spread, speed_sigma):
    alone = KalmanFilter(dim_x=STATES, dim_z=2)
    alone.x = np.array([position[0], 0.0, 0.0, position[1], 0.0, 0.0])
    alone.P = np.diag([0.0, speed_sigma**2, 1.0] * 2)
    alone.P[np.ix_([0, 3], [0, 3])] = spread
    return alone


def random_spread(rng, sigma):
    root = sigma * rng.standard_normal((2, 2))
    return root @ root.T + 0.1 * np.eye(2)


def as_spread(matrix):
    return matrix[0, 0], matrix[0, 1], matrix[1, 1]


@given(st.integers(0, 2**32 - 1))
def test_each_filter_is_filterpys(seed):
    rng = np.random.default_rng(seed)
    tau, sigmas, speed_sigma = 3.0, (0.2, 1.5), 10.0
    position, spread = tuple(rng.standard_normal(2)), random_spread(rng, 3.0)
    both = MotionFilters(
        0.0,
        position,
        as_spread(spread),
        tau_s=tau,
        speed_sigma_mps=speed_sigma,
        accel_sigmas_mps2=sigmas,
    )
    apart = [filterpy_filter(position, spread, speed_sigma) for _ in sigmas]
    time = 0.0
    for _ in range(8):
        dt = round(float(rng.uniform(0.05, 6.0)), 9)
        time += dt
        seen, noise = tuple(30.0 * rng.standard_normal(2)), random_spread(rng, 2.0)
        is_velocity = rng.random() < 0.3
        surprises = both.surprises(time, seen, as_spread(noise))
        both.advance(time)
        if is_velocity:
            both.update_velocity(seen, 0.3)
        else:
            both.update_position(seen, as_spread(noise))
        for alone, sigma, surprise in zip(apart, sigmas, surprises, strict=True):
            f = both_axes(singer_transition(dt, tau))
            alone.predict(F=f, Q=both_axes(singer_noise(dt, tau, sigma)))
            off = np.array(seen) - alone.x[[0, 3]]
            innovation = alone.P[np.ix_([0, 3], [0, 3])] + noise
            assert surprise == pytest.approx(off @ np.linalg.solve(innovation, off), rel=1e-6)
            shown = np.eye(STATES)[[1, 4] if is_velocity else [0, 3]]
            alone.update(np.array(seen), R=0.09 * np.eye(2) if is_velocity else noise, H=shown)
    for alone, found in zip(apart, (both.steady(time), both.agile(time)), strict=True):
        motion = found.motion
        state = (motion.x_m, motion.vx_mps, motion.ax_mps2, motion.y_m, motion.vy_mps)
        assert state == pytest.approx(alone.x[:5], rel=1e-6, abs=1e-6)
        assert found.covariance == pytest.approx(alone.P, rel=1e-6, abs=1e-8)


def test_settling_begins_the_steady_filter_where_the_agile_one_is():
    both = filters()
    for time, place in ((1.0, (20.0, 3.0)), (2.5, (48.0, 6.0)), (3.0, (60.0, 7.0))):
        both.advance(time)
        both.update_position(place, (4.0, 0.0, 4.0))
    before = both.steady(3.0)
    assert before.covariance[0, 0] < both.agile(3.0).covariance[0, 0]
    both.settle()
    assert both.steady(3.0).motion == both.agile(3.0).motion != before.motion
    both.update_position((61.0, 7.0), (4.0, 0.0, 4.0))
    assert both.steady(3.0).motion == both.agile(3.0).motion


def test_what_was_estimated_stays_as_it_was():
    both = filters()
    ahead = both.agile(2.0)
    kept = ahead.covariance.copy()
    both.advance(2.0)
    now = both.agile(2.0)
    both.update_position((20.0, 3.0), (4.0, 0.0, 4.0))
    for estimate in (ahead, now):
        assert estimate.covariance == pytest.approx(kept)


@given(st.integers(0, 2**32 - 1))
def test_the_inverse_is_numpys(seed):
    matrix = random_spread(np.random.default_rng(seed), 3.0)
    assert inverse_2x2(matrix) == pytest.approx(np.linalg.inv(matrix))
