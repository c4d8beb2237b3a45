"""The monitor's prediction of a UAV that follows a list."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.arduplane.l1_predictor import STEP_S, FollowerTuning, Route, follow, motion_at_end
from sar_bridge.mavlink.mission_items import waypoint_items
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.presets import parameter_values
from sar_sim.scenario.scenario import Uav

DATUM = Datum(37.8, -122.8)
EAST = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
ARDUPLANE = Uav(autopilot="arduplane", roll_lag_s=0.35, speed_lag_s=3.5)
TUNING = FollowerTuning.read(parameter_values(ARDUPLANE))
LEG = np.array([[500.0, 0.0], [2000.0, 0.0]])
CORNER = np.array([[300.0, 0.0], [400.0, 20.0], [450.0, 100.0], [450.0, 700.0], [450.0, 2000.0]])
WEAVE = np.array([[200.0, 0.0], [350.0, 80.0], [600.0, 80.0], [750.0, 0.0], [2500.0, 0.0]])


def flown(points, seconds, step_s=0.05):
    """Return where the simulated ArduPlane flies, every ``STEP_S``."""
    pilot = SimAutopilot(Pose(0.0, 0.0, 0.0), speed_mps=20.0, datum=DATUM, uav=ARDUPLANE)
    pilot.load(waypoint_items(points, DATUM, 150.0))
    pilot.set_mode(FlightMode.AUTO)
    track = [(0.0, 0.0)]
    for i in range(1, round(seconds / step_s) + 1):
        pilot.step(step_s)
        if i % round(STEP_S / step_s) == 0:
            track.append((pilot.motion.x_m, pilot.motion.y_m))
    return np.array(track)


@pytest.mark.parametrize("points", [LEG, CORNER, WEAVE], ids=["leg", "corner", "weave"])
def test_the_prediction_is_what_arduplane_flies(points):
    path = follow(EAST, Route(points, EAST), tuning=TUNING, cruise_mps=20.0)
    off = np.hypot(*(path - flown(points, 60.0)).T)
    assert off[: round(20.0 / STEP_S)].max() < 5.0
    assert off.max() < 12.0


@pytest.mark.parametrize("points", [CORNER, WEAVE, CORNER[::-1].copy()])
@pytest.mark.parametrize("wind_mps", [(0.0, 0.0), (8.0, 0.0), (0.0, -9.0), (-6.0, 6.0)])
def test_the_prediction_bends_no_more_than_is_said(points, wind_mps):
    tuning = replace(TUNING, roll_limit_deg=30.0, slowest_mps=12.0)
    path = follow(EAST, Route(points, EAST), tuning=tuning, cruise_mps=24.0, wind_mps=wind_mps)
    bent = np.hypot(*np.diff(path, n=2, axis=0).T) / STEP_S**2
    # Its turn rate is limited by the speed before a step, which changes by up to 2.5 % in one.
    most = tuning.most_mps2(wind_mps)
    assert 0.3 * most < bent.max() <= 1.025 * most


def test_a_path_can_be_left_where_it_ends():
    """Followed in two pieces it is the same path, but for what its speed was rounded to."""
    route = Route(CORNER, EAST)
    whole = follow(EAST, route, tuning=TUNING, cruise_mps=20.0, horizon_s=20.0)
    first = follow(EAST, route, tuning=TUNING, cruise_mps=20.0, horizon_s=5.0 + STEP_S)
    at_5_s = motion_at_end(first, 5.0)
    assert (at_5_s.time_s, at_5_s.x_m, at_5_s.y_m) == (5.0, *first[-2])
    second = follow(at_5_s, route, tuning=TUNING, cruise_mps=20.0, horizon_s=15.0)
    assert np.vstack((first[:-2], second)) == pytest.approx(whole, abs=3.0)


def test_behind_the_list_it_loiters_clockwise():
    points = np.array([[300.0, 0.0]])
    path = follow(EAST, Route(points, EAST), tuning=TUNING, cruise_mps=20.0, horizon_s=120.0)
    late = path[round(60.0 / STEP_S) :] - points[0]
    assert np.hypot(*late.T) == pytest.approx(np.full(len(late), 80.0), abs=12.0)
    angles = np.unwrap(np.arctan2(late[:, 1], late[:, 0]))
    assert angles[-1] < angles[0] - 4.0


def test_its_speed_becomes_that_of_the_list():
    slow = Motion(0.0, 0.0, 0.0, 14.0, 0.0)
    path = follow(slow, Route(LEG, slow), tuning=TUNING, cruise_mps=20.0)
    steps = np.hypot(*np.diff(path, axis=0).T) / STEP_S
    assert steps[0] == pytest.approx(14.5)
    assert steps[20] == pytest.approx(20.0)


def test_a_list_is_entered_where_it_first_passes_the_uav():
    assert Route(LEG - (700.0, 0.0), EAST).target == 1
    assert Route(LEG, EAST).target == 0
    back = np.vstack((LEG - (700.0, 0.0), LEG[::-1] - (700.0, -30.0)))
    assert Route(back, EAST).target == 1


def test_a_list_that_begins_ahead_and_comes_back_is_flown_from_its_begin():
    angles = np.radians(np.arange(0.0, 360.0, 10.0) - 90.0)
    loop = np.column_stack((20.0 + 100.0 * np.cos(angles), 100.0 + 100.0 * np.sin(angles)))
    assert Route(np.vstack((loop, LEG)), EAST).target == 0


def test_a_first_point_flown_round_is_not_turned_back_for():
    points = np.array([[302.0, 538.0], [278.0, 560.0], [262.0, 584.0], [251.0, 608.0]])
    route = Route(points, Motion(0.0, 318.0, 554.4, -15.3, 10.2))
    route.advance(Motion(1.0, 300.0, 566.0, -14.0, 12.0))
    route.advance(Motion(2.0, 280.0, 580.0, -13.0, 13.0))
    assert route.target >= 2


def test_the_list_goes_on_with_the_uav():
    route = Route(CORNER, EAST)
    assert (route.target, route.begin) == (0, (0.0, 0.0))
    route.advance(Motion(20.0, 420.0, 45.0, 10.0, 17.0))
    assert (route.target, route.begin) == (2, (400.0, 20.0))
    route.advance(Motion(150.0, 450.0, 2300.0, 0.0, 20.0))
    assert route.target == len(CORNER)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({}, FollowerTuning()),
        ({"ROLL_LIMIT_DEG": 60.0, "NAVL1_PERIOD": 12.0}, FollowerTuning(12.0, roll_limit_deg=60.0)),
        ({"WP_LOITER_RAD": -60.0}, FollowerTuning(loiter_radius_m=-60.0)),
        ({"WP_LOITER_RAD": 0.0}, FollowerTuning()),
        ({"NAVL1_PERIOD": 0.0}, FollowerTuning()),
        ({"NAVL1_DAMPING": math.nan}, FollowerTuning()),
        ({"ROLL_LIMIT_DEG": 90.0}, FollowerTuning()),
    ],
)
def test_the_autopilots_parameters(values, expected):
    assert FollowerTuning.read(values) == expected


@given(
    st.lists(
        st.tuples(st.floats(-3000.0, 3000.0), st.floats(-3000.0, 3000.0)), min_size=0, max_size=6
    ),
    st.floats(-30.0, 30.0),
    st.floats(-30.0, 30.0),
    st.floats(5.0, 35.0),
)
def test_any_list_is_followed_at_a_possible_speed(points, vx, vy, cruise):
    uav = Motion(0.0, 0.0, 0.0, vx, vy)
    route = Route(np.array(points).reshape(-1, 2), uav)
    path = follow(uav, route, tuning=TUNING, cruise_mps=cruise, horizon_s=30.0)
    assert path.shape == (61, 2)
    assert np.isfinite(path).all()
    fastest = max(uav.speed_mps, cruise, TUNING.slowest_mps, 1.0)
    assert np.hypot(*np.diff(path, axis=0).T).max() <= fastest * STEP_S + 1e-9


def test_without_a_cruise_speed_the_airspeed_is_kept():
    """Ground speed with the wind, against it and across it (the wind triangle)."""
    uav = Motion(0.0, 0.0, 0.0, 26.0, 0.0)  # 20 m/s through the air, 6 m/s behind
    for end, speed in (
        ((9000.0, 0.0), 26.0),
        ((-9000.0, 0.0), 14.0),
        ((0.0, 9000.0), math.sqrt(20.0**2 - 6.0**2)),
    ):
        route = Route(np.array([end]), uav)
        path = follow(uav, route, tuning=TUNING, cruise_mps=None, wind_mps=(6.0, 0.0))
        assert np.hypot(*(path[-1] - path[-2])) == pytest.approx(speed * STEP_S, abs=0.2)


def test_a_wind_stronger_than_the_airspeed_does_not_stop_the_prediction():
    uav = Motion(0.0, 0.0, 0.0, 2.0, 0.0)
    route = Route(np.array([[-3000.0, 0.0]]), uav)
    path = follow(uav, route, tuning=TUNING, cruise_mps=None, wind_mps=(25.0, 5.0))
    assert np.isfinite(path).all()


def test_an_autopilot_without_l1_guidance_flies_the_polygon():
    angles = np.radians(np.arange(-90.0, 91.0, 6.0))
    arc = np.column_stack((400.0 + 100.0 * np.cos(angles), 100.0 + 100.0 * np.sin(angles)))
    points = np.vstack(([[400.0, 0.0]], arc, [[-2000.0, 200.0]]))
    path = follow(EAST, Route(points, EAST), tuning=FollowerTuning.read({}), cruise_mps=20.0)
    turning = path[path[:, 0] > 401.0]
    radii = np.hypot(*(turning - (400.0, 100.0)).T)
    assert radii == pytest.approx(np.full(len(turning), 100.0), abs=8.0)
    assert path[-1, 1] == pytest.approx(200.0, abs=3.0)
