"""Recorded ArduPlane flights against the simulated autopilot, and the planner's waypoints."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_planner.guidance.path_waypoints import path_waypoints
from sar_planner.paths.flight_path import FlightPath, Straight
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav, Wind
from sar_sim.trials.tracking import (
    CASES,
    DATUM,
    PLAIN,
    RecordingError,
    distances_m,
    fly_guided,
    fly_items,
    load_recording,
    measure,
    measured_path,
    path_points,
    refly,
    rms,
)
from sar_sim.trials.tracking_cli import ARDUPLANE, SETS, TUNINGS, main

ROOT = Path(__file__).parents[3]
DATA = Path(os.environ.get("SAR_TEST_DATA", ROOT.parent / "shared" / "data"), "arduplane")
recorded = pytest.mark.skipif(not DATA.is_dir(), reason=f"recorded flights: no {DATA}")


@recorded
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("name", SETS)
def test_simulated_autopilot_flies_as_the_recorded_one(name, case):
    """Uses the recorded flights: extra length within max(10 m, 15 %), track within 6 m."""
    uav, wind = SETS[name]
    recording = load_recording(DATA, f"{name}_{case}")
    flown = measure(recording.points, case)
    simulated = measure(refly(recording, case, uav=uav, wind=wind), case)
    assert abs(simulated.extra_m - flown.extra_m) <= max(10.0, 0.15 * abs(flown.extra_m))
    assert rms(distances_m(simulated.points, flown.points)) < 6.0


@recorded
def test_the_table_is_printed(capsys):
    """Uses the recorded ArduPlane flights."""
    assert main(["--data", str(DATA)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 2 + len(SETS) * len(CASES) + 1 + 1 + len(TUNINGS)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("name", TUNINGS)
def test_planners_waypoints_are_flown_as_planned(name, case):
    uav, wind = TUNINGS[name]
    flown = measure(fly_guided(case, uav=uav, wind=wind), case)
    assert abs(flown.extra_m) <= 15.0
    assert flown.off_m <= 3.0


@pytest.mark.parametrize("direction", [0.0, 90.0, 200.0, 300.0])
def test_waypoints_hold_in_any_wind(direction):
    uav = replace(ARDUPLANE, l1_period_s=12.0)
    flown = measure(fly_guided("C", uav=uav, wind=Wind(8.0, direction)), "C")
    assert abs(flown.extra_m) <= 15.0
    assert flown.off_m <= 3.0


@pytest.mark.parametrize("case", CASES)
def test_a_perfect_track_has_no_extra_length(case):
    path = measured_path(case)
    before = path.start.offset(-50.0)
    after = path.end.offset(50.0)
    points = np.vstack(((before.x_m, before.y_m), path_points(path), (after.x_m, after.y_m)))
    flown = measure(points, case)
    assert flown.extra_m == pytest.approx(0.0, abs=0.2)
    assert flown.off_m < 0.1


def test_a_track_that_breaks_off_is_not_measured():
    assert measure(path_points(measured_path("T1"))[:-100], "T1") is None


def test_unreadable_recordings_end_in_one_line(tmp_path, capsys):
    assert main(["--data", str(tmp_path)]) == 2
    assert "plane_default_40m_T3_waypoints.csv" in capsys.readouterr().err
    (tmp_path / "x_waypoints.csv").write_text("a,b\n1,2\n")
    with pytest.raises(RecordingError, match="expected columns"):
        load_recording(tmp_path, "x")


@pytest.mark.parametrize("case", ["T3", "C"])
def test_piccolo2005_on_arc_ends_flies_as_much_farther_as_the_papers_did(case):
    path = measured_path(case)
    start = path.start.offset(-400.0)
    whole = FlightPath.of(start, (Straight(400.0), *path.segments, Straight(600.0)))
    items = [
        replace(item, params=PLAIN)
        for item in waypoint_items(path_waypoints(whole, 0.0), DATUM, 150.0)
    ]
    uav = Uav(autopilot="piccolo2005", **AUTOPILOTS["piccolo2005"])
    flown = measure(fly_items(items, start, airspeed_mps=20.0, uav=uav, wind=Wind()), case)
    assert 300.0 < flown.extra_m < 550.0
