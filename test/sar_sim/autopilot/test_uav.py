"""The kinematic UAV, and the simulated autopilot that flies it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_planner.guidance.path_waypoints import path_waypoints
from sar_planner.parameters.corner import CornerParameters
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.guidance import lookahead_point
from sar_sim.autopilot.uav import UavLimits, UavState, ground_motion, step
from sar_sim.scenario.scenario import Uav, Wind

DATUM = Datum(37.8, -122.8)
LIMITS = UavLimits(80.0, 1.0, 0.0)
START = UavState(0.0, 0.0, 0.0, 0.0, 20.0)


def fly(state, seconds, **command):
    for _ in range(round(seconds / 0.05)):
        state = step(state, 0.05, **command)
    return state


def test_circle_is_exact():
    around = fly(START, 2 * math.pi * 5.0, turn_rate_radps=0.2, airspeed_mps=20.0, limits=LIMITS)
    assert math.hypot(around.x_m, around.y_m) < 1.0
    half = step(START, math.pi * 5.0, turn_rate_radps=0.2, airspeed_mps=20.0, limits=LIMITS)
    assert (half.x_m, half.y_m) == pytest.approx((0.0, 200.0), abs=1e-6)


@given(st.floats(-5.0, 5.0), st.floats(0.0, 60.0))
def test_turn_rate_and_acceleration_are_bounded(rate, speed):
    after = step(START, 0.1, turn_rate_radps=rate, airspeed_mps=speed, limits=LIMITS)
    assert abs(after.turn_rate_radps) <= 20.0 / 80.0 + 1e-12
    assert abs(after.airspeed_mps - 20.0) <= 0.1 + 1e-12


def test_roll_lag_is_first_order():
    lagged = LIMITS._replace(roll_lag_s=1.0)
    after = fly(START, 1.0, turn_rate_radps=0.2, airspeed_mps=20.0, limits=lagged)
    assert after.turn_rate_radps == pytest.approx(0.2 * (1 - math.exp(-1.0)), rel=1e-6)


def test_wind_carries_it():
    after = fly(
        START, 10.0, turn_rate_radps=0.0, airspeed_mps=20.0, limits=LIMITS, wind_mps=(0.0, 3.0)
    )
    assert (after.x_m, after.y_m) == pytest.approx((200.0, 30.0))
    assert ground_motion(after, (0.0, 3.0)).vy_mps == 3.0


def autopilot(*, uav=None, wind=None, at=None):
    return SimAutopilot(
        at or Pose(0.0, 0.0, 0.0),
        speed_mps=20.0,
        uav=uav or Uav(),
        wind=wind or Wind(),
        datum=DATUM,
    )


def run(pilot, seconds):
    track = []
    for _ in range(round(seconds / 0.05)):
        pilot.step(0.05)
        track.append((pilot.state.x_m, pilot.state.y_m))
    return np.array(track)


def load(pilot, points):
    pilot.load(waypoint_items(np.array(points, dtype=float), DATUM, 150.0))
    pilot.set_current(1)
    pilot.set_mode(FlightMode.AUTO)


@pytest.mark.parametrize("lag", [800.0, 300.0, 0.0, -200.0])
def test_ideal_uav_flies_the_planned_length(lag):
    parameters = CornerParameters()
    path = PaperAutomaton(parameters).plan(lag).path
    pilot = autopilot(at=path.start)
    beyond = path.end.offset(2000.0)
    load(pilot, [*path_waypoints(path, 10.0), (beyond.x_m, beyond.y_m)])
    track = run(pilot, path.length_m / 20.0)
    gap = path.end.along(*track[-1])
    assert gap == pytest.approx(0.0, abs=0.3)
    assert abs(path.end.across(*track[-1])) < 0.5


def test_guided_flies_straight_on_in_a_cross_wind():
    track = run(autopilot(wind=Wind(6.0, 0.0)), 60.0)
    assert np.abs(track[:, 1]).max() < 1.0


def test_a_mission_taken_in_auto_keeps_the_leg_until_it_is_made_current():
    pilot = autopilot()
    load(pilot, [(1000.0, 0.0), (2000.0, 0.0)])
    run(pilot, 5.0)
    pilot.load(waypoint_items(np.array([[1000.0, 500.0], [2000.0, 500.0]]), DATUM, 150.0))
    assert np.abs(run(pilot, 5.0)[:, 1]).max() < 0.5
    assert pilot.set_current(1)
    assert run(pilot, 20.0)[-1][1] > 50.0
    assert not pilot.set_current(9)


def test_list_ends_in_a_loiter():
    pilot = autopilot()
    load(pilot, [(500.0, 0.0)])
    track = run(pilot, 150.0)
    radius = np.hypot(track[-600:, 0] - 500.0, track[-600:, 1])
    assert pilot.mode is FlightMode.AUTO
    assert radius.min() > 60.0
    assert radius.max() < 130.0
    assert pilot.reached[0] == 1


def test_mission_without_a_loiter_ends_in_rtl():
    pilot = autopilot()
    items = waypoint_items(np.array([[300.0, 0.0]]), DATUM, 150.0)
    pilot.load(items[:-1])
    pilot.set_current(1)
    pilot.set_mode(FlightMode.AUTO)
    track = run(pilot, 120.0)
    assert pilot.mode is FlightMode.RTL
    assert math.hypot(*track[-1]) < 150.0
    assert items[-1].command == mavlink.MAV_CMD_NAV_LOITER_UNLIM


def test_auto_without_a_mission_is_refused():
    pilot = autopilot()
    pilot.set_mode(FlightMode.AUTO)
    assert pilot.mode is FlightMode.GUIDED


def test_lookahead_runs_around_corners():
    points = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0))
    assert lookahead_point(points, (8.0, 1.0), 5.0) == pytest.approx((10.0, 3.0))
    assert lookahead_point(points[1:], (10.0, 8.0), 5.0) == pytest.approx((10.0, 13.0))


def test_it_turns_no_tighter_than_told():
    autopilot = SimAutopilot(Pose(0.0, 0.0, 0.0), speed_mps=20.0, datum=DATUM)
    autopilot.turn_no_tighter(140.0)
    autopilot.set_mode(FlightMode.LOITER)
    rates = []
    for _ in range(400):
        autopilot.step(0.05)
        rates.append(abs(autopilot.state.turn_rate_radps))
    assert max(rates) == pytest.approx(20.0 / 140.0)
