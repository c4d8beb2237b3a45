"""ArduPlane's lateral guidance, and what it does with missions."""

import math
from dataclasses import replace

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.guidance import L1Guidance, L1Parameters, Leg, PathFollower
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav, Wind

DATUM = Datum(37.8, -122.8)
ARDUPLANE = Uav(autopilot="arduplane", **AUTOPILOTS["arduplane"])


def autopilot(points, *, uav=ARDUPLANE, wind=None, params=(0.0, 0.0, 0.0, 0.0)):
    pilot = SimAutopilot(
        Pose(0.0, 0.0, 0.0),
        speed_mps=20.0,
        uav=uav,
        wind=wind or Wind(),
        datum=DATUM,
    )
    items = waypoint_items(np.array(points, dtype=float), DATUM, 150.0)
    pilot.load([replace(item, params=params) for item in items])
    pilot.set_current(1)
    pilot.set_mode(FlightMode.AUTO)
    return pilot


def run(pilot, seconds):
    track = []
    for _ in range(round(seconds / 0.05)):
        pilot.step(0.05)
        track.append((pilot.state.x_m, pilot.state.y_m))
    return np.array(track)


@pytest.mark.parametrize("wind", [Wind(), Wind(6.0, 0.0), Wind(6.0, 200.0)])
def test_a_leg_is_captured_and_held(wind):
    pilot = autopilot([(300.0, 100.0), (4000.0, 100.0)], wind=wind)
    track = run(pilot, 100.0)
    assert np.abs(track[-400:, 1] - 100.0).max() < 1.0


def test_arcs_are_flown_wide_by_what_the_law_says():
    """In a steady turn sin(Nu) = L1 / (K R share): many short legs are flown outside."""
    angles = np.linspace(0.0, 4.0 * np.pi, 121)[1:]
    circle = np.column_stack((500.0 + 100.0 * np.sin(angles), 100.0 - 100.0 * np.cos(angles)))
    pilot = autopilot([(500.0, 0.0), *circle], params=(0.0, 1.0, 0.0, 0.0))
    track = run(pilot, 60.0)
    radius = np.hypot(track[:, 0] - 500.0, track[:, 1] - 100.0)[-300:]
    parameters = L1Parameters()
    # Newton on V^2 / r = share K V^2 / L1 sin(asin((r - R) / L1)).
    wide = parameters.l1_m(20.0) ** 2 / (parameters.l1_gain * parameters.turn_share * radius.mean())
    assert radius.mean() - 100.0 == pytest.approx(wide, abs=3.0)


def test_loiter_is_wider_than_commanded_as_in_flight():
    track = run(autopilot([(500.0, 0.0)]), 200.0)
    radius = np.hypot(track[-800:, 0] - 500.0, track[-800:, 1])
    assert radius.mean() == pytest.approx(90.0, abs=4.0)
    (ax, ay), (bx, by) = track[-2:] - (500.0, 0.0)
    assert ax * by - ay * bx < 0.0


def test_a_leg_ends_wp_radius_before_a_right_angle():
    pilot = autopilot([(1000.0, 0.0), (1000.0, -1000.0)])
    while not pilot.reached:
        pilot.step(0.05)
    assert pilot.state.x_m == pytest.approx(950.0, abs=3.0)


def test_acceptance_of_an_item_takes_the_place_of_wp_radius():
    pilot = autopilot([(1000.0, 0.0), (1000.0, -1000.0)], params=(0.0, 10.0, 0.0, 0.0))
    while not pilot.reached:
        pilot.step(0.05)
    assert pilot.state.x_m == pytest.approx(990.0, abs=3.0)


def test_turn_at_a_doubled_waypoint_is_taken_towards_the_east():
    leg = Leg((0.0, 0.0), (100.0, 0.0), ((100.0, 0.0),))
    assert leg.turn_rad == 0.0
    assert Leg((0.0, 0.0), (0.0, 100.0), ((0.0, 100.0),)).turn_rad == pytest.approx(math.pi / 2)


def test_a_leg_made_current_runs_from_the_old_target_and_the_next_heads_for_its_end():
    pilot = autopilot([(1000.0, 0.0), (2000.0, 0.0)])
    run(pilot, 5.0)
    new = np.array([[1000.0, 200.0], [2000.0, 200.0], [3000.0, 200.0]])
    pilot.load(waypoint_items(new, DATUM, 150.0))
    pilot.set_current(1)
    # The line from the old target runs north: it is captured at 45 degrees, no more than that.
    track = run(pilot, 10.0)
    assert 80.0 < track[-1][1] < 150.0
    pilot.set_current(2)
    assert run(pilot, 80.0)[-1][1] == pytest.approx(200.0, abs=10.0)


def test_an_ideal_follower_ends_a_turn_to_the_side_it_was_begun_to():
    """Else a point straight behind, told every second a little aside, is never turned to."""
    follower = PathFollower(min_radius_m=75.0, lookahead_m=25.0, roll_lag_s=0.0)
    rates = []
    for side in (1.0, -1.0, 1.0, -1.0):
        leg = Leg((0.0, 0.0), (-300.0, 5.0 * side))
        rates.append(follower.along(leg, Motion(0.0, 0.0, 0.0, 20.0, 0.0), 20.0))
    assert rates == [pytest.approx(20.0 / 75.0)] * 4
    ahead = Leg((0.0, 0.0), (300.0, 0.0))
    assert follower.along(ahead, Motion(0.0, 0.0, 0.0, 20.0, 0.0), 20.0) == pytest.approx(0.0)
    right = Leg((0.0, 0.0), (-300.0, -5.0))
    assert follower.along(right, Motion(0.0, 0.0, 0.0, 20.0, 0.0), 20.0) < 0.0


def test_jump_leads_on():
    pilot = autopilot([(200.0, 0.0), (400.0, 0.0), (600.0, 0.0), (400.0, -400.0)])
    jump = replace(pilot.items[1], command=mavlink.MAV_CMD_DO_JUMP, params=(4.0, -1.0, 0.0, 0.0))
    pilot.replace_item(2, jump)
    run(pilot, 20.0)
    assert pilot.current == 4
    pilot.replace_item(5, replace(jump, params=(5.0, -1.0, 0.0, 0.0)))
    run(pilot, 60.0)
    assert pilot.mode is FlightMode.RTL


def test_roll_told_is_more_than_a_coordinated_turns():
    track = autopilot([(500.0, 0.0)])
    run(track, 100.0)
    turn = abs(track.state.turn_rate_radps) * track.state.airspeed_mps
    assert math.tan(track.roll_rad) == pytest.approx(turn / (9.80665 * 0.79))


def test_prevents_nothing_where_the_target_is_behind():
    guidance = L1Guidance(L1Parameters())
    pilot = autopilot([(-500.0, 10.0)])
    rate = guidance.along(Leg((0.0, 0.0), (-500.0, 10.0), tracked=False), pilot.motion, 20.0)
    assert abs(rate) > 0.1
