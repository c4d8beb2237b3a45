"""``export``: a bag's tracks, swaths, marks and last list for other tools."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

from sar_estimator.bags.bag import BAG_ERRORS, read_messages
from sar_estimator.common import topics
from sar_estimator.common.completion import add_completion, of_folder
from sar_estimator.common.conversions import from_stamp, path_to_points
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import Mark
from sar_sim.export.flight_export import FORMATS, FlightExport, TrackPoints
from sar_sim.world.wires import ALL_WIRES

AIRCRAFT = {topics.HELICOPTER_ODOMETRY: "helicopter", topics.UAV_ODOMETRY: "uav"}
WANTED = {*AIRCRAFT, topics.DATUM, topics.FIX, topics.MARKS, topics.CLEARED}
STEP_S = 1.0


def read_export(bag: Path, *, swath_m: float, waypoints_m: float) -> FlightExport:
    """Read a bag; ``waypoints_m``: the waypoints' altitude above home.

    Raises ``ValueError`` when it has no datum, or no position of the helicopter.
    """
    datum: Datum | None = None
    altitude_m = 0.0
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in AIRCRAFT.values()}
    marks: tuple[Mark, ...] = ()
    waypoints = np.empty((0, 2))
    for topic, _, message in read_messages(bag, WANTED):
        if topic == topics.DATUM:
            datum = ALL_WIRES[topic].from_message(message)
        elif topic == topics.FIX:
            altitude_m = message.altitude
        elif topic == topics.MARKS:
            marks = ALL_WIRES[topic].from_message(message)
        elif topic == topics.CLEARED and message.poses:
            waypoints = path_to_points(message)
        elif topic in AIRCRAFT:
            _add(rows[AIRCRAFT[topic]], message, altitude_m)
    if datum is None:
        raise ValueError("bag without /datum: nothing can be placed on the earth")
    tracks = {
        name: TrackPoints(points[:, 0], points[:, 1:])
        for name, points in ((name, np.array(found)) for name, found in rows.items() if found)
    }
    if "helicopter" not in tracks:
        raise ValueError("bag without /helicopter/odometry: nothing to export")
    return FlightExport(bag.parent.name, datum, tracks, marks, waypoints, swath_m, waypoints_m)


def _add(rows: list[tuple[float, ...]], message: Any, altitude_m: float) -> None:
    """Append a position, one in a second; the helicopter's altitude is its receiver's."""
    time_s = from_stamp(message.header.stamp)
    if rows and 0.0 <= time_s - rows[-1][0] < STEP_S:
        return
    place = message.pose.pose.position
    is_uav = message.child_frame_id == "uav"
    rows.append((time_s, place.x, place.y, place.z if is_uav else altitude_m))


def main(argv: list[str] | None = None) -> int:
    """Write the file; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="export", description=__doc__)
    of_folder(parser.add_argument("bag", type=Path, help="bag folder"))
    parser.add_argument("--format", choices=FORMATS, default="gpx", help="of the file")
    parser.add_argument("--out", type=Path, help="file to write, default beside the bag")
    parser.add_argument("--swath", type=float, default=250.0, help="width that each sees, metres")
    parser.add_argument("--altitude", type=float, default=150.0, help="of waypoints, above home")
    add_completion(parser)
    args = parser.parse_args(argv)
    out = args.out or args.bag.parent / f"flight.{args.format}"
    try:
        flight = read_export(args.bag, swath_m=args.swath, waypoints_m=args.altitude)
        out.write_text(FORMATS[args.format](flight), encoding="utf-8")
    except BAG_ERRORS as error:
        sys.stderr.write(f"export: {args.bag}: {error}\n")
        return 2
    sys.stdout.write(f"{out}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
