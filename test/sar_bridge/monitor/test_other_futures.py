"""Another UAV in the same layer is kept apart from as the helicopter is."""

import math

import numpy as np
import pytest

from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.parameters import MonitorParameters
from sar_bridge.monitor.separation_monitor import SeparationMonitor
from sar_estimator.common.other_uavs import OtherUavs
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import UavReport, Uploaded, WaypointList
from sar_estimator.common.states import LegEstimate, Motion, Phase

NORTH = 0.5 * math.pi
NOW = 100.0


def monitor_of(other, *, altitude_m=150.0, points=None):
    """Return a monitor: the UAV flies north, 250 m right of a helicopter that does so too.

    ``other``: the motion of another UAV, at ``altitude_m``; ``points``: the list that it flies.
    """
    told = OtherUavs(["uav2"])
    monitor = SeparationMonitor(MonitorParameters(), HelicopterModel(), told)
    monitor.helicopter.set_motion(Motion(NOW, 0.0, 0.0, 0.0, 20.0), 3.0, 0.1)
    monitor.helicopter.set_leg(LegEstimate(NOW, Pose(0.0, 0.0, NORTH), 20.0, 1.0, 0.01, 0.1))
    monitor.helicopter.set_phase(Phase.CRUISE)
    monitor.set_altitudes(150.0, 100.0)
    monitor.set_uav(Motion(NOW, 250.0, 0.0, 0.0, 20.0))
    if points is not None:
        told.inputs["/uav2/uav/cleared"](WaypointList(1, NOW, points), NOW)
        told.inputs["/uav2/uav/uploaded"](Uploaded(1, len(points)), NOW)
    told.inputs["/uav2/uav/odometry"](UavReport(other, NORTH, altitude_m), NOW)
    return monitor


def passes(monitor):
    return monitor.passes(np.array([(250.0, 300.0), (250.0, 4000.0)]), 7, NOW)


BESIDE = Motion(NOW, 500.0, 0.0, 0.0, 20.0)
ACROSS = Motion(NOW, 700.0, 400.0, -20.0, 0.0)


def test_one_beside_it_is_no_obstacle():
    assert passes(monitor_of(BESIDE))


def test_one_that_comes_across_is_and_the_refusal_names_it():
    monitor = monitor_of(ACROSS)
    assert not passes(monitor)
    assert "if uav2 flies on" in monitor.reason


@pytest.mark.parametrize(("above_m", "free"), [(29.0, False), (31.0, True), (-31.0, True)])
def test_another_layer_needs_nothing_else(above_m, free):
    assert passes(monitor_of(ACROSS, altitude_m=150.0 + above_m)) is free


def test_what_it_flies_is_its_list_and_not_straight_on():
    away = np.array([(650.0, 400.0), (700.0, 900.0), (700.0, 4000.0)])
    assert passes(monitor_of(ACROSS, points=away))
    towards = np.array([(500.0, 300.0), (250.0, 600.0), (250.0, 4000.0)])
    assert not passes(monitor_of(BESIDE, points=towards))


def test_a_list_that_leads_to_another_uav_is_left_by_an_escape():
    monitor = monitor_of(Motion(NOW, 250.0, 450.0, 0.0, -20.0))
    monitor.set_flown(np.array([(250.0, 300.0), (250.0, 4000.0)]))
    escape = monitor.update(NOW)
    assert escape is not None
    assert "uav2" in monitor.reason
