"""Expanding squares with ArduPlane's guidance."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from sar_sim.options import find_scenario
from sar_sim.scenario import load_scenario
from sar_sim.squares import CONDITIONS, FROM_CORNER, coverage_percent, fly_square, summary
from sar_sim.squares_cli import main
from sar_sim.world import World

CALM = CONDITIONS["calm, f = 0 %"]
WINDY = CONDITIONS["wind 6 m/s"]


@cache
def square(condition, seed=3):
    return fly_square(seed, load_scenario(find_scenario("arduplane")), condition, "deadbeat")


@pytest.mark.parametrize("condition", [CALM, WINDY])
def test_the_lag_is_held_and_the_aircraft_stay_apart(condition):
    flown = square(condition)
    assert len(flown.lags_m) == 12
    late = np.abs(flown.lags_m[FROM_CORNER - 1 :])
    assert late.max() <= condition.lag_m
    assert flown.separation_m >= condition.separation_m
    assert flown.lists / 12 < 25


def test_most_of_the_square_is_seen():
    assert 95.0 < square(CALM).coverage_percent < 100.0


def test_perfect_formation_sees_everything():
    world = World(CALM.scenario(load_scenario(find_scenario("arduplane")), 1))
    side, spacing = world.scenario.pattern.turn_side, world.scenario.corner.spacing_m
    corners = np.array([(c.stop.x_m, c.stop.y_m) for c in world.corners])
    track = []
    for begin, end in pairwise(corners):
        way = (end - begin) / np.hypot(*(end - begin))
        inside = side * spacing * np.array((way[1], -way[0]))
        for share in np.linspace(0.0, 1.0, 50):
            here = begin + share * (end - begin)
            track.append((*here, *(here + inside)))
    assert coverage_percent(world, np.array(track)) > 99.5
    alone = np.array(track)
    alone[:, 2:] = alone[:, :2]
    assert coverage_percent(world, alone) < 65.0


def test_conditions_are_what_they_say():
    base = load_scenario(find_scenario("arduplane"))
    tight = CONDITIONS["calm, f = 10 %"].scenario(base, 5)
    assert tight.corner.spacing_m == pytest.approx(225.0)
    assert tight.pattern.track_spacing_m == pytest.approx(450.0)
    assert WINDY.scenario(base, 5).wind.speed_mps == 6.0
    assert WINDY.scenario(base, 5).wind != WINDY.scenario(base, 6).wind
    assert CONDITIONS["first legs 500 m"].scenario(base, 1).pattern.first_leg_m == 500.0


def test_summary_tells_the_worst():
    text = summary("calm", CALM, [square(CALM)])
    assert f"{max(abs(lag) for lag in square(CALM).lags_m[3:]):.1f}" in text
    assert f"{square(CALM).separation_m:.1f}" in text


def test_unknown_condition_is_one_line(capsys):
    assert main(["--only", "hail"]) == 2
    assert "--only hail: expected part of" in capsys.readouterr().err
