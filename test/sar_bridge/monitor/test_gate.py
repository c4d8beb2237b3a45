"""The gate by itself: what a list is refused for."""

import math

import numpy as np
import pytest

from sar_bridge.arduplane.l1_predictor import Route
from sar_bridge.monitor.gate import FARTHEST_M, Gate, Offered
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.outlook import Outlook
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.states import Motion, Phase

SLOT = np.array([[800.0, -250.0], [4000.0, -250.0], [4300.0, -280.0]])
CROSSING = np.array([[500.0, 0.0], [500.0, 3000.0]])


def known(uav_y=-250.0, **changes):
    parameters = MonitorParameters(**changes)
    outlook = Outlook(parameters, HelicopterModel(20.0, 2.5, 1))
    outlook.helicopter.phase = Phase.CRUISE
    outlook.helicopter.set_motion(Motion(100.0, 0.0, 0.0, 20.0, 0.0), 1.0, 0.1)
    outlook.set_uav(Motion(100.0, 0.0, uav_y, 20.0, 0.0))
    return Gate(parameters, outlook), outlook


def refusal(gate, points, *, flown=None, escaping=False, now_s=100.0):
    return gate.refusal(Offered(points, None), now_s, flown=flown, escaping=escaping)


def test_a_list_beside_passes_and_one_across_does_not():
    gate, _ = known()
    assert refusal(gate, SLOT) == ""
    assert "m in" in refusal(gate, CROSSING)


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        (np.empty((0, 2)), "without waypoints"),
        (np.array([[math.nan, 0.0]]), "not within"),
        (np.array([[2.0 * FARTHEST_M, 0.0]]), "not within"),
    ],
)
def test_what_is_no_list_is_refused_whatever_is_known(points, reason):
    gate, _ = known()
    assert reason in refusal(gate, points)


def test_nothing_passes_while_the_uav_is_sent_away_or_a_position_is_old():
    gate, outlook = known()
    assert "being sent away" in refusal(gate, SLOT, escaping=True)
    assert "4.0 s old" in refusal(gate, SLOT, now_s=104.0)
    outlook.helicopter.phase = Phase.LOST
    assert "GPS lost" in refusal(gate, SLOT)


def test_too_near_already_what_is_better_passes():
    gate, outlook = known(uav_y=-150.0)
    nearer = np.array([[400.0, -60.0], [4000.0, -60.0]])
    flown = Route(nearer, outlook.uav)
    assert refusal(gate, nearer, flown=flown)
    held = np.array([[800.0, -160.0], [4000.0, -160.0]])
    assert refusal(gate, held, flown=flown) == ""
