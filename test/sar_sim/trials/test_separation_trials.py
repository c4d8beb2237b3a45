"""The planner's bound of a path's least distance beside a fine look, over random cases."""

import numpy as np
import pytest

from sar_planner.paths.apart_kernels import TOLERANCE_M
from sar_sim.trials.separation_trials import KINDS, PATHS, draw, random_forecast
from sar_sim.trials.separation_trials_cli import main, table


def test_a_seed_draws_the_same_paths_and_others_others():
    assert (draw(3).batch.rows == draw(3).batch.rows).all()
    assert draw(3).batch.rows[0, 0] != draw(4).batch.rows[0, 0]
    assert {draw(seed).lead_mps is None for seed in range(20)} == {True, False}


@pytest.mark.parametrize("seed", range(60))
def test_forecasts_have_no_jumps(seed):
    """The bound asks for that; every kind that is made in flight is among them."""
    forecast = random_forecast(np.random.default_rng(seed), 0.0)
    kinks = np.array([one.time_s for one in forecast.stretches])
    before, after = forecast.positions(kinks - 1e-6), forecast.positions(kinks)
    assert np.abs(after - before).max() < 1e-4
    assert len(KINDS) == 6


@pytest.mark.parametrize("seed", range(100, 140))
def test_bounds_are_never_above_and_hardly_below(seed):
    case = draw(seed)
    gaps = case.sampled_m() - case.bounds_m()
    assert gaps.min() >= -1e-6
    assert gaps.max() <= TOLERANCE_M + 0.05
    assert np.median(gaps) <= TOLERANCE_M


@pytest.mark.parametrize("seed", range(200, 210))
def test_what_is_said_to_be_kept_is(seed):
    case = draw(seed)
    sampled = case.sampled_m()
    for kept_m in (100.0, 200.0, 300.0):
        kept = case.bounds_m(kept_m) >= kept_m
        assert (sampled[kept] >= kept_m).all()
        assert kept[sampled >= kept_m + TOLERANCE_M + 0.01].all()


def test_the_table_tells_of_what_is_above(capsys):
    assert "above the least distance in 1," in table(np.array([-0.1, 0.05]), 1.0, 1.0)
    assert main(["--paths", str(2 * PATHS)]) == 0
    assert "above the least distance in 0," in capsys.readouterr().out


def test_bad_input_is_one_line(capsys):
    assert main(["--paths", "1"]) == 2
    assert capsys.readouterr().err.startswith("separation_trials: ")
