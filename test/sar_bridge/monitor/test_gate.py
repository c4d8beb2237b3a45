"""The gate by itself: what a list is refused for."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.arduplane.l1_predictor import STEP_S, Route
from sar_bridge.monitor.gate import FARTHEST_M, SAME_M, Gate, Judged, Offered
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.outlook import ClosestApproach, Outlook
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


@pytest.mark.parametrize("uav_y", [-120.0, -150.0, -175.0])
def test_too_near_already_what_leads_away_passes_though_it_begins_as_near(uav_y):
    gate, outlook = known(uav_y=uav_y)
    stays = np.array([[800.0, uav_y], [4000.0, uav_y]])
    away = np.array([[300.0, -450.0], [4000.0, -450.0]])
    flown = Route(stays, outlook.uav)
    futures = outlook.futures(100.0)
    ahead = gate._judged(gate._path(Offered(away, None), 100.0, flown), futures)
    assert ahead.nearest.distance_m < 200.0
    assert refusal(gate, away, flown=flown) == ""
    assert refusal(gate, away) == ""
    assert "m in" in refusal(gate, stays, flown=flown)


NEAR_M = st.floats(0.0, 200.0)


@given(NEAR_M, st.floats(0.0, 50.0), NEAR_M, st.floats(0.0, 50.0))
def test_of_two_lists_at_most_one_is_better_and_it_comes_no_nearer(near, short, other, less):
    one = Judged(ClosestApproach(near, 0.0, ""), short)
    two = Judged(ClosestApproach(other, 0.0, ""), less)
    assert not (one.is_better(two, 5.0) and two.is_better(one, 5.0))
    if one.is_better(two, 5.0):
        assert near >= other - SAME_M


def make_late(outlook, late_s, now_s=100.0):
    """Have a list taken so long to the autopilot."""
    outlook.timing.give(1, now_s - late_s)
    outlook.timing.flown(1, now_s)


@pytest.mark.parametrize("late_s", [2.0, 3.0, 5.0])
def test_a_list_that_will_be_flown_late_is_looked_at_from_where_the_uav_will_be_then(late_s):
    """The UAV flies towards the helicopter's track, and the list turns it away in time, or not."""
    toward = np.array([[300.0, 0.0], [2000.0, 900.0]])
    away = np.array([[150.0, -500.0], [2000.0, -900.0]])
    gate, outlook = known(uav_y=-260.0)
    outlook.set_uav(Motion(100.0, 0.0, -260.0, 15.0, 13.0))
    flown = Route(toward, outlook.uav)
    soon = gate._path(Offered(away, None), 100.0, flown)
    make_late(outlook, late_s)
    assert outlook.late_s(100.0) == late_s - 1.0
    late = gate._path(Offered(away, None), 100.0, flown)
    assert len(late) == len(soon)
    held = outlook.path(flown, 100.0, late_s, is_flown=True, escaping=False)
    count = round((late_s - 1.0) / STEP_S)
    assert late[: count + 1] == pytest.approx(held[: count + 1], abs=0.01)
    assert late[:, 1].max() > soon[:, 1].max() + 5.0 * (late_s - 1.0)


def test_a_way_across_passes_where_lists_come_soon_and_is_refused_where_they_come_late():
    """A slow UAV crosses ahead of the helicopter, which comes nearer meanwhile."""
    gate, outlook = known()
    outlook.set_uav(Motion(100.0, 560.0, -250.0, 12.0, 0.0))
    flown = Route(np.array([[1300.0, -250.0], [4000.0, -250.0]]), outlook.uav)
    across = np.array([[620.0, 400.0], [620.0, 3000.0]])
    assert refusal(gate, across, flown=flown) == ""
    make_late(outlook, 5.0)
    assert "if the helicopter goes on" in refusal(gate, across, flown=flown)
