"""``filter_track``: the helicopter's filter over a recorded track, offline."""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path

from sar_estimator.common.checked import changed
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.track_csv import read_track, read_velocities
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.parameters import EstimatorParameters

TRANSPONDER_SIGMA_MPS = 3.0
"""Of a velocity in a recorded track [m/s]. Most are of ADS-B: NACv 2 is 3 m/s in 95 %, but the
message is up to a second old, in which a turning helicopter changes by as much again."""
COLUMNS = (
    "time_s",
    "x_m",
    "y_m",
    "vx_mps",
    "vy_mps",
    "ax_mps2",
    "ay_mps2",
    "phase",
    "next_x_m",
    "next_y_m",
)


def filter_fixes(
    fixes: list[Fix],
    estimator: HelicopterEstimator,
    velocities: Sequence[tuple[float, float]] = (),
    velocity_sigma_mps: float = TRANSPONDER_SIGMA_MPS,
) -> list[tuple[float | str, ...]]:
    """Filter a track; one row of ``COLUMNS`` per fix, with NaN where nothing is known yet.

    ``velocities``: east and north [m/s] with every fix, NaN where it has none; or none at all.
    """
    rows: list[tuple[float | str, ...]] = []
    for i, (fix, velocity) in enumerate(zip_longest(fixes, velocities)):
        estimator.add_fix(fix)
        if velocity is not None and math.isfinite(sum(velocity)):
            estimator.add_velocity(fix.time_s, velocity[0], velocity[1], velocity_sigma_mps)
        now = estimator.predict(fix.time_s) if math.isfinite(fix.time_s) else None
        if now is None:
            rows.append((fix.time_s, *([math.nan] * 6), "lost", math.nan, math.nan))
            continue
        later = fixes[min(i + 1, len(fixes) - 1)].time_s
        ahead = estimator.predict(later) if math.isfinite(later) else None
        m, n = now.motion, (ahead or now).motion
        phase = str(estimator.phase(fix.time_s))
        rows.append(
            (
                *(fix.time_s, m.x_m, m.y_m, m.vx_mps, m.vy_mps, m.ax_mps2, m.ay_mps2),
                *(phase, n.x_m, n.y_m),
            )
        )
    return rows


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else f"{value:.6f}"


def _positive(text: str) -> float:
    value = float(text)
    if not value > 0.0:
        raise argparse.ArgumentTypeError(f"{text}: expected a positive number")
    return value


def main(argv: list[str] | None = None) -> int:
    """Run the command; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="filter_track", description=__doc__)
    parser.add_argument(
        "track",
        type=Path,
        help="CSV: time_s, latitude_deg, longitude_deg; groundspeed_mps and track_deg are used "
        "where it has them",
    )
    parser.add_argument("--out", type=Path, required=True, help="CSV to write")
    parser.add_argument("--sigma", type=float, help="standard deviation of the fixes [m]")
    parser.add_argument(
        "--velocity-sigma",
        type=_positive,
        default=TRANSPONDER_SIGMA_MPS,
        help="standard deviation of the track's velocities [m/s]; inf: do not use them",
    )
    parser.add_argument(
        "--datum", type=float, nargs=2, metavar=("LAT", "LON"), help="map origin [deg]"
    )
    args = parser.parse_args(argv)
    try:
        parameters = EstimatorParameters()
        if args.sigma is not None:
            parameters = changed(parameters, default_fix_sigma_m=args.sigma)
        datum = Datum(*args.datum) if args.datum else None
        estimator = HelicopterEstimator(parameters, datum)
        velocities = read_velocities(args.track) if math.isfinite(args.velocity_sigma) else ()
        rows = filter_fixes(read_track(args.track), estimator, velocities, args.velocity_sigma)
        with args.out.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(COLUMNS)
            writer.writerows([_cell(value) for value in row] for row in rows)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"filter_track: {error}\n")
        return 2
    used = ", ".join(f"{count} {name}" for name, count in estimator.counts.items() if count)
    sys.stdout.write(f"{args.out}: {len(rows)} rows ({used})\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
