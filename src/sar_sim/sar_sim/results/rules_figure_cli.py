"""``rules_figure``: L(k+1) and closest approach against L(k) for both rule sets, side by side."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from sar_planner.parameters.corner import RULE_SETS, CornerParameters
from sar_planner.prediction.separation import closest_approach
from sar_planner.rules.rule_sets import make_rule_set
from sar_sim.report.coverage import FloatArray
from sar_sim.report.figures import draw_rules


def sweep(name: str, parameters: CornerParameters, lags_m: FloatArray) -> dict[str, FloatArray]:
    """Return a rule set's L(k+1) and closest approach [m] for every lag."""
    automaton = make_rule_set(name, parameters)
    plans = [automaton.plan(float(lag)) for lag in lags_m]
    return {
        "lag": lags_m,
        "next": np.array([plan.next_lag_m for plan in plans]),
        "closest": np.array([closest_approach(p.path, parameters).distance_m for p in plans]),
    }


def main(argv: list[str] | None = None) -> int:
    """Draw it and print the extremes; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="rules_figure", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("rules.png"))
    parser.add_argument("--step", type=float, default=5.0, help="between lags, m")
    parser.add_argument("--lags", type=float, nargs=2, default=(-800.0, 1400.0))
    args = parser.parse_args(argv)
    parameters = CornerParameters()
    low, high = args.lags
    if not (args.step > 0.0 and high > low):
        sys.stderr.write(
            f"rules_figure: --lags {low} {high} --step {args.step}: expected a range\n"
        )
        return 2
    lags = np.arange(low, high + 0.5 * args.step, args.step)
    series = {name: sweep(name, parameters, lags) for name in reversed(RULE_SETS)}
    for name, values in series.items():
        nearest, worst = values["closest"].argmin(), np.abs(values["next"]).argmax()
        sys.stdout.write(
            f"{name}: closest approach {values['closest'][nearest]:.2f} m at L = "
            f"{lags[nearest]:.0f} m; largest |L(k+1)| {abs(values['next'][worst]):.1f} m at L = "
            f"{lags[worst]:.0f} m\n"
        )
        for begin, end in ((-800, -150), (-150, 470), (470, 625), (625, 1400)):
            part = np.abs(values["next"][(lags >= begin) & (lags <= end)])
            if part.size:
                sys.stdout.write(f"  L {begin} ... {end}: |L(k+1)| <= {part.max():.2f} m\n")
    draw_rules(series, parameters.separation_m, args.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
