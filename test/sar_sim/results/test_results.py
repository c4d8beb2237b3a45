"""The page of results: what is on it, from missions that are made up."""

import re
from dataclasses import replace

import numpy as np
import pytest

from sar_planner.parameters.corner import CornerParameters
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_sim.campaign.campaign import load_campaign
from sar_sim.campaign.campaign_table import summaries
from sar_sim.campaign.missions import Mission
from sar_sim.results import results_cli
from sar_sim.results.results import corners_in, keyed, nearest_by_rule, page, table
from sar_sim.scenario.options import find_plan

ALERTS = dict.fromkeys(("caution", "warning", "escape", "passed", "refused"), 0)


def mission(seed, lag):
    rng = np.random.default_rng(seed)
    lags = tuple(lag * rng.uniform(0.9, 1.1, 12))
    return Mission(
        seed, lags, lags, ("T1", "T2") * 6, 150.0 + seed, 60.0, 99.0 + 0.1 * seed, 99.5, 10.0, 15.0,
        1800.0, 3, 40, 0, 2400.0, ALERTS, frozenset(),
    )  # fmt: skip


def made_up(name, lag=100.0):
    campaign = load_campaign(find_plan(name))
    flown = [
        [mission(seed, lag + n) for seed in range(3)] for n in range(len(campaign.combinations))
    ]
    return summaries(campaign, flown)


def test_a_table_is_markdown():
    assert table(["a", "b"], [["1", "2"]]) == "| a | b |\n|---|---|\n| 1 | 2 |"


def test_every_planner_on_every_autopilot_stands_beside_the_papers_print():
    text = page(
        made_up("planners"),
        {"loses way": made_up("extra_path")},
        [-200.0, 0.0, 477.0],
        " --seeds 3",
    )
    assert "`ros2 run sar_sim results --out docs --seeds 3`" in text
    assert "81 missions" in text
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    rows = [re.split(r"(?<!\\)\|", line)[1:-1] for line in lines]
    wide = [[cell.strip() for cell in row] for row in rows if len(row) > 10]
    assert all(len(row) == 11 for row in wide)
    printed = {row[0]: row[1] for row in wide}
    assert [printed[f"coverage, f = {f} % [%]"] for f in (0, 5, 10)] == ["99.65", "99.63", "99.83"]
    covered = next(row for row in wide if row[0].startswith("coverage, f = 0"))
    assert set(covered[2:]) == {"99.10 ± 0.25"}
    apart = next(row for row in wide if row[0] == "closest approach, least [m]")
    assert set(apart[2:]) == {"150"}
    assert "T2 -> T3  for L in [43.6, 65.4)" in text
    assert text.count("T1 50 %, T2 50 %") == 3
    images = re.findall(r"!\[.*\]\((.*)\)", text)
    assert images == [
        "results_lags.png",
        "results_rules.png",
        "results_fig9.png",
        "results_fig10.png",
    ]


def test_the_papers_rules_come_as_near_as_they_do():
    nearest = {one.rule.name: one for one in nearest_by_rule("paper", [-80.0, 0.0, 477.0, 700.0])}
    assert nearest["T2"].distance_m == pytest.approx(23.6, abs=0.1)
    assert nearest["T4"].distance_m == pytest.approx(17.3, abs=0.1)
    assert nearest["T2"].lag_m == 477.0
    assert all(one.distance_m > 200.0 for one in nearest_by_rule("deadbeat", [-80.0, 0.0, 477.0]))


@pytest.mark.parametrize("lag", [-800.0, -80.0, 0.0, 43.7, 622.8, 623.0, 1400.0, 5000.0])
def test_no_more_corners_are_counted_than_the_bounds_say(lag):
    automaton = PaperAutomaton(CornerParameters())
    cuts, curves = corners_in(automaton, lag)
    first = max(lag, automaton.progression_m(automaton.rule_for(lag), lag))
    most = automaton.step_bounds(first)
    assert cuts <= most[0]
    assert curves <= most[1]
    assert curves > 0 or lag in (-80.0, 0.0, 623.0, 1400.0, 5000.0)


def test_the_command_writes_page_and_figures(tmp_path, monkeypatch, capsys):
    def fly(campaign, out, args):
        assert out.parent == tmp_path / "work"
        assert args.seeds == 3
        return [[mission(seed, 50.0) for seed in range(3)] for _ in campaign.combinations]

    monkeypatch.setattr(results_cli, "fly_campaign", fly)
    drawn = results_cli._draw_flight

    def short(one, work, out):
        pattern = replace(one.scenario.pattern, corners=1, first_leg_m=900.0)
        drawn(replace(one, scenario=replace(one.scenario, pattern=pattern)), work, out)

    monkeypatch.setattr(results_cli, "_draw_flight", short)
    options = ["--out", str(tmp_path / "docs"), "--work", str(tmp_path / "work"), "--seeds", "3"]
    assert results_cli.main(options) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'docs' / 'results.md'}\n"
    text = (tmp_path / "docs" / "results.md").read_text(encoding="utf-8")
    for image in re.findall(r"results_\w+.png", text):
        assert (tmp_path / "docs" / image).stat().st_size > 5_000
    assert keyed(made_up("planners")).keys() == {
        (planner, uav, share)
        for planner in ("paper", "deadbeat", "follow")
        for uav in ("ideal", "piccolo2005", "arduplane")
        for share in (0.0, 0.05, 0.1)
    }


def test_bad_input_is_one_line(tmp_path, monkeypatch, capsys):
    def fly(campaign, out, args):
        raise ValueError("seeds: another build")

    monkeypatch.setattr(results_cli, "fly_campaign", fly)
    assert results_cli.main(["--out", str(tmp_path), "--work", str(tmp_path)]) == 2
    assert capsys.readouterr().err == "results: seeds: another build\n"
