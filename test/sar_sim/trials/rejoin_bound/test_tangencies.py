"""What is left from contacts with the disc, and the bound by them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_planner.paths.dubins import lengths_m, words
from sar_planner.paths.slot_intercept import radii_m
from sar_planner.prediction.forecast import cornering, cruising, departing
from sar_planner.rejoin.rejoin import RejoinTask, rejoin
from sar_sim.trials.rejoin_bound.around import Limits
from sar_sim.trials.rejoin_bound.bound import lower_bound_s, unhindered_s
from sar_sim.trials.rejoin_bound.dubins_legs import first_clear_s
from sar_sim.trials.rejoin_bound.tangencies import (
    WORD_STEP_S,
    _Moving,
    _reached,
    clear_word_s,
    contacts_of,
    hindered_s,
    tangent_headings,
)

LIMITS = Limits(20.0, 18.0, 22.0, 100.0, 250.0, 205.0)
LEG = Pose(0.0, 250.0, 0.0)


def PROOF(test):  # noqa: N802
    """Mark what solves the whole grid of contacts first."""
    return pytest.mark.proof(pytest.mark.timeout(600)(test))


CRUISE = cruising(0.0, LEG, 20.0)
BEFORE_CRUISE = (
    departing(5.0, LEG, 0.0, speed_mps=20.0, accel_mps2=2.5),
    cornering(-3.0, Pose(0.0, 250.0, math.pi / 2.0), speed_mps=20.0, accel_mps2=2.5),
)


def task(x, y, heading_deg, forecast=CRUISE):
    """``x``: ahead of the slot."""
    start = Pose(x + forecast.slot_x_m(0.0), y, math.radians(heading_deg))
    return RejoinTask(start, 0.0, (forecast,), 100.0, 18.0, 22.0, 205.0)


def test_tangent_headings_neither_near_nor_leave_the_helicopter():
    angles = np.linspace(-3.0, 3.0, 13)
    velocities = np.tile((12.0, -5.0), (13, 1))
    headings = tangent_headings(angles, velocities, LIMITS)
    speeds = np.array((18.0, 22.0, 18.0, 22.0))
    normal = np.stack((np.cos(angles), np.sin(angles)))[:, :, None]
    radial = (speeds * np.cos(headings) - velocities[:, :1]) * normal[0]
    radial += (speeds * np.sin(headings) - velocities[:, 1:]) * normal[1]
    assert radial == pytest.approx(np.zeros((13, 4)), abs=1e-9)


def test_a_word_that_nothing_is_in_the_way_of_is_clear():
    asked = task(500.0, -300.0, -120.0)
    free = unhindered_s(asked)
    assert clear_word_s(asked, 200.0) == pytest.approx(free, abs=2.0 * WORD_STEP_S)
    assert clear_word_s(asked, free - 1.0) == math.inf


def test_a_hop_waits_until_its_word_is_clear():
    # 400 m straight on, the pose moving with the slot at 20 m/s in the same direction.
    seen = np.array([[40.0, 0.0, 0.0, 0.0]])
    met = np.array([20.0])
    high = np.array([60.0])

    def first_s(x, y, vx):
        """With a helicopter that begins at x, y and flies with vx along x."""
        table = np.array((0.0, x, y, 1.0, 0.0, vx, 0.0)).reshape(1, 7, 1)
        return first_clear_s(seen, met, high, table, 0.0, (20.0, 18.0, 22.0), radii_m(100.0), 203.0)

    assert first_s(1e4, 1e4, 0.0) == pytest.approx(met)
    assert first_s(0.0, 100.0, 20.0) == math.inf
    # It stands behind, and is not in the way.
    assert first_s(-400.0, 150.0, 0.0) == pytest.approx(met)


def test_contacts_behind_the_disc_are_reached_around_it_only():
    # 500 m before its upper edge, along it: 822 m around a quarter of it, less through it.
    stands = departing(50.0, LEG, 0.0, speed_mps=20.0, accel_mps2=2.5)
    asked = replace(task(0.0, 0.0, 0.0, stands), start=Pose(500.0, 455.0, math.pi))
    steps = np.arange(11)
    angles = math.pi / 2.0 * (1.0 + steps / 10.0)
    touched = np.column_stack(
        (205.0 * np.cos(angles), 250.0 + 205.0 * np.sin(angles), angles + math.pi / 2.0)
    )
    there, times = np.vstack((touched, touched[-1:])), np.append(26.0 + 1.5 * steps, 36.0)
    shortest = np.nanmin(lengths_m(words(asked.start, there, 100.0), 100.0), axis=0)
    assert (shortest <= 22.0 * times).all()
    poses = there - np.outer(stands.slot_x_m(0.0) + 20.0 * times, (1.0, 0.0, 0.0))
    moving = _Moving(times, poses, np.zeros(12))
    assert _reached(asked, LIMITS, moving).tolist() == [True] * 11 + [False]


@pytest.fixture(scope="module")
def contacts():
    return contacts_of(LIMITS)


@PROOF
def test_no_plan_from_a_contact_is_sooner_than_what_is_left(contacts):
    checked = 0
    for index in range(0, len(contacts.poses), 37):
        x, y, heading = contacts.poses[index]
        asked = task(x, y, math.degrees(heading))
        # A contact has no room for what the planner keeps for its sampling.
        plan = rejoin(replace(asked, separation_m=203.0))
        if plan is not None and plan.kept:
            checked += 1
            assert contacts.left_s[index] <= plan.duration_s
    assert checked >= 2


@pytest.mark.parametrize(
    ("x", "y", "heading_deg"),
    [(373.0, -182.0, 45.0), (541.0, -147.0, 48.0), (605.0, 509.0, 165.0), (150.0, 600.0, -90.0)],
)
@PROOF
@pytest.mark.parametrize("forecast", [CRUISE, *BEFORE_CRUISE])
def test_no_plan_is_sooner_than_the_bound(x, y, heading_deg, forecast):
    asked = task(x, y, heading_deg, forecast)
    plan = rejoin(asked)
    assert plan.kept
    # Looked for beyond what the plan takes, so that it could be exceeded.
    assert lower_bound_s(asked, 1.2 * plan.duration_s) <= plan.duration_s


@PROOF
def test_the_way_round_is_known_from_ahead_of_the_slot(contacts):
    asked = task(373.0, -182.0, 45.0)
    plan = rejoin(asked)
    assert unhindered_s(asked) < 0.85 * plan.duration_s
    assert hindered_s(asked, contacts, plan.duration_s) > 0.95 * plan.duration_s
