"""Many missions at once, and what is made of them."""

import numpy as np
import pytest

from sar_planner.cli.replan_benchmark import main as benchmark
from sar_sim.campaign.missions import Mission, seeded, watched
from sar_sim.results.rules_figure_cli import main as rules_figure
from sar_sim.scenario.scenario import Scenario
from sar_sim.trials.rejoin_trials_cli import main as rejoin_trials


def test_seed_is_everyones_and_lag_is_drawn():
    one, same = (seeded(Scenario(), 7, (-300.0, 1000.0)) for _ in range(2))
    assert one == same
    assert one.gps.seed == one.pilot.seed == one.uav.seed == 7
    assert -300.0 <= one.uav.lag_m <= 1000.0
    assert seeded(Scenario(), 7, None).uav.lag_m == 800.0


def mission(seed, lags_m, separation_m, separation_s, alerts):
    predicted = (0.0,) * len(lags_m)
    return Mission(
        seed,
        lags_m,
        predicted,
        ("D2",),
        separation_m,
        separation_s,
        coverage_percent=99.0,
        reached_percent=99.5,
        overlap_percent=20.0,
        seen_km2=10.0,
        covered_s=1800.0,
        corrections=1,
        lists=9,
        false_corners=1,
        flown_s=900.0,
        alerts=alerts,
        problems=frozenset(),
    )


ONE = mission(1, (500.0, 3.0, 2.0), 230.0, 10.0, {"escape": 1})
OTHER = mission(2, (300.0, 40.0, 20.0), 190.0, 20.0, {"caution": 2})


def test_extra_path_and_rate():
    assert OTHER.extra_m == (40.0, 20.0)
    assert OTHER.rate_km2_per_h == pytest.approx(20.0)


def test_what_the_monitor_did_is_added_up():
    assert watched([ONE, OTHER]) == (
        "0.5 h flown: false corners 2, escapes 1, warnings 0, cautions 2; lists passed 0, refused 0"
    )


def test_rejoin_from_random_starts(capsys):
    assert rejoin_trials(["--starts", "20", "--jobs", "1", "--bound", "free"]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("all"))
    assert "20 starts: on the slot within 10 m and 2 deg 100.00%, apart 100.00%" in line


@pytest.mark.proof
@pytest.mark.timeout(900)
def test_rejoin_from_more_random_starts_with_its_bound(capsys):
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


@pytest.mark.parametrize(
    "name", ["closed_loop", "extra_path", "wide_turns", "hover", "angles", "drift"]
)
def test_shipped_scenarios_load(name):
    from sar_sim.scenario.options import find_scenario  # noqa: PLC0415
    from sar_sim.scenario.scenario import load_scenario  # noqa: PLC0415

    scenario = load_scenario(find_scenario(name))
    assert scenario.name == name
    assert np.isfinite(scenario.uav.lag_m)
