"""Random changes of formations: what is flown, and what is told of it."""

import math

import pytest

from sar_sim.trials.formation_trials import KINDS, Trial, fly, random_scenario, summary
from sar_sim.trials.formation_trials_cli import main


def test_every_kind_is_drawn_and_a_seed_is_always_the_same():
    drawn = [random_scenario(seed) for seed in range(len(KINDS))]
    assert [kind for _, kind, _ in drawn] == list(KINDS)
    assert random_scenario(7) == random_scenario(7)
    for scenario, kind, _ in drawn:
        assert len(scenario.formation) == (3 if kind == "lost, replaced" else 2)


@pytest.mark.parametrize("seed", [0, 3])
def test_slots_exchanged_or_taken_over_are_reached_and_all_stay_apart(seed):
    trial = fly(seed)
    assert trial.kind == KINDS[seed % len(KINDS)]
    assert trial.helicopter_m > 180.0
    assert trial.uavs_m > 150.0
    assert trial.corners <= 2
    assert not math.isnan(trial.settled_s)


def test_the_table_has_a_line_for_every_kind_flown():
    trials = [
        Trial(0, "exchanged", 230.0, 300.0, 100.0, 1, 0),
        Trial(5, "exchanged", 170.0, math.inf, math.nan, 0, 2),
        Trial(4, "late", 210.0, math.inf, 60.0, 3, 0),
    ]
    lines = summary(trials).splitlines()
    assert [line.split()[0] for line in lines] == ["change", "exchanged", "late", "all"]
    assert "50.0%" in lines[1]
    assert "0.0%" in lines[2]
    assert "170" in lines[3]


def test_a_number_that_cannot_be_is_refused(capsys):
    with pytest.raises(SystemExit):
        main(["--changes", "none"])
    assert "--changes" in capsys.readouterr().err
