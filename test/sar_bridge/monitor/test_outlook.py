"""What the monitor knows and predicts of both aircraft."""

import math

import numpy as np
import pytest

from sar_bridge.arduplane.l1_predictor import STEP_S, FollowerTuning, Route
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.outlook import NO_APPROACH, Outlook
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.states import Motion, Phase

AHEAD = np.array([[4000.0, -250.0]])


def known():
    outlook = Outlook(MonitorParameters(), HelicopterModel(20.0, 2.5, 1))
    outlook.helicopter.phase = Phase.CRUISE
    outlook.helicopter.set_motion(Motion(100.0, 0.0, 0.0, 20.0, 0.0), 1.0, 0.1)
    outlook.set_uav(Motion(100.0, 0.0, -250.0, 20.0, 0.0))
    return outlook


def test_what_was_never_seen_or_is_old_is_named():
    outlook = Outlook(MonitorParameters(), HelicopterModel())
    assert outlook.unseen
    assert outlook.unknown(0.0) == "no helicopter position"
    outlook = known()
    assert not outlook.unseen
    assert outlook.unknown(100.0) == ""
    assert outlook.unknown(103.5) == "helicopter position 3.5 s old (limit 3 s)"


def test_a_wind_that_is_no_number_is_not_taken():
    outlook = known()
    outlook.set_wind((3.0, -2.0))
    outlook.set_wind((math.nan, 0.0))
    assert outlook.wind_mps == (3.0, -2.0)


@pytest.mark.parametrize("late_s", [0.0, 1.0, 2.0])
def test_a_path_begins_where_the_uav_is_now(late_s):
    outlook = known()
    route = Route(AHEAD, outlook.uav)
    path = outlook.path(route, 100.0 + late_s, 20.0, is_flown=True, escaping=False)
    assert path[0] == pytest.approx((20.0 * late_s, -250.0), abs=0.5)
    assert len(path) == round(20.0 / STEP_S) + 1


def test_a_lists_own_speed_is_believed_near_the_helicopters():
    outlook = known()
    reached = {}
    for speed in (None, 22.0, 30.0):
        route = Route(AHEAD, outlook.uav, speed_mps=speed)
        path = outlook.path(route, 100.0, 40.0, is_flown=False, escaping=False)
        reached[speed] = path[-1, 0]
    assert reached[22.0] > reached[None] + 30.0
    assert reached[30.0] == reached[None]


def test_the_closest_approach_says_how_near_when_and_to_what():
    outlook = known()
    futures = outlook.futures(100.0)
    path = outlook.path(Route(AHEAD, outlook.uav), 100.0, 40.0, is_flown=True, escaping=False)
    near = outlook.apart(path, futures)
    found = outlook.closest(near, 0.0, 40.0)
    assert found.distance_m <= outlook.closest(near, 0.0, 40.0, only_likely=True).distance_m
    assert f"{found.distance_m:.0f} m in" in str(found)
    assert outlook.closest([], 0.0, 40.0) is NO_APPROACH
    assert outlook.closest(near, -2.0, 40.0).distance_m < found.distance_m


@pytest.mark.parametrize(("wind_x", "uav_mps", "matched"), [(12.0, 22.0, True), (0.0, 26.0, False)])
def test_one_that_flies_as_near_to_the_speed_as_its_airspeeds_allow_is_led(
    wind_x, uav_mps, matched
):
    """In a wind from behind 22 m/s are the least: it is not taken to keep its airspeed."""
    outlook = known()
    outlook.tuning = FollowerTuning(slowest_mps=10.0, fastest_mps=30.0)
    outlook.set_wind((wind_x, 0.0))
    for time_s in range(101, 160):
        outlook.set_uav(Motion(float(time_s), uav_mps * (time_s - 100), -250.0, uav_mps, 0.0))
    uav = outlook.uav
    outlook.helicopter.set_motion(Motion(159.0, uav.x_m, 0.0, 20.0, 0.0), 1.0, 0.1)
    route = Route(np.array([[uav.x_m + 200.0, -250.0], [uav.x_m + 200.0, -4000.0]]), uav)
    path = outlook.path(route, 159.0, 40.0, is_flown=True, escaping=False)
    across_mps = np.abs(np.diff(path[-6:, 1])).mean() / STEP_S
    # Across the wind it is led to 20 m/s over ground; one that keeps its airspeed flies that.
    assert across_mps == pytest.approx(20.0 if matched else uav_mps, abs=1.0)


@pytest.mark.parametrize(("late_s", "begun"), [(0.5, False), (1.4, False), (3.0, True)])
def test_where_fixes_come_late_it_may_have_begun_to_stop_since(late_s, begun):
    outlook = known()
    fresh = {one.name: one for one in outlook.futures(100.0)}
    outlook.timing.hear_fix(100.0 - late_s)
    outlook.timing.use(100.0)
    late = {one.name: one for one in outlook.futures(100.0)}
    assert set(fresh) <= set(late)
    assert ("stops unseen" in late) is begun
    if begun:
        unseen, stops = late["stops unseen"], late["stops"]
        assert not unseen.likely
        # So much earlier, it stands as much farther back.
        assert stops.positions[-1, 0] - unseen.positions[-1, 0] == pytest.approx(20.0 * late_s)
        assert (unseen.sigma_m >= stops.sigma_m).all()


def test_one_whose_gps_is_lost_has_such_futures_already():
    outlook = known()
    outlook.timing.hear_fix(97.0)
    outlook.timing.use(100.0)
    outlook.helicopter.phase = Phase.LOST
    names = [one.name for one in outlook.futures(100.0)]
    assert "goes on unseen" not in names
