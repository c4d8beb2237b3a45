"""Every phase of the helicopter is met with what is known of it, or with nothing known."""

import itertools
import math

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.helicopter_predictor import HelicopterPredictor

LEG = LegEstimate(100.0, Pose(0.0, 0.0, 0.0), 20.0, 1.0, 0.001, 0.05)
CORNER = CornerEstimate(104.0, Pose(80.0, 0.0, 0.0), 108.0, 20.0, 2.5, np.zeros((2, 2)), 0.0, 0.0)
MOVING = Motion(104.0, 60.0, 0.0, 10.0, 0.0)


def predictor(**changes):
    values = {
        "corner": CornerParameters(),
        "turn_rad": -0.5 * math.pi,
        "helicopter": MOVING,
        "phase": Phase.CRUISE,
        "leg": LEG,
        "estimate": CORNER,
        "is_predicted": True,
        "went_on": False,
    }
    return HelicopterPredictor(**(values | changes))


@pytest.mark.parametrize(
    ("phase", "leg", "estimate", "predicted", "went_on", "side", "vx"),
    list(
        itertools.product(
            Phase, (LEG, None), (CORNER, None), (True, False), (True, False), (1, -1), (0.0, 15.0)
        )
    ),
)
def test_whatever_is_known_forecasts_are_positions_or_none(
    phase, leg, estimate, predicted, went_on, side, vx
):
    known = predictor(
        phase=phase,
        leg=leg,
        estimate=estimate,
        is_predicted=predicted,
        went_on=went_on,
        turn_rad=-0.5 * math.pi * side,
        helicopter=Motion(104.0, 60.0, 0.0, vx, 0.0),
    )
    found = known.forecasts(104.5)
    assert isinstance(found, tuple)
    if phase is Phase.LOST:
        assert found == ()
    for forecast in found:
        positions = np.array(forecast.positions(np.arange(104.5, 164.5, 5.0)))
        assert np.isfinite(positions).all()
        speeds = np.hypot(*np.diff(positions, axis=0).T) / 5.0
        assert speeds.max() < 30.0


@pytest.mark.parametrize("side", [1, -1])
def test_a_corner_is_left_to_the_patterns_side_and_mirrored(side):
    (forecast,) = predictor(phase=Phase.DECELERATING, turn_rad=-0.5 * math.pi * side).forecasts(
        104.0
    )
    x, y = forecast.positions([150.0])[0]
    assert x == pytest.approx(80.0, abs=1.0)
    assert math.copysign(1.0, y) == -side


def test_a_slow_down_that_was_not_predicted_is_no_corner():
    going, stopping = predictor(phase=Phase.DECELERATING, is_predicted=False).forecasts(104.0)
    assert going.positions([124.0])[0][0] > stopping.positions([124.0])[0][0] + 100.0


def test_one_that_leaves_otherwise_is_believed():
    """North-west of its stop: neither to the pattern's side, nor by noise."""
    out = Motion(114.0, 50.0, 40.0, -12.0, 16.0)
    seen, *_ = predictor(phase=Phase.ACCELERATING, helicopter=out).forecasts(114.0)
    x, y = seen.positions([124.0])[0]
    assert x < 0.0
    assert y > 100.0
