"""The leg's filters: they are Kalman's, and learn how a pilot flies."""

import math

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad_vec
from scipy.linalg import expm

from sar_estimator.estimation.leg_process import (
    VELOCITY_WALK,
    WANDER_DAMPING,
    WANDER_TIME_S,
    LegProcess,
    predict,
    update,
    wander_transition,
)

OSCILLATOR = np.array(
    [[0.0, 1.0], [-1.0 / WANDER_TIME_S**2, -2.0 * WANDER_DAMPING / WANDER_TIME_S]]
)


def driven_by(size):
    """The spectral density that gives the wander's velocity its standard deviation."""
    return 4.0 * WANDER_DAMPING * size**2 / WANDER_TIME_S


@given(st.floats(0.0, 60.0))
def test_the_wander_goes_on_by_the_matrix_exponential(dt):
    found = np.array(wander_transition(dt)).reshape(2, 2)
    assert found == pytest.approx(expm(OSCILLATOR * dt), abs=1e-9)


@pytest.mark.parametrize("dt", [0.2, 1.0, 5.0, 30.0])
def test_predicting_is_kalmans_with_the_noise_of_the_driven_process(dt):
    size, rng = 0.6, np.random.default_rng(1)
    root = rng.standard_normal((4, 4))
    means, before = rng.standard_normal((2, 4)), root @ root.T
    after, moved = before.copy(), means.copy()
    predict(moved, after, dt, wander_transition(dt), size)
    f = np.zeros((4, 4))
    f[:2, :2], f[2:, 2:] = ((1.0, dt), (0.0, 1.0)), expm(OSCILLATOR * dt)
    noise = np.zeros((4, 4))
    noise[:2, :2] = VELOCITY_WALK * np.array(((dt**3 / 3.0, dt**2 / 2.0), (dt**2 / 2.0, dt)))
    column = lambda s: expm(OSCILLATOR * s)[:, 1]  # noqa: E731
    noise[2:, 2:], _ = quad_vec(lambda s: driven_by(size) * np.outer(column(s), column(s)), 0.0, dt)
    assert moved == pytest.approx(means @ f.T)
    assert after == pytest.approx(f @ before @ f.T + noise, rel=1e-6, abs=1e-9)


@given(st.integers(0, 2**32 - 1), st.booleans())
def test_updating_is_filterpys(seed, is_velocity):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((4, 4))
    means, covariance = 10.0 * rng.standard_normal((2, 4)), root @ root.T + 0.1 * np.eye(4)
    row = np.array([0.0, *(10.0 * rng.standard_normal(2)), 1.7, float(is_velocity)])
    sigma = 1.7 if is_velocity else 0.5 * 1.7
    shown = np.array([[0.0, 1.0, 0.0, 1.0] if is_velocity else [1.0, 0.0, 1.0, 0.0]])
    wanted = []
    for axis in range(2):
        alone = KalmanFilter(dim_x=4, dim_z=1)
        alone.x, alone.P = means[axis].copy(), covariance.copy()
        alone.update(row[[1 + axis]], R=np.array([[sigma**2]]), H=shown)
        wanted.append(alone)
    off_x, off_y, variance, gains = update(means, covariance, row, 0.5)
    assert means == pytest.approx(np.array([one.x for one in wanted]), rel=1e-6, abs=1e-8)
    assert covariance == pytest.approx(wanted[0].P, rel=1e-6, abs=1e-8)
    assert (off_x, off_y) == pytest.approx((wanted[0].y[0], wanted[1].y[0]))
    assert variance == pytest.approx(wanted[0].S[0, 0])
    assert gains == pytest.approx(wanted[0].K[:, 0], rel=1e-6, abs=1e-9)


def wandering(size, seconds, *, sigma=3.0, scale=1.0, seed=0, across=None):
    """Rows of a leg flown east by a pilot who wanders, with positions and velocities."""
    rng = np.random.default_rng(seed)
    turn = expm(OSCILLATOR)
    spread = np.diag((WANDER_TIME_S**2, 1.0))
    root = np.linalg.cholesky(spread - turn @ spread @ turn.T + 1e-12 * np.eye(2))
    state = np.linalg.cholesky(spread) @ rng.standard_normal((2, 2))
    sizes = np.array((size, size if across is None else across))
    rows = []
    for t in range(seconds):
        state = turn @ state + root @ rng.standard_normal((2, 2))
        w, u = state * sizes
        rows.append((t, 20.0 + u[0] + 0.1 * rng.standard_normal(), u[1], 0.1, 1.0))
        x, y = (20.0 * t + w[0], w[1]) + scale * sigma * rng.standard_normal(2)
        rows.append((t, x, y, sigma, 0.0))
    return np.array(rows, dtype=float)


def learnt(rows, prior=0.2):
    process = LegProcess(prior)
    process.begin(0.0, (0.0, 0.0), (20.0, 0.0), 3.0)
    process.absorb(rows, 0.0)
    return process.belief


@pytest.mark.parametrize("size", [0.03, 0.3, 0.6, 1.5])
def test_the_size_of_the_wander_is_learnt(size):
    found = [learnt(wandering(size, 240, seed=seed)).size_mps for seed in range(8)]
    # As far as the sizes that are tried are apart.
    assert size / 2.2 < np.median(found) < size * 2.2


@pytest.mark.parametrize("scale", [0.2, 1.0])
def test_how_good_positions_are_is_learnt(scale):
    rows = wandering(0.1, 200, scale=scale)
    found = learnt(rows[rows[:, 4] == 0.0]).scale
    assert found == pytest.approx(scale, rel=0.5)


def test_a_pilot_who_holds_his_line_better_than_his_speed():
    belief = learnt(wandering(1.5, 400, across=0.3))
    assert belief.along > 1.3 * belief.across


def test_a_steady_pilots_line_is_known_within_what_is_said_of_it():
    misses = []
    for seed in range(30):
        belief = learnt(wandering(0.3, 120, seed=seed))
        off, sigma = belief.means[1, 1], math.sqrt(belief.covariance[1, 1])
        misses.append(off / sigma)
    assert 0.5 < np.std(misses) < 1.5


def test_what_was_learnt_outlives_the_leg():
    process = LegProcess(0.2)
    process.begin(0.0, (0.0, 0.0), (20.0, 0.0), 3.0)
    process.absorb(wandering(1.5, 200), 0.0)
    before = process.belief
    process.begin(300.0, (0.0, 0.0), (0.0, 20.0), 3.0)
    assert process.belief.size_mps == pytest.approx(before.size_mps)
    assert process.belief.covariance[1, 1] == pytest.approx(9.0)


def test_loosening_lets_the_line_move():
    process = LegProcess(0.2)
    process.begin(0.0, (0.0, 0.0), (20.0, 0.0), 3.0)
    process.absorb(wandering(0.03, 100), 0.0)
    known = process.belief.covariance[1, 1]
    process.loosen()
    assert process.belief.covariance[1, 1] == pytest.approx(known + 1.0)
