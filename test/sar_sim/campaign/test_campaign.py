"""Campaigns: plans, rows that do not depend on who flew them, and what they come to."""

import csv
import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import yaml

from sar_sim.campaign.campaign import load_campaign
from sar_sim.campaign.campaign_cli import main
from sar_sim.campaign.campaign_table import (
    Summary,
    corners_to_converge,
    line_of,
    mean_of,
    share_of,
    spread_of,
)
from sar_sim.campaign.missions import covered
from sar_sim.scenario.options import find_plan, scenario_folder
from sar_sim.scenario.scenario import ScenarioError
from sar_sim.world.world import World

SMALL = {
    "scenario": "short",
    "seeds": 2,
    "lag_m": [0.0, 300.0],
    "from_corner": 1,
    "tolerance_m": 500.0,
    "vary": {"rules": ["deadbeat", "follow"], "gps.sigma_m": [0.0, 3.0]},
}


def plan(folder, **changes):
    file = folder / "plan.yaml"
    file.write_text(yaml.safe_dump({**SMALL, **changes}, sort_keys=False), encoding="utf-8")
    return file


@cache
def square(number, seed=3):
    campaign = load_campaign(find_plan("squares"))
    return campaign.combinations[number], campaign.combinations[number].fly(seed, campaign.lag_m)


@pytest.mark.parametrize(("number", "separation_m"), [(0, 180.0), (3, 150.0)])
def test_the_lag_is_held_and_the_aircraft_stay_apart(number, separation_m):
    combination, flown = square(number)
    assert len(flown.lags_m) == 12
    assert np.abs(flown.lags_m[3:]).max() <= combination.tolerance_m
    assert flown.separation_m >= separation_m
    assert flown.alerts["escape"] == 0
    assert flown.lists / 12 < 25


def test_most_of_the_square_is_seen():
    _, flown = square(0)
    assert 95.0 < flown.coverage_percent < 100.0
    assert 0.0 < flown.overlap_percent < 20.0
    assert 25.0 < flown.rate_km2_per_h < 2.0 * 20.0 * 3.6 * 0.5
    assert np.abs(flown.extra_m).max() < 15.0


def test_a_uav_that_turns_wide_flies_the_papers_extra_path():
    campaign = load_campaign(find_plan("wide_turns"))
    paper = campaign.combinations[0]
    summary = Summary(paper, (paper.fly(0, campaign.lag_m),))
    extra = summary.extra_by_rule_m()
    assert 300.0 < extra["T2"].mean() < 550.0
    assert "T2 " in line_of(summary)


def test_perfect_formation_sees_everything():
    world = World(square(0)[0].scenario)
    side, spacing = world.scenario.pattern.turn_side, world.scenario.corner.spacing_m
    corners = np.array([(c.stop.x_m, c.stop.y_m) for c in world.corners])
    track = []
    for begin, end in pairwise(corners):
        way = (end - begin) / np.hypot(*(end - begin))
        inside = side * spacing * np.array((way[1], -way[0]))
        for share in np.linspace(0.0, 1.0, 50):
            here = begin + share * (end - begin)
            track.append((*here, *(here + inside)))
    assert covered(world, np.array(track)).percent > 99.5
    alone = np.array(track)
    alone[:, 2:] = alone[:, :2]
    assert covered(world, alone).percent < 65.0


def test_every_combination_is_what_it_says(tmp_path):
    conditions = {one.name: one for one in load_campaign(find_plan("squares")).combinations}
    tight = conditions["calm, f = 10 %"].scenario
    assert (tight.corner.spacing_m, tight.pattern.track_spacing_m) == pytest.approx((225.0, 450.0))
    assert conditions["wind 6 m/s"].scenario.wind.speed_mps == 6.0
    assert conditions["first legs 500 m"].scenario.pattern.first_leg_m == 500.0
    campaign = load_campaign(plan(tmp_path))
    assert [one.name for one in campaign.combinations] == [
        "deadbeat, sigma_m 0",
        "deadbeat, sigma_m 3",
        "follow, sigma_m 0",
        "follow, sigma_m 3",
    ]
    assert [one.scenario.gps.sigma_m for one in campaign.combinations] == [0.0, 3.0, 0.0, 3.0]


