"""``detection``: how soon a corner is seen, and how often one is seen that is not there."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from sar_estimator.common.checked import changed
from sar_planner.parameters.corner import CornerParameters
from sar_sim.campaign.detection import (
    Watched,
    corner_flight,
    pilot_of,
    receiver_of,
    straight_flight,
)
from sar_sim.jobs.pool import Workers
from sar_sim.scenario.presets import RECEIVERS
from sar_sim.scenario.scenario import Gps, Pilot

PILOT_KINDS = ("robot", "steady", "human", "rough", "rolled")
RECEIVER_KINDS = (*(kind for kind in RECEIVERS if kind != "plain"), "modern-no-doppler")
TOLD_M = 1400.0


@dataclass(frozen=True)
class Settings:
    """What one row of the table is of."""

    pilot: str
    receiver: str
    rate_hz: float
    speed_mps: float
    accel_mps2: float
    told_off_m: float | None = None

    def drawn(self, seed: int) -> tuple[Pilot, Gps]:
        """Return pilot and receiver of a seed."""
        kind, without, _ = self.receiver.partition("-no-doppler")
        gps = receiver_of(kind, seed, doppler=not without)
        return pilot_of(self.pilot, seed), replace(gps, rate_hz=self.rate_hz)


def _corners(settings: Settings, seed: int) -> Watched:
    pilot, gps = settings.drawn(seed)
    return corner_flight(
        pilot,
        gps,
        speed_mps=settings.speed_mps,
        accel_mps2=settings.accel_mps2,
        told_off_m=settings.told_off_m,
    )


def _hour(settings: Settings, hours: float, seed: int) -> Watched:
    pilot, gps = settings.drawn(10**5 + seed)
    told = () if settings.told_off_m is None else (TOLD_M,)
    return straight_flight(pilot, gps, hours, speed_mps=settings.speed_mps, told_m=told)


def row(settings: Settings, squares: list[Watched], hours: list[Watched]) -> str:
    """Return one row of the table."""
    delays = np.array([delay for flight in squares for delay in flight.delays_s])
    seen = delays[np.isfinite(delays)]
    flown_h = sum(flight.flown_s for flight in hours) / 3600.0
    median, late = np.percentile(seen, (50, 95)) if seen.size else (np.nan, np.nan)
    return (
        f"{settings.pilot:8s}{settings.receiver:19s}{delays.size:8d}{median:9.2f}{late:7.2f}"
        f"{delays.size - seen.size:9d}{sum(flight.withdrawn for flight in squares):11d}"
        f"{sum(flight.alarms for flight in squares):8d}"
        f"{sum(flight.alarms for flight in hours):8d}/{flown_h:.0f} h"
        f"{sum(flight.unled_s for flight in (*squares, *hours)):9.0f}"
    )


HEADER = (
    f"{'pilot':8s}{'receiver':19s}{'corners':>8s}{'median':>9s}{'95 %':>7s}{'not seen':>9s}"
    f"{'withdrawn':>11s}{'false':>8s}{'straight':>13s}{'unled s':>9s}"
)


def main(argv: list[str] | None = None) -> int:
    """Run the study and print its table; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="detection", description=__doc__)
    parser.add_argument("--squares", type=int, default=25, help="of eight corners, flown")
    parser.add_argument("--hours", type=int, default=20, help="of straight flight, h")
    parser.add_argument("--pilots", nargs="+", choices=PILOT_KINDS, default=PILOT_KINDS)
    parser.add_argument("--receivers", nargs="+", choices=RECEIVER_KINDS, default=RECEIVER_KINDS)
    parser.add_argument("--rate", type=float, default=1.0, help="of the fixes, Hz")
    parser.add_argument("--speed", type=float, default=20.0, help="V, m/s")
    parser.add_argument("--accel", type=float, default=2.5, help="a, m/s^2")
    parser.add_argument(
        "--told",
        type=float,
        metavar="M",
        help="legs are told of beforehand, by so much longer than they are; straight on, as 1400 m",
    )
    parser.add_argument("--jobs", type=int, help="processes")
    args = parser.parse_args(argv)
    try:
        changed(Gps(), rate_hz=args.rate)
        changed(CornerParameters(), speed_mps=args.speed, accel_mps2=args.accel)
    except ValueError as error:
        sys.stderr.write(f"detection: {error}\n")
        return 2
    sys.stdout.write(f"{HEADER}\n")
    with Workers(args.jobs) as workers:
        for pilot in args.pilots:
            for receiver in args.receivers:
                settings = Settings(pilot, receiver, args.rate, args.speed, args.accel, args.told)
                squares = workers.map(partial(_corners, settings), range(args.squares))
                hours = workers.map(partial(_hour, settings, 1.0), range(args.hours))
                sys.stdout.write(f"{row(settings, list(squares), list(hours))}\n")
                sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
