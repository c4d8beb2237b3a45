"""Compiled or not, the same comes of it."""

import os
import subprocess
import sys

import pytest

CODE = """
import sys
import numpy as np
from sar_bridge.mission.transition_check import Track
from sar_bridge.arduplane.l1_predictor import FollowerTuning, Route, follow
from sar_estimator.common.states import Motion
uav = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
points = np.array([[60.0, 5.0], [150.0, -40.0], [200.0, -200.0], [200.0, -900.0]])
tuning = FollowerTuning(15.0)
path = follow(uav, Route(points, uav), tuning=tuning, cruise_mps=None, wind_mps=(3.0, 1.0))
track = Track(points, (0.0, 0.0), uav, tuning, until_m=0.0)
apart_m = track.apart_m(points[1:], (50.0, 0.0))
print("numba" in sys.modules, *path[-1].round(6), round(apart_m, 6))
"""


def said(**environment):
    found = subprocess.run(
        [sys.executable, "-c", CODE],
        capture_output=True,
        text=True,
        timeout=100,
        check=True,
        env={**os.environ, **environment},
    )
    return found.stdout.split()


def test_without_compiling_the_same_is_computed():
    compiled, plain = said(SAR_COMPILE="1"), said(SAR_COMPILE="0")
    assert (compiled[0], plain[0]) == ("True", "False")
    assert [float(x) for x in plain[1:]] == pytest.approx([float(x) for x in compiled[1:]])
