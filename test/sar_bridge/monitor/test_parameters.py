"""The monitor's parameters: thresholds in their order, horizons within each other."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.checked import read


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"escape_separation_m": 180.0}, "escape_separation_m = 180: expected more than 0, at"),
        ({"caution_separation_m": 250.0}, "caution_separation_m = 250: expected more than 0, at"),
        ({"min_separation_m": 0.0}, "min_separation_m = 0.0: expected more than 0"),
        ({"clear_s": -1.0}, "clear_s = -1.0: expected 0 or more"),
        ({"horizon_s": math.nan}, "horizon_s = nan: expected a number"),
        ({"escape_horizon_s": 50.0}, "escape_horizon_s = 50.0: expected at most"),
        ({"horizon_s": 500.0}, "horizon_s = 500.0: expected 0 to 300"),
        ({"escape_delay_s": 25.0}, "escape_delay_s = 25.0: expected at most escape_horizon_s = 20"),
    ],
)
def test_bad_parameters_are_named(changes, message):
    with pytest.raises(ValueError, match="expected") as error:
        read(MonitorParameters, changes)
    assert message in str(error.value)
    with pytest.raises(ValueError, match=next(iter(changes))):
        MonitorParameters(**changes)


@given(st.floats(50.0, 500.0))
def test_thresholds_that_are_not_given_are_shares_of_the_least(least_m):
    found = list(MonitorParameters(min_separation_m=least_m).thresholds().values())
    assert found == pytest.approx([least_m, 0.85 * least_m, 0.75 * least_m, 0.65 * least_m])
    given_one = MonitorParameters(min_separation_m=least_m, escape_separation_m=30.0)
    assert given_one.thresholds()["escape_separation_m"] == 30.0
