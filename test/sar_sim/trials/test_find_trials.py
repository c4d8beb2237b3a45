"""Random finds: drawn from their seed, flown, and told as a table."""

import pytest

from sar_sim.trials.find_trials import PILOTS, fly, random_scenario
from sar_sim.trials.find_trials_cli import main, table


def test_a_seed_draws_the_same_find_and_others_others():
    assert random_scenario(5) == random_scenario(5)
    finds = {random_scenario(seed)[0].finds[0].time_s for seed in range(20)}
    assert len(finds) == 20
    assert {random_scenario(seed)[1] for seed in range(6)} == set(PILOTS)


@pytest.mark.parametrize("seed", [0, 1, 3, 4])
def test_a_find_is_flown_and_told(seed):
    trial = fly(seed)
    assert trial.pilot == PILOTS[seed]
    assert trial.reach_s < 300.0
    assert trial.held > 0.4
    assert trial.closest_m > 150.0
    told = table([trial], 200.0)
    assert trial.pilot in told
    assert "all" in told


def test_bad_input_is_one_line(capsys, tmp_path):
    (tmp_path / "rows").write_text("no rows", encoding="utf-8")
    assert main(["--finds", "1", "--jobs", "1", "--keep", str(tmp_path / "rows")]) == 2
    assert capsys.readouterr().err.startswith("find_trials: ")
