"""``replay``: a bag through the modules that flew it, and the first difference from the record."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from sar_estimator.bags.bag import BAG_ERRORS, BagWriter, open_bag, read_messages
from sar_estimator.common import topics
from sar_estimator.common.checked import changed
from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS, EstimatorParameters
from sar_sim.flight.replay import (
    FIGURES,
    INPUTS,
    Comparison,
    Event,
    Tolerance,
    compare,
    flown_with,
    replay,
)


def told(found: Comparison, recorded: list[Event], *, all_of_them: bool) -> str:
    """Return the comparison in lines for the terminal."""
    lines = [f"{topic:<24} {same:6d} the same" for topic, same in found.same.items()]
    if not found.differences:
        return "\n".join([*lines, "no difference"])
    begun_s = recorded[0][1]
    shown = found.differences if all_of_them else found.differences[:1]
    lines += [
        f"t = {one.time_s:.2f} s ({one.time_s - begun_s:.2f} s after the start), "
        f"{one.topic}: {one.what}"
        for one in shown
    ]
    lines.append(f"{len(found.differences)} differences" + ("" if all_of_them else "; the first"))
    return "\n".join(lines)


def write_reference(bag: Path, folder: Path) -> None:
    """Write what a replay needs of a bag to another one."""
    written = BagWriter(folder)
    try:
        with open_bag(bag) as reader:
            chosen = [one for one in reader.connections if one.topic in (*FIGURES, *INPUTS)]
            for connection, timestamp, raw in reader.messages(connections=chosen):
                written.write(connection.topic, connection.msgtype, bytes(raw), timestamp * 1e-9)
    finally:
        written.close()


def replayed(
    bag: Path,
    limits: Tolerance,
    *,
    estimator: EstimatorParameters,
    velocity_sigma_mps: float,
) -> tuple[Comparison, list[Event]]:
    """Return how a bag's flight differs, and its events. Raises ``ValueError`` for one without."""
    events = list(read_messages(bag))
    if not any(topic == topics.FIX for topic, _, _ in events):
        raise ValueError(f"no {topics.FIX}: expected a recorded flight")
    flown = flown_with(events, estimator, velocity_sigma_mps)
    return compare(events, replay(events, flown), limits), events


def main(argv: list[str] | None = None) -> int:
    """Run the command; 1 where the flights differ, 2 on bad input."""
    limits = Tolerance()
    parser = argparse.ArgumentParser(prog="replay", description=__doc__)
    parser.add_argument("bag", type=Path, help="bag folder")
    parser.add_argument(
        "--tolerance", type=float, default=limits.figures, help="of figures, in their unit"
    )
    parser.add_argument(
        "--time-tolerance", type=float, default=limits.time_s, help="of a message's time, s"
    )
    usual = EstimatorParameters().default_fix_sigma_m
    parser.add_argument(
        "--fix-sigma", type=float, default=usual, help="of fixes without covariance, m"
    )
    parser.add_argument(
        "--velocity-sigma",
        type=float,
        default=VELOCITY_SIGMA_MPS,
        help="of the receiver's velocity, m/s",
    )
    parser.add_argument("--all", action="store_true", help="every difference, not the first only")
    parser.add_argument(
        "--reference", type=Path, help="write what a replay needs of the bag to this folder"
    )
    args = parser.parse_args(argv)
    try:
        found, events = replayed(
            args.bag,
            Tolerance(args.tolerance, args.time_tolerance),
            estimator=changed(EstimatorParameters(), default_fix_sigma_m=args.fix_sigma),
            velocity_sigma_mps=args.velocity_sigma,
        )
        if args.reference is not None:
            write_reference(args.bag, args.reference)
    except BAG_ERRORS as error:
        sys.stderr.write(f"replay: {args.bag}: {error}\n")
        return 2
    sys.stdout.write(told(found, events, all_of_them=args.all) + "\n")
    return 1 if found.differences else 0


if __name__ == "__main__":
    sys.exit(main())