def test_the_plans_that_come_along_are_sound():
    plans = sorted((scenario_folder().parent / "campaigns").glob("*.yaml"))
    assert len(plans) >= 4
    for file in plans:
        campaign = load_campaign(file)
        names = [one.name for one in campaign.combinations]
        assert len(set(names)) == len(names)
    planners = load_campaign(find_plan("planners"))
    assert len(planners.combinations) == 27
    assert planners.combinations[0].scenario.uav.speed_lag_s == 0.0  # the preset's own defaults
    assert planners.combinations[0].watch_only


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"seed": 3}, "seed: unknown key, expected one of scenario, rules, .*, name"),
        ({"seeds": 0}, "seeds = 0: expected 1 or more"),
        ({"from_corner": True}, "from_corner = True: expected a whole number"),
        ({"lag_m": [1.0]}, r"lag_m\[1\]: missing"),
        ({"scenario": "nowhere"}, "nowhere: expected a file or one of"),
        ({"vary": [1]}, r"vary = \[1\]: expected a mapping"),
        ({"vary": {"rules": []}}, r"vary.rules = \[\]: expected a list, or parts"),
        ({"vary": {"rules": ["chase"]}}, "rules = 'chase': expected deadbeat, paper or follow"),
        ({"vary": {"gps.sigma": [1.0]}}, "gps.sigma: unknown key, expected one of rate_hz"),
        ({"vary": {"a": {"b": 1}}}, "vary.a.b = 1: expected a mapping"),
        ({"vary": {"redundancy": [1.0]}}, "redundancy = 1.0: expected 0 or more, less than 1"),
        ({"tolerance_m": -1}, "tolerance_m = -1: expected more than 0"),
        ({"watch_only": 1}, "watch_only = 1: expected true or false"),
    ],
)
def test_a_plan_that_is_wrong_is_refused_in_one_line(tmp_path, changes, message, capsys):
    with pytest.raises(ScenarioError, match=message):
        load_campaign(plan(tmp_path, **changes))
    assert main([str(plan(tmp_path, **changes)), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


RESULTS = ("rows.csv", "summary.csv", "summary.txt")


def test_the_same_rows_on_any_number_of_workers(tmp_path, capsys):
    file = str(plan(tmp_path))
    one, two = tmp_path / "one", tmp_path / "two"
    assert main([file, "--jobs", "1", "--out", str(one), "--plot"]) == 0
    out = capsys.readouterr().out
    assert out == (one / "summary.txt").read_text()
    assert "deadbeat, sigma_m 3" in out
    assert main([file, "--jobs", "2", "--out", str(two)]) == 0
    for name in RESULTS:
        assert (one / name).read_bytes() == (two / name).read_bytes()
    assert (one / "lags_3.png").stat().st_size > 5_000
    with (one / "rows.csv").open() as text:
        rows = list(csv.DictReader(text))
    assert len(rows) == 8
    assert [row["rules"] for row in rows] == ["deadbeat"] * 4 + ["follow"] * 4
    assert {row["corner_rules"] for row in rows[4:]} == {""}  # one that follows plans no corner
    assert min(float(row["separation_m"]) for row in rows[:4]) > 180.0
    with (one / "summary.csv").open() as text:
        found = list(csv.DictReader(text))
    assert [row["missions"] for row in found] == ["2"] * 4
    first = found[0]
    low, mean, high = (float(first[f"separation_m{end}"]) for end in ("_low", "", "_high"))
    assert low < mean < high


def test_the_same_rows_when_resumed_and_never_another_plans(tmp_path, capsys):
    file = str(plan(tmp_path, vary={"rules": ["deadbeat"]}))
    one, two = tmp_path / "one", tmp_path / "two"
    assert main([file, "--jobs", "1", "--out", str(one)]) == 0
    assert main([file, "--jobs", "1", "--out", str(two), "--seeds", "1"]) == 0
    begun = (two / "kept.jsonl").read_text()
    assert main([file, "--jobs", "1", "--out", str(two)]) == 0
    assert (two / "kept.jsonl").read_text().startswith(begun)
    for name in RESULTS:
        assert (one / name).read_bytes() == (two / name).read_bytes()
    capsys.readouterr()
    assert main([str(plan(tmp_path, seeds=3)), "--out", str(one)]) == 2
    assert "of another plan" in capsys.readouterr().err


def test_estimates():
    found = mean_of([1.0, 2.0, 3.0, math.nan])
    assert (found.value, found.low, found.high) == pytest.approx((2.0, -0.484, 4.484), abs=1e-3)
    assert math.isnan(mean_of([]).value)
    assert mean_of([4.0]).text(1) == "4.0"
    share = share_of([True] * 9 + [False])
    assert (share.value, share.low, share.high) == pytest.approx((90.0, 59.6, 98.2), abs=0.1)
    assert share_of([]).text(1) == "-"


def test_spread_is_mean_and_nine_tenths():
    assert spread_of(np.arange(101.0)) == "50 (5 to 95)"


def test_corners_to_converge():
    assert corners_to_converge([300.0, 20.0, 3.0, -2.0], 15.0) == 2.0
    assert corners_to_converge([3.0, -2.0], 15.0) == 0.0
    assert math.isnan(corners_to_converge([3.0, 40.0], 15.0))


def test_a_cluster_that_is_not_there_is_one_line(tmp_path, capsys):
    out = tmp_path / "out"
    assert main([str(plan(tmp_path)), "--scheduler", "tcp://127.0.0.1:1", "--out", str(out)]) == 2
    assert "--scheduler tcp://127.0.0.1:1: no Dask scheduler there" in capsys.readouterr().err
