"""``detection``: how soon a slow-down is seen, and how often one is seen that is not there."""

from __future__ import annotations

import argparse
import math
import sys

import numpy as np
from tqdm import tqdm

from sar_estimator.estimator import HelicopterEstimator
from sar_estimator.geodesy import Datum
from sar_estimator.parameters import EstimatorParameters
from sar_estimator.states import Phase
from sar_sim.gps import SimulatedGps
from sar_sim.helicopter import PatternHelicopter
from sar_sim.scenario import Gps, Pattern, Pilot

DATUM = Datum(37.8, -122.8)
HOUR_S = 3600.0


def first_detection_s(helicopter: PatternHelicopter, gps: Gps, until_s: float) -> float:
    """Return when a deceleration is first detected [s], infinite when it is not."""
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    for reception in SimulatedGps(helicopter, gps, DATUM).due(until_s):
        velocity, time_s = reception.velocity, reception.fix.time_s
        if velocity is not None:
            estimator.add_velocity(time_s, velocity.vx_mps, velocity.vy_mps, velocity.sigma_mps)
        estimator.add_fix(reception.fix)
        if estimator.phase(time_s) is Phase.DECELERATING:
            return time_s
    return math.inf


def delay_s(gps: Gps, speed_mps: float, accel_mps2: float) -> float:
    """Return the delay of one detection [s]; negative when it came before the onset."""
    # The onset falls anywhere between two fixes.
    leg = 1400.0 + speed_mps * np.random.default_rng(gps.seed + 10**6).random() / gps.rate_hz
    pattern = Pattern(first_leg_m=leg, last_leg_m=500.0, corners=1)
    helicopter = PatternHelicopter(pattern, Pilot(), speed_mps, accel_mps2)
    onset_s = helicopter.corners[0].onset_time_s
    return first_detection_s(helicopter, gps, onset_s + 20.0) - onset_s


def main(argv: list[str] | None = None) -> int:
    """Run the study and print its table."""
    parser = argparse.ArgumentParser(prog="detection", description=__doc__)
    parser.add_argument("--seeds", type=int, default=300, help="corners flown")
    parser.add_argument("--hours", type=float, default=1.0, help="of straight flight, h")
    parser.add_argument("--sigma", type=float, default=3.0, help="of the fixes, m")
    parser.add_argument("--rate", type=float, default=1.0, help="of the fixes, Hz")
    parser.add_argument(
        "--doppler", type=float, default=0.0, help="sigma of velocity, m/s; 0: none"
    )
    parser.add_argument("--speed", type=float, default=20.0, help="V, m/s")
    parser.add_argument("--accel", type=float, default=2.5, help="a, m/s^2")
    args = parser.parse_args(argv)
    quiet = not sys.stderr.isatty()

    def receiver(seed: int) -> Gps:
        return Gps(args.rate, args.sigma, 0.0, args.doppler, seed)

    delays = np.array(
        [
            delay_s(receiver(seed), args.speed, args.accel)
            for seed in tqdm(range(args.seeds), unit="corner", disable=quiet, leave=False)
        ]
    )
    alarms = 0
    hours = math.ceil(args.hours)
    for hour in tqdm(range(hours), unit="h", disable=quiet, leave=False):
        length = args.speed * HOUR_S + 5000.0
        straight = PatternHelicopter(
            Pattern(first_leg_m=length, corners=1), Pilot(), args.speed, args.accel
        )
        duration = HOUR_S * min(1.0, args.hours - hour)
        alarms += math.isfinite(first_detection_s(straight, receiver(10**5 + hour), duration))
    seen = delays[np.isfinite(delays)]
    sys.stdout.write(
        f"{args.seeds} slow-downs of {args.accel} m/s^2 at {args.rate} Hz, sigma {args.sigma} m, "
        f"Doppler {args.doppler or 'none'}: median {np.median(seen):.2f} s, "
        f"p95 {np.percentile(seen, 95):.2f} s, "
        f"not seen {args.seeds - seen.size}, too early {(seen < 0.0).sum()}\n"
        f"{args.hours} h of straight flight: {alarms} false alarms\n"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
