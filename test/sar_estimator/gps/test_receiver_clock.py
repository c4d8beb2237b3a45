"""The receiver's times by this machine's clock: what is late moves nothing, steps are believed."""

import numpy as np
import pytest

from sar_estimator.gps.receiver_clock import AGREE, ReceiverClock


def stamped(clock, times, delays, offset=0.0):
    return [clock.stamp(t, t + offset + late) for t, late in zip(times, delays, strict=True)]


def test_stamps_keep_the_receivers_distances_whatever_the_delays():
    rng = np.random.default_rng(1)
    clock, times = ReceiverClock(), 1e9 + np.arange(200.0)
    delays = 0.08 + rng.exponential(0.05, 200)
    found = np.array(stamped(clock, times, delays, offset=-3.2))
    late = found[60:] - times[60:] + 3.2
    assert late.min() >= 0.08 - 1e-6
    assert late.max() < 0.09
    assert clock.jitter_s == pytest.approx(delays[-60:].max() - delays[-60:].min(), abs=1e-6)


@pytest.mark.parametrize("step", [1.0, -1.0, 3600.0, -18.0, 619_315_200.0])
def test_a_clock_that_is_set_is_followed_once_some_agree(step):
    clock = ReceiverClock()
    stamped(clock, np.arange(100.0), [0.1] * 100)
    times = np.arange(100.0, 110.0)
    found = [clock.stamp(t, t + 0.1 + step) for t in times]
    for t, one in zip(times[: AGREE - 1], found, strict=False):
        assert one is None or one == pytest.approx(t + 0.1)  # as if it were only late
    assert found[AGREE - 1 :] == pytest.approx((times + 0.1 + step)[AGREE - 1 :])
    assert clock.steps == 1


def test_a_reading_that_is_wrong_alone_moves_nothing():
    clock = ReceiverClock()
    stamped(clock, np.arange(100.0), [0.1] * 100)
    assert clock.stamp(50.0, 100.1) is None
    assert clock.stamp(101.0, 101.1) == pytest.approx(101.1)
    assert clock.steps == 0


def test_readings_that_are_held_up_are_stamped_as_if_they_were_not():
    clock = ReceiverClock()
    stamped(clock, np.arange(50.0), [0.1] * 50)
    held = [clock.stamp(50.0 + i, 51.5 + 0.01 * i) for i in range(2)]
    assert held == pytest.approx([50.1, 51.1])
