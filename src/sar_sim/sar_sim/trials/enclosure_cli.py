"""``enclosure``: the paper's rules, enclosed by interval arithmetic over lags and parameters."""

from __future__ import annotations

import argparse
import sys
import time
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

from sar_estimator.common.checked import read
from sar_planner.cli.corner import FIELDS
from sar_planner.parameters.corner import CornerParameters
from sar_sim.trials.enclosure.bounds import (
    MOST_BOXES,
    Enclosure,
    Spans,
    enclose,
    lag_m,
    spans_about,
)
from sar_sim.trials.enclosure.corner_pieces import FROM_M, RULES, TO_M

OPTIONS = {
    option: FIELDS[option] for option in ("speed", "radius", "accel", "spacing", "convergence")
}
DIGITS = Decimal("0.001")
COLUMNS = (
    "rule   least separation     near L          L(k+1) within       |L(k+1)| within    boxes  [m]"
)


def outwards(bounds: tuple[float, float]) -> str:
    """Return a lower and an upper bound as text, neither of them rounded inwards."""
    ways = (ROUND_FLOOR, ROUND_CEILING)
    exact = (Decimal(one) for one in bounds)
    rounded = (
        one.quantize(DIGITS, way) if one.is_finite() else one
        for one, way in zip(exact, ways, strict=True)
    )
    return "".join(f"{one:10}" for one in rounded)


def line_of(found: Enclosure, spans: Spans) -> str:
    """Return a rule's line of the table."""
    least = outwards((found.separation.low, found.separation.high))
    return (
        f"{found.rule} {least} {lag_m(found, spans):10.2f}   {outwards(found.next_lags_m)}"
        f"  {outwards(found.lag_sizes_m)} {found.boxes:8d}"
    )


def table(p: CornerParameters, percent: float, tolerance_m: float, most_boxes: int) -> list[str]:
    """Return the table over a box about ``p``; raises what ``spans_about`` and ``enclose`` do."""
    spans = spans_about(p, percent)
    about = (
        f"V {p.speed_mps:g} m/s, R {p.turn_radius_m:g} m, a {p.accel_mps2:g} m/s2, "
        f"d {p.spacing_m:g} m, c {p.convergence:g}, each +- {percent:g} %; "
        f"L from {FROM_M} to {TO_M} m"
    )
    lines = [about, COLUMNS]
    wide = False
    for rule in RULES:
        found = enclose(rule, spans, tolerance_m=tolerance_m, most_boxes=most_boxes)
        lines.append(line_of(found, spans))
        values = (found.separation, found.least_lag, found.greatest_lag)
        wide |= any(one.high - one.low > tolerance_m for one in values)
    if wide:
        lines.append(
            f"bounds more than {tolerance_m:g} m apart: --boxes {most_boxes} were looked at"
        )
    return lines


def main(argv: list[str] | None = None) -> int:
    """Print a table for each box; 2 on parameters that the rules do not hold for."""
    parser = argparse.ArgumentParser(prog="enclosure", description=__doc__)
    parser.add_argument(
        "--box",
        type=float,
        nargs="+",
        default=[0.0, 1.0],
        metavar="PERCENT",
        help="V, R, a, d and c by so much to both sides, all at once (default: 0 and 1)",
    )
    parser.add_argument("--tolerance", type=float, default=0.05, metavar="M", help="default: 0.05")
    parser.add_argument(
        "--boxes", type=int, default=MOST_BOXES, help=f"most of one value (default: {MOST_BOXES})"
    )
    for option, field in OPTIONS.items():
        parser.add_argument(f"--{option}", type=float, help=f"{field}, instead of the paper's")
    args = parser.parse_args(argv)
    if not args.tolerance > 0.0:
        parser.error(f"--tolerance {args.tolerance:g}: expected more than 0")
    try:
        given = {field: getattr(args, option) for option, field in OPTIONS.items()}
        p = read(CornerParameters, {name: one for name, one in given.items() if one is not None})
        for percent in args.box:
            begun = time.monotonic()
            lines = table(p, percent, args.tolerance, args.boxes)
            sys.stdout.write("\n".join([*lines, f"{time.monotonic() - begun:.1f} s", ""]) + "\n")
    except ValueError as error:
        sys.stderr.write(f"enclosure: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
