"""The speed trim, and what is learnt of the speed made good."""

import pytest

from sar_planner.guidance.speed_control import MadeGood, trimmed_mps


def test_trim_is_proportional_and_bounded():
    assert trimmed_mps(5.0, 20.0, gain=0.1, trim=0.1) == pytest.approx(20.5)
    assert trimmed_mps(500.0, 20.0, gain=0.1, trim=0.1) == pytest.approx(22.0)
    assert trimmed_mps(-500.0, 20.0, gain=0.1, trim=0.1) == pytest.approx(18.0)


@pytest.mark.parametrize("off", [-5.0, -1.0, 0.0, 1.0, 5.0])
def test_a_lag_is_taken_out_as_well_behind_who_flies_faster_for_a_while(off):
    for lag, correction in ((-500.0, -2.0), (-4.0, -0.4), (4.0, 0.4), (500.0, 2.0)):
        speed = trimmed_mps(lag, 20.0, gain=0.1, trim=0.1, off_mps=off)
        assert speed == pytest.approx(20.0 + max(-2.0, min(2.0, off)) + correction)


def fly_corner(good, share, *, seconds=60):
    good.begin(20.0)
    for second in range(seconds):
        good.watch(float(second), 20.0 * share * second, 20.0)
    return good


def test_share_is_learnt_from_corner_to_corner_and_in_the_corner():
    good = MadeGood(0.5)
    fly_corner(good, 0.7)
    assert 0.7 < good.now < 0.76
    good.learn()
    assert good.share == pytest.approx(0.85)
    for _ in range(6):
        fly_corner(good, 0.7).learn()
    assert good.share == pytest.approx(0.7, abs=0.01)
    assert good.now == good.share


def test_bounds_short_corners_and_corners_given_up():
    good = MadeGood(1.0)
    fly_corner(good, 0.1).learn()
    assert good.share == 0.5
    good = MadeGood(1.0)
    fly_corner(good, 0.6, seconds=3).learn()
    assert good.share == 1.0
    fly_corner(good, 0.6)
    good.cancel()
    good.learn()
    assert good.share == 1.0


def test_another_path_begins_its_own_count():
    good = MadeGood(1.0)
    good.begin(20.0)
    for second in range(30):
        good.watch(float(second), 20.0 * second, 20.0)
    good.moved()
    for second in range(30, 60):
        good.watch(float(second), 20.0 * (second - 30), 20.0)
    good.learn()
    assert good.share == pytest.approx(1.0)
