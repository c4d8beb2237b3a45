"""Many missions at once, and what is made of them."""

import numpy as np
import pytest

from sar_planner.benchmark_cli import main as benchmark
from sar_sim.convergence_cli import main as convergence
from sar_sim.missions import Outcome, seeded, summary
from sar_sim.rejoin_trials_cli import main as rejoin_trials
from sar_sim.rules_figure_cli import main as rules_figure
from sar_sim.scenario import Scenario


def test_seed_is_everyones_and_lag_is_drawn():
    one, same = (seeded(Scenario(), 7, (-300.0, 1000.0)) for _ in range(2))
    assert one == same
    assert one.gps.seed == one.pilot.seed == one.uav.seed == 7
    assert -300.0 <= one.uav.lag_m <= 1000.0
    assert seeded(Scenario(), 7, None).uav.lag_m == 800.0


def test_summary_counts_late_corners():
    outcomes = [
        Outcome(1, (500.0, 3.0, 2.0), ("D2",), 230.0, 10.0, 1, 900.0, {"escape": 1}),
        Outcome(2, (300.0, 40.0, 20.0), ("D2",), 190.0, 20.0, 1, 900.0, {"caution": 2}),
    ]
    text = summary(outcomes, tolerance_m=15.0, from_corner=2)
    assert "from 2 on: 50.0% of 2 missions; at 50.0% of those corners" in text
    assert "least separation 190.0 m (seed 2, t = 20 s)" in text
    assert "0.5 h flown: escapes 1, warnings 0, cautions 2; lists passed 0, refused 0" in text


def test_convergence_of_a_few_missions(capsys, tmp_path):
    plot = tmp_path / "lags.png"
    options = ["--seeds", "4", "--jobs", "2", "--lags", "-100", "500", "--plot", str(plot)]
    assert convergence(options) == 0
    out = capsys.readouterr().out
    assert "from 3 on: 100.0% of 4 missions" in out
    least = float(out.split("least separation ")[1].split(" m")[0])
    assert least >= 200.0
    assert plot.stat().st_size > 10_000
    assert convergence(["--scenario", "nowhere"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_rejoin_from_random_starts(capsys):
    assert rejoin_trials(["--starts", "40", "--jobs", "2"]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("all"))
    assert "40 starts: on the slot within 10 m and 2 deg 100.00%, apart 100.00%" in line


def test_rules_figure(capsys, tmp_path):
    out = tmp_path / "rules.png"
    assert rules_figure(["--out", str(out), "--step", "40"]) == 0
    text = capsys.readouterr().out
    deadbeat = text.split("deadbeat: closest approach ")[1]
    assert float(deadbeat.split(" m")[0]) >= 200.0
    assert out.stat().st_size > 10_000
    assert rules_figure(["--step", "-1"]) == 2


def test_benchmark_prints_its_figures(capsys):
    assert benchmark(["--count", "20"]) == 0
    lines = capsys.readouterr().out.splitlines()
    for line, kind in zip(
        lines, ("waypoints on the path", "waypoints on an L1 guide"), strict=True
    ):
        assert line.startswith(f"20 replans, L from -150 to 1000 m, {kind}: median ")


@pytest.mark.parametrize("name", ["closed_loop", "extra_path", "hover", "angles", "drift"])
def test_shipped_scenarios_load(name):
    from sar_sim.options import find_scenario  # noqa: PLC0415
    from sar_sim.scenario import load_scenario  # noqa: PLC0415

    scenario = load_scenario(find_scenario(name))
    assert scenario.name == name
    assert np.isfinite(scenario.uav.lag_m)
