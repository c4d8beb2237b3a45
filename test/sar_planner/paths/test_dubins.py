"""Dubins' words reach their targets."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.paths.dubins import WORDS, lengths_m, words
from sar_planner.paths.slot_intercept import PathBatch

ANGLES = st.floats(-math.pi, math.pi)
PLACES = st.floats(-1500.0, 1500.0)


@settings(max_examples=120, deadline=None)
@given(PLACES, PLACES, ANGLES, ANGLES)
def test_every_dubins_word_reaches_its_target(x, y, h, target):
    start = Pose(30.0, -40.0, h)
    rows = words(start, np.array([[x, y, target]]), 100.0)[:, 0]
    exist = ~np.isnan(rows[:, 0])
    assert exist[:2].all()  # LSL and RSR always exist
    batch = PathBatch(start, 100.0, rows[exist])
    assert batch.ends == pytest.approx(np.tile((x, y), (len(batch), 1)), abs=1e-5)
    for i in range(len(batch)):
        assert math.cos(batch.path(i).end.heading_rad - target) == pytest.approx(1.0, abs=1e-9)
    assert lengths_m(batch.rows, 100.0) == pytest.approx(batch.lengths_m)
    assert batch.lengths_m.min() >= math.hypot(x - 30.0, y + 40.0) - 1e-6


def test_words_turn_as_their_letters_say():
    rows = words(Pose(0.0, 0.0, 0.3), np.array([[150.0, 90.0, 2.0]]), 100.0)[:, 0]
    for letters, row in zip(WORDS, rows, strict=True):
        if np.isnan(row[0]):
            continue
        middle = row[3] if letters[1] != "S" else 0.0
        for letter, turn in zip(letters, (row[1], middle, row[5]), strict=True):
            assert turn * {"L": 1.0, "R": -1.0, "S": 0.0}[letter] >= 0.0
        assert (row[2] > 0.0) == (letters[1] == "S")
