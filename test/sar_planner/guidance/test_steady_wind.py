"""The wind over minutes, against means and deviations taken at once."""

import math

import numpy as np
import pytest

from sar_planner.guidance.steady_wind import EXPECTED_SHARE, TIME_CONSTANT_S, SteadyWind


def told(winds, step_s=1.0):
    steady = None
    for i, wind in enumerate(winds):
        steady = SteadyWind.after(steady, wind, i * step_s)
    return steady


def test_the_first_wind_is_believed_with_the_gusts_that_are_usual():
    first = SteadyWind.after(None, (-8.0, 6.0), 100.0)
    assert first == SteadyWind(100.0, (-8.0, 6.0), EXPECTED_SHARE * 10.0)


def test_gusts_are_told_from_the_wind():
    rng = np.random.default_rng(3)
    winds = np.array((8.0, -6.0)) + rng.normal(0.0, 1.5, size=(3000, 2))
    steady = told(winds.tolist())
    assert steady.mean_mps == pytest.approx((8.0, -6.0), abs=0.5)
    assert steady.gusts_mps == pytest.approx(1.5, rel=0.15)


def test_a_wind_that_has_changed_is_believed_after_the_time_constant():
    first = SteadyWind.after(None, (0.0, 0.0), 0.0)
    later = SteadyWind.after(first, (10.0, 0.0), TIME_CONSTANT_S)
    assert later.mean_mps[0] == pytest.approx(10.0 * (1.0 - math.exp(-1.0)))


def test_a_clock_that_was_set_back_begins_anew():
    first = SteadyWind.after(None, (10.0, 0.0), 50.0)
    assert SteadyWind.after(first, (3.0, 4.0), 20.0) == SteadyWind(20.0, (3.0, 4.0), 0.5)
