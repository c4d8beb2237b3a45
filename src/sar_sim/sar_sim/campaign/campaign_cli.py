"""``campaign``: every combination of a plan flown with many seeds, on all cores or a cluster."""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path

from sar_sim.campaign.campaign import Campaign, load_campaign
from sar_sim.campaign.campaign_table import HEADER, line_of, summaries, write_rows, write_summary
from sar_sim.campaign.missions import Mission
from sar_sim.jobs.pool import Workers, add_work_options, in_parallel
from sar_sim.jobs.result_cache import ResultCache
from sar_sim.report.figures import draw_lags
from sar_sim.scenario.options import find_plan


def fly_campaign(campaign: Campaign, out: Path, args: argparse.Namespace) -> list[list[Mission]]:
    """Fly what is not kept in ``out`` yet, combination by combination, as the options say."""
    seeds = range(args.first_seed, args.first_seed + (args.seeds or campaign.seeds))
    kept = ResultCache(out / "kept.jsonl", {"work": "campaign", "plan": campaign.document})
    flown = []
    with Workers(args.jobs, args.scheduler) as workers:
        for one in campaign.combinations:
            work = partial(one.fly, lag_m=campaign.lag_m)
            flown.append(in_parallel(work, seeds, workers, kind=Mission, kept=kept, part=one.name))
            sys.stderr.write(f"{one.name}: {len(flown[-1])} missions\n")
    return flown


def main(argv: list[str] | None = None) -> int:
    """Fly them, write rows and summary, print the table; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="campaign", description=__doc__)
    parser.add_argument("plan", help="a plan's name in config/campaigns, or a YAML file")
    parser.add_argument(
        "--out", type=Path, required=True, help="folder; what is there is gone on with"
    )
    add_work_options(parser, seeds=("seeds", 0))
    parser.add_argument("--plot", action="store_true", help="draw L(k) of every combination")
    args = parser.parse_args(argv)
    try:
        campaign = load_campaign(find_plan(args.plan))
        args.out.mkdir(parents=True, exist_ok=True)
        flown = fly_campaign(campaign, args.out, args)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"campaign: {error}\n")
        return 2
    found = summaries(campaign, flown)
    write_rows(args.out / "rows.csv", campaign, flown)
    write_summary(args.out / "summary.csv", found)
    lines = [f"campaign {campaign.name}", HEADER]
    text = "\n".join([*lines, *map(line_of, found)]) + "\n"
    (args.out / "summary.txt").write_text(text, encoding="utf-8")
    sys.stdout.write(text)
    if args.plot:
        for number, one in enumerate(found):
            lags = [mission.lags_m for mission in one.missions]
            draw_lags(lags, one.combination.name, args.out / f"lags_{number}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
