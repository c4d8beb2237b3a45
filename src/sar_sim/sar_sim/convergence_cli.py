"""``convergence``: how the lag converges over many seeded missions, and how far they stay apart."""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path

from sar_planner.rule_sets import RULE_SETS
from sar_sim.figures import draw_lags
from sar_sim.kept import Kept
from sar_sim.missions import Outcome, fly_once, seeded, summary
from sar_sim.options import find_scenario
from sar_sim.pool import add_work_options, in_parallel
from sar_sim.scenario import Scenario, load_scenario, scenario_document


def _fly(
    seed: int,
    scenario: Scenario,
    rules: str,
    lags: tuple[float, float] | None,
    *,
    watch_only: bool,
) -> Outcome:
    return fly_once(seeded(scenario, seed, lags), rules, watch_only=watch_only)


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the table; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="convergence", description=__doc__)
    parser.add_argument("--scenario", default="closed_loop", help="a scenario's name or YAML file")
    parser.add_argument("--rules", choices=RULE_SETS, default="deadbeat")
    add_work_options(parser, seeds=("seeds", 20))
    parser.add_argument("--lags", type=float, nargs=2, metavar=("LOW", "HIGH"), help="of L(1), m")
    parser.add_argument("--tolerance", type=float, default=15.0, help="on |L(k)|, m")
    parser.add_argument("--from-corner", type=int, default=3, help="counted from this corner on")
    parser.add_argument("--watch-only", action="store_true", help="the monitor does nothing")
    parser.add_argument("--plot", type=Path, help="draw L(k) of every mission into this file")
    args = parser.parse_args(argv)
    try:
        scenario = load_scenario(find_scenario(args.scenario))
        lags = None if args.lags is None else (args.lags[0], args.lags[1])
        seeds = range(args.first_seed, args.first_seed + args.seeds)
        fly = partial(
            _fly, scenario=scenario, rules=args.rules, lags=lags, watch_only=args.watch_only
        )
        about = {
            "work": "convergence",
            "scenario": scenario_document(scenario),
            "rules": args.rules,
            "lags": lags,
            "watch_only": args.watch_only,
        }
        kept = Kept(args.keep, about)
        outcomes = in_parallel(fly, seeds, args.jobs, kind=Outcome, kept=kept)
    except ValueError as error:
        sys.stderr.write(f"convergence: {error}\n")
        return 2
    text = summary(outcomes, tolerance_m=args.tolerance, from_corner=args.from_corner)
    sys.stdout.write(f"{scenario.name}, rules {args.rules}, {args.seeds} missions\n{text}\n")
    if args.plot is not None:
        title = f"{scenario.name}, rules {args.rules}"
        draw_lags([outcome.lags_m for outcome in outcomes], title, args.plot)
    return 0


if __name__ == "__main__":
    sys.exit(main())
