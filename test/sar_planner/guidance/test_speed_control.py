"""The speed trim on legs."""

import pytest

from sar_planner.guidance.speed_control import trimmed_mps


def test_trim_is_proportional_and_bounded():
    assert trimmed_mps(5.0, 20.0, gain=0.1, trim=0.1) == pytest.approx(20.5)
    assert trimmed_mps(500.0, 20.0, gain=0.1, trim=0.1) == pytest.approx(22.0)
    assert trimmed_mps(-500.0, 20.0, gain=0.1, trim=0.1) == pytest.approx(18.0)


@pytest.mark.parametrize("off", [-5.0, -1.0, 0.0, 1.0, 5.0])
def test_a_lag_is_taken_out_as_well_behind_who_flies_faster_for_a_while(off):
    for lag, correction in ((-500.0, -2.0), (-4.0, -0.4), (4.0, 0.4), (500.0, 2.0)):
        speed = trimmed_mps(lag, 20.0, gain=0.1, trim=0.1, off_mps=off)
        assert speed == pytest.approx(20.0 + max(-2.0, min(2.0, off)) + correction)
