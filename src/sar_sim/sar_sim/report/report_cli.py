"""``report``: all figures and metrics from a bag."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from sar_estimator.bags.bag import BAG_ERRORS
from sar_sim.report.report import MONITOR_COUNTS, write_report


def summary_line(metrics: dict[str, Any]) -> str:
    """Return a run's results for the terminal: two lines, of several UAVs one more for each."""
    seen, apart = metrics["coverage_percent"], metrics["uavs_apart_m"]
    uavs: dict[str, dict[str, Any]] = metrics["uavs"]
    covered = f"coverage {'–' if seen is None else f'{seen:.2f} %'}"
    if not uavs:
        return f"{_lags(metrics)}\n{_nearest(metrics)}, {covered}{_alerts(metrics)}"
    lines = [f"{name}: {_lags(one)}; {_nearest(one)}{_alerts(one)}" for name, one in uavs.items()]
    between = "" if apart is None else f"; UAVs at least {apart:.1f} m apart"
    return "\n".join([*lines, f"{covered}{between}"])


def _lags(metrics: dict[str, Any]) -> str:
    lags = ", ".join(f"{lag:.1f}" for lag in metrics["lag_m"])
    return f"L(k) = {lags or '–'} m; rules {' '.join(metrics['rules']) or '–'}"


def _nearest(metrics: dict[str, Any]) -> str:
    nearest = metrics["min_separation_m"]
    return f"least separation {'–' if nearest is None else f'{nearest:.1f} m'}"


def _alerts(metrics: dict[str, Any]) -> str:
    counts = metrics["monitor"]["counts"]
    alerts = ", ".join(
        f"{counts[name]} {title}" for name, title in MONITOR_COUNTS if name in counts
    )
    return f"; {alerts}" if alerts else ""


def reported(bag: Path, out: Path) -> str:
    """Write a bag's report to a folder; return what to say of it."""
    return f"{summary_line(write_report(bag, out))}\n{out}/report.html\n"


def main(argv: list[str] | None = None) -> int:
    """Run the command; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="report", description=__doc__)
    parser.add_argument("bag", type=Path, help="bag folder")
    parser.add_argument("--out", type=Path, help="folder to write to, default beside the bag")
    args = parser.parse_args(argv)
    out = args.out or args.bag.parent
    try:
        said = reported(args.bag, out)
    except BAG_ERRORS as error:
        sys.stderr.write(f"report: {args.bag}: {error}\n")
        return 2
    sys.stdout.write(said)
    return 0


if __name__ == "__main__":
    sys.exit(main())
