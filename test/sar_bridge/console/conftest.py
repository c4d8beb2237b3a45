"""A graph as the console hears it, that is well until a test changes something."""

from dataclasses import replace

import numpy as np
import pytest

from sar_bridge.console.snapshot import Snapshot, Told
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import (
    Health,
    HelicopterReport,
    Mark,
    MonitorReport,
    UavReport,
    UavStatus,
    Uploaded,
    WaypointList,
)
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase

NODES = ("estimator", "planner", "monitor", "bridge", "record")
BRIDGE = {"heartbeat_age_s": "0.3", "airspeed_mps": "21.0", "battery_v": "24.1"}


def told(name, problem="", age_s=0.5, *, severe=False, **values):
    more = BRIDGE if name == "bridge" else {}
    return Told(Health(name, problem, more | values, severe=severe), age_s)


def formation():
    """Return a UAV in formation, everything as it should be."""
    track = np.column_stack((np.linspace(0.0, 3000.0, 100), np.zeros(100)))
    return Snapshot(
        now_s=100.0,
        datum=Datum(37.8, -122.8),
        helicopter=HelicopterReport(Motion(100.0, 3000.0, 0.0, 20.0, 0.0), 1.2, 0.1, 30.0),
        helicopter_age_s=0.2,
        uav=UavReport(Motion(100.0, 2990.0, -250.0, 20.0, 0.0), 0.0, 150.0),
        uav_age_s=0.1,
        phase=Phase.CRUISE,
        leg=LegEstimate(100.0, Pose(3000.0, 0.0, 0.0), 20.0, 1.0, 0.01, 0.1),
        waypoints=WaypointList(7, 99.0, np.array([[3200.0, -250.0], [5000.0, -250.0]])),
        uploaded=Uploaded(7, 2, 40.0),
        rule="leg",
        lag_m=10.0,
        lags_m=((1, 600.0), (2, 3.0)),
        status=UavStatus("AUTO", armed=True, connected=True, tracking_list=True),
        monitor=MonitorReport(thresholds={"min_separation_m": 200.0}),
        wind_mps=(3.0, -4.0),
        pattern=np.array([[3400.0, 0.0], [3400.0, -900.0], [2000.0, -900.0]]),
        marks=(Mark(1, 90.0, 2500.0, 400.0),),
        parameters={
            "FS_GCS_ENABL": 1.0,
            "FS_LONG_ACTN": 1.0,
            "FS_LONG_TIMEOUT": 10.0,
            "AIRSPEED_MIN": 12.0,
            "AIRSPEED_MAX": 30.0,
        },
        nodes={name: told(name) for name in NODES},
        tracks=(track, track - np.array([0.0, 250.0])),
        trend=np.column_stack((np.linspace(60.0, 0.0, 60), np.full(60, 250.0))),
    )


@pytest.fixture
def well():
    """A UAV in formation, everything as it should be."""
    return formation()


@pytest.fixture
def with_node():
    """Return a function that gives a snapshot with a node that tells something else."""

    def change(snapshot, name, *args, **options):
        return replace(snapshot, nodes={**snapshot.nodes, name: told(name, *args, **options)})

    return change


@pytest.fixture
def corner():
    covariance = np.array([[400.0, 0.0], [0.0, 100.0]])
    return CornerEstimate(100.0, Pose(3300.0, 0.0, 0.0), 120.0, 20.0, 1.0, covariance, 0.02, 1.0)
