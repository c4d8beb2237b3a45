"""Fixes nobody expects: the estimator neither crashes nor tells what is no number.

``SAR_FUZZ_INPUTS`` inputs, seeded.
"""

import math
import os

import numpy as np

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.wires import WIRES
from sar_estimator.estimation.component import leg_outputs, motion_outputs
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.parameters import EstimatorParameters

INPUTS = int(os.environ.get("SAR_FUZZ_INPUTS", "4000"))
DATUM = Datum(37.8, -122.8)
EXTREMES = (0.0, -0.0, 1e-300, 90.0, -90.0, 180.0, 1e9, -1e9, math.nan, math.inf, -math.inf)
PER_FLIGHT = 400


def extreme(rng, value):
    kind = rng.integers(3)
    if kind == 0:
        return float(EXTREMES[rng.integers(len(EXTREMES))])
    return value + float(rng.normal()) * 10.0 ** float(rng.integers(-6, 4))


def fix(rng, i):
    """Return the fix of a helicopter that flies north, three in ten with a value turned."""
    values = [1000.0 + i, 37.8 + 1.8e-4 * i, -122.8, 100.0, 1.0]
    fixed = True
    if rng.random() < 0.3:
        which = int(rng.integers(6))
        if which < len(values):
            values[which] = extreme(rng, values[which])
        fixed = which < len(values)
    time_s, north, east, up, scale = values
    covariance = np.diag((scale, scale)) * 9.0
    return Fix(time_s, north, east, up, covariance, has_fix=fixed)


def test_whatever_a_receiver_says():
    rng = np.random.default_rng(5)
    for flight in range(max(1, INPUTS // PER_FLIGHT)):
        estimator = HelicopterEstimator(EstimatorParameters(), DATUM if flight % 2 else None)
        for i in range(PER_FLIGHT):
            estimator.add_fix(fix(rng, i))
            if rng.random() < 0.1:
                estimator.add_velocity(
                    1000.0 + i, extreme(rng, 0.0), extreme(rng, 20.0), abs(extreme(rng, 0.1))
                )
            now = 1000.5 + i
            estimate = estimator.predict(now)
            assert estimate is None or estimate.motion.is_finite()
            for topic, value in (*motion_outputs(estimator, now), *leg_outputs(estimator, now)):
                assert WIRES[topic].to_message(value, now) is not None
