"""Recordings of any folder, and the recorded ArduPlane flights against the simulated autopilot."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_planner.guidance.path_waypoints import path_waypoints
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import FlightPath, Straight
from sar_planner.rules.paper_rules import Rule, build
from sar_sim.scenario.scenario import Wind
from sar_sim.trials.recordings import (
    PLAIN,
    RecordingError,
    load_recording,
    names_in,
    refly,
)
from sar_sim.trials.tracking import CASES, DATUM, Case, distances_m, fly_items, measure, rms
from sar_sim.trials.tracking_cli import ARDUPLANE, TUNINGS, compare, main

ROOT = Path(__file__).parents[3]
DATA = Path(os.environ.get("SAR_TEST_DATA", ROOT.parent / "shared" / "data"), "arduplane")
recorded = pytest.mark.skipif(not DATA.is_dir(), reason=f"recorded flights: no {DATA}")

PATHS = {
    "T3": {"rule": "T3", "lag_m": 0},
    "T1": {"rule": "T1", "lag_m": 700},
    "C": {"rule": "C", "lag_m": 250, "straight_m": 108, "theta_deg": 72},
}
SETS = {
    "plane_default_40m": {},
    "l1period10_40m": {"uav": {"l1_period_s": 10}},
    "l1period10_40m_wind6": {
        "uav": {"l1_period_s": 10},
        "wind": {"speed_mps": 6, "from_deg": 45},
    },
    "plane_default_arc_ends_only": {},
}
NAMES = [f"{name}_{case}" for name in SETS for case in PATHS]
SMALL = {
    "path": {"rule": "T3", "lag_m": 10},
    "corner": {"turn_radius_m": 120, "spacing_m": 300},
    "uav": {"l1_period_s": 11, "roll_lag_s": 0.5},
    "wind": {"speed_mps": 5, "from_deg": 200},
    "run_in_m": 250,
    "finish_m": 1000,
}


@pytest.fixture(scope="module")
def flights(tmp_path_factory):
    """A folder of links to the recorded flights, with their YAML files."""
    folder = tmp_path_factory.mktemp("recordings")
    for path in DATA.glob("*.csv"):
        (folder / path.name).symlink_to(path)
    for name, said in SETS.items():
        for case, path in PATHS.items():
            (folder / f"{name}_{case}.yaml").write_text(yaml.safe_dump({"path": path, **said}))
    return folder


def write(folder, name, document, points=None, waypoints=None):
    """Write a recording; a track and a mission of four straight points where none are given."""
    (folder / f"{name}.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    if waypoints is None:
        waypoints = [(-500.0 + 100.0 * i, -250.0) for i in range(4)]
    if points is None:
        points = waypoints
    rows = [f"{i},{x:.3f},{y:.3f},1" for i, (x, y) in enumerate(waypoints)]
    (folder / f"{name}_waypoints.csv").write_text(
        "\n".join(["seq,x_m,y_m,on_planned_path", *rows]) + "\n"
    )
    points = np.asarray(points)
    steps = np.gradient(points, axis=0)
    courses, speeds = np.arctan2(steps[:, 1], steps[:, 0]), np.hypot(*steps.T) / 0.05
    rows = [
        f"{0.05 * i:.2f},{x:.4f},{y:.4f},{course:.5f},{speed:.4f}"
        for i, ((x, y), course, speed) in enumerate(zip(points, courses, speeds, strict=True))
    ]
    (folder / f"{name}_track.csv").write_text(
        "\n".join(["t_s,x_m,y_m,course_rad,groundspeed_mps", *rows]) + "\n"
    )


@recorded
@pytest.mark.parametrize("name", NAMES)
def test_simulated_autopilot_flies_as_the_recorded_one(name, flights):
    """Uses the recorded flights: extra length within max(10 m, 15 %), track within 6 m."""
    recording = load_recording(flights, name)
    flown = measure(recording.points, recording.case)
    simulated = measure(refly(recording), recording.case)
    assert abs(simulated.extra_m - flown.extra_m) <= max(10.0, 0.15 * abs(flown.extra_m))
    assert rms(distances_m(simulated.points, flown.points)) < 6.0


@recorded
def test_the_table_of_recorded_flights_is_printed(capsys, flights):
    """Uses the recorded ArduPlane flights."""
    assert main(["--data", str(flights)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[2 : 2 + len(NAMES)]] == sorted(NAMES)
    assert len(lines) == 2 + len(NAMES) + 1 + 1 + len(TUNINGS)


def test_what_is_said_is_what_is_flown_with(tmp_path):
    write(tmp_path, "mine", SMALL)
    write(tmp_path, "plain", {"path": PATHS["C"]})
    mine, plain = (load_recording(tmp_path, name) for name in names_in(tmp_path))
    p = CornerParameters(turn_radius_m=120.0, spacing_m=300.0)
    assert mine.case == Case(build(Rule.T3, 10.0, p).path, 300.0, 250.0, 1000.0)
    assert (mine.uav.l1_period_s, mine.uav.roll_lag_s, mine.uav.speed_lag_s) == (11.0, 0.5, 3.5)
    assert mine.wind == Wind(5.0, 200.0)
    assert (plain.case, plain.uav, plain.wind) == (CASES["C"], ARDUPLANE, Wind())


def test_the_simulated_autopilots_own_flight_is_flown_again_as_it_was(tmp_path):
    """Of another geometry, in wind, on plain waypoints: recorded and flown again are the same."""
    write(tmp_path, "mine", SMALL)
    case = load_recording(tmp_path, "mine").case
    start = case.measured.start.offset(-1200.0)
    whole = FlightPath.of(start, (Straight(1200.0), *case.measured.segments, Straight(600.0)))
    waypoints = path_waypoints(whole, 40.0)
    uav = load_recording(tmp_path, "mine").uav
    items = waypoint_items(waypoints, DATUM, 150.0)
    points = fly_items(
        [replace(item, params=PLAIN) for item in items],
        start,
        airspeed_mps=20.0,
        uav=uav,
        wind=Wind(5.0, 200.0),
        finish_m=case.finish_m,
    )
    write(tmp_path, "mine", SMALL, points, waypoints)
    name, *figures = compare(tmp_path)[2].split()
    assert name == "mine"
    extra, again, difference, _, _, apart = map(float, figures)
    assert extra > 5.0
    assert difference == pytest.approx(again - extra, abs=0.11)
    assert abs(difference) < 2.0
    assert apart < 1.0
    # With another period it is not: what the YAML file says is what is flown.
    write(tmp_path, "mine", SMALL | {"uav": {"l1_period_s": 20}}, points, waypoints)
    assert float(compare(tmp_path)[2].split()[3]) > 10.0


@pytest.mark.parametrize(
    ("changed", "what"),
    [
        ({"path": {"rule": "T5", "lag_m": 0}}, "path.rule = 'T5': expected"),
        ({"path": {"rule": "T3"}}, "path.lag_m: missing"),
        ({"path": {"rule": "C", "lag_m": 0}}, "path.straight_m = None: expected a number"),
        (
            {"path": {"rule": "T1", "lag_m": 700, "theta_deg": 9}},
            "path.theta_deg = 9.0: expected none with rule T1",
        ),
        ({"path": {"rule": "T3", "lag_m": 900}}, "expected|reaches|too early"),
        ({"corner": {"turn_radius_m": -1}}, "corner.turn_radius_m = -1: expected more than 0"),
        ({"uav": {"l1_period_s": "slow"}}, "uav.l1_period_s = 'slow': expected a number"),
        ({"uav": {"lag_m": 3}}, "uav.lag_m: unknown key, expected one of autopilot"),
        ({"uav": {"autopilot": "ideal"}}, "uav.autopilot = 'ideal': expected arduplane or"),
        ({"wind": {"gust_sigma_mps": 1}}, "wind.gust_sigma_mps: unknown key, expected one of"),
        ({"wind": {"speed_mps": -1}}, "wind.speed_mps = -1: expected 0 or more"),
        ({"finish_m": 300}, "finish_m = 300: expected more than"),
        ({"winds": {}}, "winds: unknown key, expected one of path"),
    ],
)
def test_what_a_yaml_file_says_wrong_is_told_in_one_line(changed, what, tmp_path, capsys):
    write(tmp_path, "mine", SMALL | changed)
    assert main(["--data", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith(f"tracking: {tmp_path / 'mine.yaml'}: ")
    with pytest.raises(RecordingError, match=what):
        load_recording(tmp_path, "mine")


@pytest.mark.parametrize("text", ["path: [", "- 3", "path: !!python/name:os.system {}"])
def test_a_file_that_is_no_mapping_is_told_in_one_line(text, tmp_path, capsys):
    write(tmp_path, "mine", SMALL)
    (tmp_path / "mine.yaml").write_text(text)
    assert main(["--data", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.count(str(tmp_path / "mine.yaml")) == 1


@pytest.mark.parametrize(
    ("file", "text", "what"),
    [
        ("track", "a,b\n1,2\n", "expected columns t_s"),
        ("waypoints", "x_m,y_m,on_planned_path\n1,2,x\n", "'x': expected columns x_m"),
        ("waypoints", "x_m,y_m,on_planned_path\n1,2,1\n", "1 rows: expected 2 or more"),
        ("waypoints", "x_m,y_m,on_planned_path\n1,2,1\n1,nan,1\n", "y_m = nan: expected a finite"),
        (
            "track",
            "t_s,x_m,y_m,course_rad,groundspeed_mps\n2,0,0,0,20\n1,0,0,0,20\n",
            "t_s = 1: expected not less",
        ),
        ("track", "\x00", "expected"),
        ("track", None, "No such file"),
    ],
)
def test_unreadable_columns_end_in_one_line(file, text, what, tmp_path, capsys):
    write(tmp_path, "mine", SMALL)
    path = tmp_path / f"mine_{file}.csv"
    if text is None:
        path.unlink()
    else:
        path.write_text(text)
    assert main(["--data", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert f"mine_{file}.csv" in error
    assert what in error


def test_a_folder_without_recordings_says_what_they_are(tmp_path, capsys):
    assert main(["--data", str(tmp_path)]) == 2
    assert "NAME.yaml, NAME_waypoints.csv, NAME_track.csv" in capsys.readouterr().err


def test_a_track_without_its_yaml_file_is_told(tmp_path, capsys):
    write(tmp_path, "mine", SMALL)
    write(tmp_path, "yours", SMALL)
    (tmp_path / "yours.yaml").unlink()
    assert main(["--data", str(tmp_path)]) == 2
    assert "yours_track.csv: expected yours.yaml beside it" in capsys.readouterr().err


LINE = [(-2500.0 + i, -300.0) for i in range(2600)]


@pytest.mark.parametrize(
    ("points", "waypoints", "what"),
    [
        (LINE, [(-2500.0, -300.0), (-2400.0, -300.0)], "no waypoint with on_planned_path = 1"),
        ([LINE[0]] * 3, LINE[::500], "does not cross x ="),
    ],
)
def test_a_flight_that_cannot_be_flown_again_is_told(points, waypoints, what, tmp_path):
    write(tmp_path, "mine", SMALL, points, waypoints)
    with pytest.raises(RecordingError, match=f"mine: .*{what}"):
        refly(load_recording(tmp_path, "mine"))


def test_a_flight_without_speed_is_told(tmp_path):
    write(tmp_path, "mine", SMALL, LINE, LINE[::500])
    recording = load_recording(tmp_path, "mine")
    still = np.zeros_like(recording.ground_speed_mps)
    with pytest.raises(RecordingError, match="groundspeed_mps = 0 at t_s"):
        refly(replace(recording, ground_speed_mps=still))


def test_a_flight_that_ends_too_soon_is_told(tmp_path, capsys):
    write(tmp_path, "mine", SMALL)
    assert main(["--data", str(tmp_path)]) == 2
    assert "mine: the recorded track does not fly the whole corner" in capsys.readouterr().err
