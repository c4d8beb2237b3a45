"""``squares``: expanding squares flown by ArduPlane's guidance: L(k), separation, coverage."""

from __future__ import annotations

import argparse
import sys
from functools import partial

from sar_planner.rule_sets import RULE_SETS
from sar_sim.kept import Kept
from sar_sim.options import find_scenario
from sar_sim.pool import add_work_options, in_parallel
from sar_sim.scenario import load_scenario, scenario_document
from sar_sim.squares import CONDITIONS, HEADER, Square, fly_square, summary


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the table; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="squares", description=__doc__)
    parser.add_argument("--scenario", default="arduplane", help="a scenario's name or YAML file")
    parser.add_argument("--rules", choices=RULE_SETS, default="deadbeat")
    add_work_options(parser, seeds=("seeds", 30))
    parser.add_argument("--only", default="", help="conditions whose name contains this")
    parser.add_argument("--watch-only", action="store_true", help="the monitor does nothing")
    args = parser.parse_args(argv)
    chosen = {name: value for name, value in CONDITIONS.items() if args.only in name}
    if not chosen:
        sys.stderr.write(f"squares: --only {args.only}: expected part of {', '.join(CONDITIONS)}\n")
        return 2
    try:
        scenario = load_scenario(find_scenario(args.scenario))
        seeds = range(args.first_seed, args.first_seed + args.seeds)
        about = {
            "work": "squares",
            "scenario": scenario_document(scenario),
            "rules": args.rules,
            "watch_only": args.watch_only,
        }
        kept = Kept(args.keep, about)
        sys.stdout.write(f"{scenario.name}, rules {args.rules}, {args.seeds} seeds\n{HEADER}\n")
        for name, condition in chosen.items():
            fly = partial(
                fly_square,
                base=scenario,
                condition=condition,
                rules=args.rules,
                watch_only=args.watch_only,
            )
            told = in_parallel(fly, seeds, args.jobs, kind=Square, kept=kept, part=name)
            sys.stdout.write(summary(name, condition, told) + "\n")
            sys.stdout.flush()
    except ValueError as error:
        sys.stderr.write(f"squares: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
