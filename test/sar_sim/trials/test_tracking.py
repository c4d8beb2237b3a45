"""The planner's waypoints flown by the simulated autopilot, and how a track is measured."""

from dataclasses import replace

import numpy as np
import pytest

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_planner.guidance.path_waypoints import path_waypoints
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import FlightPath, Straight
from sar_planner.rules.paper_rules import Rule, build
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav, Wind
from sar_sim.trials.recordings import PLAIN
from sar_sim.trials.tracking import (
    CASES,
    DATUM,
    Case,
    adjustable_curve,
    fly_guided,
    fly_items,
    measure,
    path_points,
)
from sar_sim.trials.tracking_cli import ARDUPLANE, TUNINGS, main


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("name", TUNINGS)
def test_planners_waypoints_are_flown_as_planned(name, case):
    uav, wind = TUNINGS[name]
    flown = measure(fly_guided(CASES[case], uav=uav, wind=wind), CASES[case])
    assert abs(flown.extra_m) <= 15.0
    assert flown.off_m <= 3.0


@pytest.mark.parametrize("direction", [0.0, 90.0, 200.0, 300.0])
def test_waypoints_hold_in_any_wind(direction):
    uav = replace(ARDUPLANE, l1_period_s=12.0)
    flown = measure(fly_guided(CASES["C"], uav=uav, wind=Wind(8.0, direction)), CASES["C"])
    assert abs(flown.extra_m) <= 15.0
    assert flown.off_m <= 3.0


WIDE = CornerParameters(turn_radius_m=120.0, spacing_m=300.0)
MEASURED = {
    **CASES,
    "short": replace(CASES["C"], run_in_m=100.0, finish_m=700.0),
    "wide": Case(build(Rule.T3, 0.0, WIDE).path, WIDE.spacing_m),
}


@pytest.mark.parametrize("name", MEASURED)
def test_a_perfect_track_has_no_extra_length(name):
    case = MEASURED[name]
    path = case.measured
    before = path.start.offset(-50.0)
    after = path.end.offset(50.0)
    points = np.vstack(((before.x_m, before.y_m), path_points(path), (after.x_m, after.y_m)))
    flown = measure(points, case)
    assert flown.extra_m == pytest.approx(0.0, abs=0.2)
    assert flown.off_m < 0.1


def test_a_track_that_breaks_off_is_not_measured():
    assert measure(path_points(CASES["T1"].measured)[:-100], CASES["T1"]) is None


def test_a_track_on_another_line_is_not_measured():
    points = path_points(CASES["T1"].measured)
    assert measure(points + np.array((0.0, 150.0)), CASES["T1"]) is None
    assert measure(points - np.array((150.0, 0.0)), replace(CASES["T1"], run_in_m=100.0)) is None


def test_an_adjustable_curve_that_would_begin_too_early_is_refused():
    with pytest.raises(ValueError, match="straight of"):
        adjustable_curve(-200.0, 108.0, 0.1, CornerParameters())


def test_without_recordings_the_planners_waypoints_are_flown(capsys):
    assert main([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line[:30].strip() for line in lines[1:]] == list(TUNINGS)


@pytest.mark.parametrize("case", ["T3", "C"])
def test_piccolo2005_on_arc_ends_flies_as_much_farther_as_the_papers_did(case):
    path = CASES[case].measured
    start = path.start.offset(-400.0)
    whole = FlightPath.of(start, (Straight(400.0), *path.segments, Straight(600.0)))
    items = [
        replace(item, params=PLAIN)
        for item in waypoint_items(path_waypoints(whole, 0.0), DATUM, 150.0)
    ]
    uav = Uav(autopilot="piccolo2005", **AUTOPILOTS["piccolo2005"])
    flown = measure(fly_items(items, start, airspeed_mps=20.0, uav=uav, wind=Wind()), CASES[case])
    assert 300.0 < flown.extra_m < 550.0
