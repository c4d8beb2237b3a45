"""Encounters with a planner that misbehaves, under the monitor."""

import math

import numpy as np
import pytest

from sar_bridge.monitor.separation_monitor import SeparationMonitor
from sar_estimator.common.states import Motion
from sar_sim.trials.encounters import (
    KINDS,
    escape_bound_m,
    fly_encounter,
    summary,
)

SEEDS = range(3 * len(KINDS))


def test_no_encounter_that_can_be_escaped_comes_near():
    flown = [fly_encounter(seed) for seed in SEEDS]
    assert {encounter.kind for encounter in flown} == set(KINDS)
    assert {encounter.gated for encounter in flown} == {True, False}
    assert [encounter for encounter in flown if encounter.failed] == []
    assert any(encounter.escapes for encounter in flown)
    assert any(encounter.refused for encounter in flown)
    text = summary(flown)
    assert "crossing" in text
    assert text.splitlines()[-1].split()[:3] == ["all", "off", "8"]


def test_the_same_encounters_come_near_without_the_monitor(monkeypatch):
    monkeypatch.setattr(SeparationMonitor, "update", lambda *_: None)
    monkeypatch.setattr(SeparationMonitor, "passes", lambda *_, **__: True)
    assert sum(fly_encounter(seed).failed for seed in SEEDS) >= 2


def test_an_encounter_repeats_exactly():
    assert fly_encounter(5) == fly_encounter(5)


def stands_at(x, y):
    return lambda time_s: Motion(time_s, x, y, 0.0, 0.0)


@pytest.mark.parametrize(
    ("x", "bound"),
    [(50.0, 50.0), (150.0, 150.0), (400.0, 400.0)],
)
def test_the_bound_of_a_helicopter_that_stands_ahead(x, bound):
    """Whoever turns away at once keeps what there is, less what the turn takes."""
    uav = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
    found = escape_bound_m(uav, stands_at(x, 0.0), 0.0)
    assert found <= bound
    assert found >= bound - 61.0
    assert escape_bound_m(uav, stands_at(-x, 0.0), 0.0) == pytest.approx(bound)


def test_no_escape_is_better_than_the_bound():
    rng = np.random.default_rng(4)
    for _ in range(20):
        x, y = rng.uniform(-400.0, 400.0, 2)
        uav = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
        bound = escape_bound_m(uav, stands_at(x, y), 0.0)
        straight = min(math.hypot(20.0 * t - x, y) for t in np.arange(0.0, 99.0, 0.25))
        assert bound >= straight - 1e-6
        assert bound <= math.hypot(x, y) + 1e-6


def test_what_happens_before_the_first_list_is_flown_is_not_the_monitors():
    """All lists were refused until the aircraft were so near that no escape keeps 100 m."""
    flown = fly_encounter(639)
    assert flown.refused > 10
    assert not flown.escapable
