"""``import_track``: a CSV track into a bag of NavSatFix."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

from rosbags.rosbag2 import WriterError

from sar_estimator.bags.bag import BagWriter, serialised
from sar_estimator.common import topics
from sar_estimator.common.conversions import fix_to_message
from sar_estimator.common.track_csv import read_track

FIX_KIND = "sensor_msgs/msg/NavSatFix"


def import_track(track: Path, bag: Path) -> int:
    """Write every fix of ``track`` that has a time to a new bag; return how many."""
    fixes = [fix for fix in read_track(track) if math.isfinite(fix.time_s)]
    writer = BagWriter(bag)
    try:
        for fix in fixes:
            data = serialised(FIX_KIND, fix_to_message(fix))
            writer.write(topics.FIX, FIX_KIND, data, fix.time_s)
    finally:
        writer.close()
    return len(fixes)


def main(argv: list[str] | None = None) -> int:
    """Run the command; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="import_track", description=__doc__)
    parser.add_argument("track", type=Path, help="CSV: time_s, latitude_deg, longitude_deg, ...")
    parser.add_argument("bag", type=Path, help="bag folder to create")
    args = parser.parse_args(argv)
    try:
        count = import_track(args.track, args.bag)
    except (OSError, ValueError, WriterError) as error:
        sys.stderr.write(f"import_track: {error}\n")
        return 2
    sys.stdout.write(f"{args.bag}: {count} fixes\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
