"""The airspeed asked of the autopilot."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.session.speed_command import SPEED_PERIOD_S, SPEED_STEP_MPS, SpeedCommand


def test_a_speed_is_asked_for_once():
    speed = SpeedCommand()
    assert speed.due(0.0) is None
    speed.wanted_mps = 21.0
    command = speed.due(0.0)
    assert command.number == mavlink.MAV_CMD_DO_CHANGE_SPEED
    assert command.params[:2] == (float(mavlink.SPEED_TYPE_AIRSPEED), 21.0)
    assert speed.due(10.0) is None


@pytest.mark.parametrize("wanted", [0.0, -3.0, float("nan")])
def test_what_is_no_speed_is_not_asked_for(wanted):
    speed = SpeedCommand()
    speed.wanted_mps = wanted
    assert speed.due(0.0) is None


def test_forgotten_it_is_asked_for_anew():
    speed = SpeedCommand()
    speed.wanted_mps = 21.0
    assert speed.due(0.0) is not None
    speed.forget()
    assert speed.due(5.0) is None
    speed.wanted_mps = 21.0
    assert speed.due(5.0) is not None


@given(st.lists(st.floats(10.0, 30.0), min_size=1, max_size=80))
def test_small_changes_and_many_are_kept_back(wanted):
    speed, sent = SpeedCommand(), []
    for tenth, one in enumerate(wanted):
        speed.wanted_mps = one
        command = speed.due(0.1 * tenth)
        if command is not None:
            sent.append((0.1 * tenth, command.params[1]))
    for (before_s, before), (after_s, after) in pairwise(sent):
        assert after_s - before_s >= SPEED_PERIOD_S - 1e-9
        assert abs(after - before) >= SPEED_STEP_MPS
