"""``envelope``: on which courses, and at which speeds, a UAV keeps its place in a wind."""

from __future__ import annotations

import argparse
import math
import sys

from sar_estimator.common.pose import blown_mps
from sar_planner.guidance.leg_lag import drift_m
from sar_planner.guidance.steady_wind import SteadyWind
from sar_planner.guidance.wind_triangle import AirEnvelope

COURSES_DEG = range(0, 360, 45)


def pair(text: str) -> tuple[float, float]:
    """Read two numbers, ``10,45``. Raises ``ArgumentTypeError`` for anything else."""
    try:
        one, other = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: expected two numbers, A,B") from None
    if not math.isfinite(one + other) or one < 0.0:
        raise argparse.ArgumentTypeError(f"{text!r}: expected finite numbers, the first 0 or more")
    return one, other


def describe(air: AirEnvelope, speed_mps: float, leg_m: float) -> str:
    """Return a line for each course, and which speeds of the helicopter suit all of them.

    ``speed_mps``: the helicopter's. ``leg_m``: what the lag at a leg's beginning is told for.
    """
    lines = ["course  ground speed [m/s]  begins a leg with L [m]"]
    least, most = air.kept_mps
    for course_deg in COURSES_DEG:
        course = math.radians(90.0 - course_deg)
        slowest, fastest = air.on_course_mps(course)
        keeps = slowest <= speed_mps <= fastest
        lag_m = drift_m(air, course, speed_mps, leg_m)
        note = "" if keeps else f"  {speed_mps:g} m/s not kept"
        lines.append(f"{course_deg:03d}     {slowest:6.1f} to {fastest:<6.1f}{lag_m:19.0f}{note}")
    if least <= most:
        lines.append(f"kept on all courses, in gusts too: V from {least:.1f} to {most:.1f} m/s")
    else:
        lines.append(
            f"no V is kept on all courses in gusts: expected {least:.1f} m/s or more "
            f"with the wind, {most:.1f} or less against it"
        )
    return "\n".join(lines)


def main(argv: list[str] | None = None) -> int:
    """Print it; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="envelope", description=__doc__)
    parser.add_argument(
        "--wind", type=pair, required=True, metavar="MPS,FROM", help="speed, and from where [deg]"
    )
    parser.add_argument("--airspeed", type=pair, default=(10.0, 30.0), metavar="MIN,MAX")
    parser.add_argument("--speed", type=float, default=20.0, help="V, of the helicopter")
    parser.add_argument("--leg", type=float, default=2000.0, help="a leg's length [m]")
    args = parser.parse_args(argv)
    slowest, fastest = args.airspeed
    for name, value, good in (
        ("--airspeed", args.airspeed, slowest < fastest),
        ("--speed", args.speed, 0.0 < args.speed < math.inf),
        ("--leg", args.leg, 0.0 <= args.leg < math.inf),
    ):
        if not good:
            parser.error(f"{name} {value}: expected numbers above 0, MIN less than MAX")
    wind = blown_mps(*args.wind)
    steady = SteadyWind.after(None, wind, 0.0)
    air = AirEnvelope(slowest, fastest, wind, steady)
    sys.stdout.write(describe(air, args.speed, args.leg) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
