import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.checked import changed
from sar_planner.parameters.corner import (
    CornerParameters,
    check,
    clearance_times_s,
    track_spacing_m,
)

P = CornerParameters()


def test_the_papers_own_values_pass():
    check(P)


def test_track_spacing_of_equation_1():
    assert track_spacing_m(150.0, math.radians(79.6), 0.0) == pytest.approx(250.0, abs=0.2)
    assert track_spacing_m(150.0, math.radians(79.6), 0.1) == pytest.approx(225.0, abs=0.2)


def test_clearance_times_are_the_exact_minima():
    first, second = clearance_times_s(P)
    alpha = np.linspace(0.0, math.pi / 2, 10001)
    g = np.cos(alpha) + alpha
    base = 1.5 * 20.0 / 2.5
    assert first == pytest.approx(base + (250 + 100 - 100 * math.pi) / 20 + 5.0 * g.min())
    assert second == pytest.approx(base + 350 / 20 - 5.0 * g.max())
    assert first == pytest.approx(18.79, abs=0.005)
    printed_13 = base + (250 - 100) / 20
    assert printed_13 == 19.5
    assert first < printed_13


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"accel_mps2": 2.1}, r"accel_mps2 = 2\.1: expected more than 2\.12"),
        ({"min_clearance_s": 19.0}, r"min_clearance_s = 19\.0: expected less than 18\.792"),
        ({"convergence": 1.0}, r"convergence = 1\.0: expected more than 0, less than 1"),
        ({"speed_mps": -1.0}, r"speed_mps = -1\.0: expected more than 0"),
        ({"turn_radius_m": math.nan}, "turn_radius_m = nan: expected a number"),
        ({"spacing_m": 90.0}, r"spacing_m = 90\.0: expected more than turn_radius_m"),
        ({"taylor_y_m": -5.0}, r"taylor_y_m = -5\.0"),
    ],
)
def test_refusals_name_parameter_value_and_bound(changes, named):
    with pytest.raises(ValueError, match=named):
        check(changed(P, **changes))


@given(st.floats(1.0, 4.0), st.floats(0.05, 0.95))
def test_condition_12_is_condition_11(accel, c):
    p = replace(P, accel_mps2=accel, convergence=c)
    corrected = p.stopping_m / p.turn_radius_m < (2.5 * math.pi - 5 - c) / (3 - c)
    assert corrected == (p.fixed_lag_m > p.turn_radius_m - p.stopping_m)
