"""``results``: the paper's tables and figures, and what is flown here, into ``results.md``."""

from __future__ import annotations

import argparse
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from sar_estimator.bags.bag import BagWriter
from sar_planner.parameters.corner import RULE_SETS, CornerParameters
from sar_sim.campaign.campaign import Campaign, Combination, load_campaign
from sar_sim.campaign.campaign_cli import fly_campaign
from sar_sim.campaign.campaign_table import Summary, summaries
from sar_sim.campaign.missions import seeded
from sar_sim.flight.offline import OfflineFlight
from sar_sim.jobs.pool import add_work_options
from sar_sim.report.figures import corner_to_draw, draw_corner, draw_lag_grid, draw_map, draw_rules
from sar_sim.report.flight_data import read_flight
from sar_sim.report.metrics import coverage
from sar_sim.results.results import AUTOPILOTS, ERRORS, PLANNERS, SAFETY_STEP_M, keyed, page
from sar_sim.results.rules_figure_cli import sweep
from sar_sim.scenario.options import find_plan

LOW_M, HIGH_M = -800.0, 1400.0
FIGURE_STEP_M = 10.0
FIGURE_LAG_M = 700.0


def _flown(name: str, work: Path, args: argparse.Namespace) -> list[Summary]:
    """Fly a campaign, or go on with it."""
    campaign: Campaign = load_campaign(find_plan(name))
    out = work / name
    out.mkdir(parents=True, exist_ok=True)
    return summaries(campaign, fly_campaign(campaign, out, args))


def _draw_flight(one: Combination, work: Path, out: Path) -> None:
    """Fly the paper's rules once, lag and all, and draw figs. 9 and 10."""
    bag = work / "fig9"
    shutil.rmtree(bag, ignore_errors=True)
    scenario = replace(one.scenario, uav=replace(one.scenario.uav, lag_m=FIGURE_LAG_M))
    written = BagWriter(bag)
    try:
        scenario = seeded(scenario, 1, None)
        OfflineFlight(scenario, rules=one.rules, watch_only=one.watch_only, bag=written).run()
    finally:
        written.close()
    data = read_flight(bag)
    draw_map([data], coverage([data]), out / "results_fig9.png")
    draw_corner(data, corner_to_draw(data), out / "results_fig10.png")


def write_results(out: Path, work: Path, args: argparse.Namespace) -> None:
    """Fly what is not flown yet, and write page and figures."""
    found = _flown("planners", work, args)
    failed = {error: _flown(plan, work, args) for error, plan in ERRORS.items()}
    by_key = keyed(found)
    out.mkdir(parents=True, exist_ok=True)
    panels = [
        [(f"{planner}, {uav}", by_key[planner, uav, 0.0]) for uav in AUTOPILOTS]
        for planner in PLANNERS
    ]
    lags_m = [[(title, [m.lags_m for m in one.missions]) for title, one in row] for row in panels]
    draw_lag_grid(lags_m, out / "results_lags.png")
    parameters = CornerParameters()
    lags = np.arange(LOW_M, HIGH_M + 1.0, FIGURE_STEP_M)
    series = {name: sweep(name, parameters, lags) for name in reversed(RULE_SETS)}
    draw_rules(series, parameters.separation_m, out / "results_rules.png")
    _draw_flight(by_key["paper", "piccolo2005", 0.0].combination, work, out)
    options = f" --seeds {args.seeds}" if args.seeds else ""
    swept = np.arange(LOW_M, HIGH_M + 0.5, SAFETY_STEP_M).tolist()
    (out / "results.md").write_text(page(found, failed, swept, options), encoding="utf-8")


def main(argv: list[str] | None = None) -> int:
    """Run the command; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="results", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of results.md")
    parser.add_argument(
        "--work", type=Path, default=Path("runs/results"), help="missions; gone on with"
    )
    add_work_options(parser, seeds=("seeds", 0))
    args = parser.parse_args(argv)
    try:
        write_results(args.out, args.work, args)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"results: {error}\n")
        return 2
    sys.stdout.write(f"{args.out / 'results.md'}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
