"""A sampled motion goes through its samples, and between them as they say."""

import numpy as np
import pytest

from sar_sim.world.sampled_motion import STEP_S, SampledMotion

TIMES = STEP_S * np.arange(50)


def test_it_goes_through_its_samples_and_a_cubic_between_them():
    places = np.column_stack((TIMES**3, 2.0 * TIMES))
    velocities = np.column_stack((3.0 * TIMES**2, np.full(50, 2.0)))
    motion = SampledMotion(places, velocities)
    assert motion.end_s == pytest.approx(4.9)
    for at_s in (0.0, 0.1, 1.234, 4.85):
        at = motion.at(at_s)
        assert at.time_s == at_s
        assert (at.x_m, at.y_m) == pytest.approx((at_s**3, 2.0 * at_s), abs=1e-9)
        assert at.vx_mps == pytest.approx(3.0 * at_s**2, abs=0.01)


def test_before_and_after_it_is_where_it_begins_and_ends():
    motion = SampledMotion(np.column_stack((TIMES, TIMES)), np.ones((50, 2)))
    assert motion.at(-5.0).x_m == 0.0
    assert motion.at(50.0).x_m == pytest.approx(4.9, abs=1e-5)
