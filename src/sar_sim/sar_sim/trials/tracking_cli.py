"""``tracking``: how accurately corners are flown: recorded, simulated, on our waypoints."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav, Wind
from sar_sim.trials.recordings import Recording, RecordingError, load_recording, names_in, refly
from sar_sim.trials.tracking import (
    CASES,
    FloatArray,
    Flown,
    distances_m,
    fly_guided,
    measure,
    rms,
)

ARDUPLANE = Uav(autopilot="arduplane", **AUTOPILOTS["arduplane"])  # type: ignore[arg-type]
PERIOD_10 = replace(ARDUPLANE, l1_period_s=10.0)
WIND_6 = Wind(6.0, 45.0)
TUNINGS: dict[str, tuple[Uav, Wind]] = {
    "NAVL1_PERIOD 15": (ARDUPLANE, Wind()),
    "NAVL1_PERIOD 10": (PERIOD_10, Wind()),
    "NAVL1_PERIOD 10, wind 6 m/s": (PERIOD_10, WIND_6),
    "NAVL1_PERIOD 12, wind 6 m/s": (replace(ARDUPLANE, l1_period_s=12.0), WIND_6),
}


def compare(folder: Path) -> list[str]:
    """Return a table: recorded flights and the simulated autopilot on the same missions.

    Raises ``RecordingError`` for a folder without recordings, and for one that cannot be measured.
    """
    names = names_in(folder)
    width = max(32, *map(len, names))
    lines = [
        "extra: flown minus planned; off: rms off the planned path; apart: rms between the tracks",
        f"{'recording':{width}s}   extra     sim   diff    off   sim  apart  [m]",
    ]
    for name in names:
        recording = load_recording(folder, name)
        flown = _measured(recording.points, recording, "recorded")
        simulated = _measured(refly(recording), recording, "simulated")
        apart = rms(distances_m(simulated.points, flown.points))
        lines.append(
            f"{name:{width}s}{flown.extra_m:8.1f}{simulated.extra_m:8.1f}"
            f"{simulated.extra_m - flown.extra_m:7.1f}{flown.off_m:7.1f}"
            f"{simulated.off_m:6.1f}{apart:7.2f}"
        )
    return lines


def _measured(points: FloatArray, recording: Recording, what: str) -> Flown:
    found = measure(points, recording.case)
    if found is None:
        raise RecordingError(
            f"{recording.name}: the {what} track does not fly the whole corner, from "
            f"run_in_m = {recording.case.run_in_m:g} before its onset to "
            f"finish_m = {recording.case.finish_m:g} behind it"
        )
    return found


def guided() -> list[str]:
    """Return a table: the planner's waypoints, flown open loop by the simulated autopilot."""
    lines = [
        f"{'waypoints of the planner, open loop':36s}"
        + "".join(f"{case + ' extra':>10s}{'off':>6s}" for case in CASES)
        + "  [m]"
    ]
    for name, (uav, wind) in TUNINGS.items():
        line = f"{name:36s}"
        for case in CASES.values():
            flown = measure(fly_guided(case, uav=uav, wind=wind), case)
            line += (
                f"{'-':>10s}{'-':>6s}"
                if flown is None
                else (f"{flown.extra_m:10.1f}{flown.off_m:6.1f}")
            )
        lines.append(line)
    return lines


def main(argv: list[str] | None = None) -> int:
    """Print the tables; 2 on recordings that cannot be read."""
    parser = argparse.ArgumentParser(prog="tracking", description=__doc__)
    parser.add_argument(
        "--data",
        type=Path,
        metavar="FOLDER",
        help="of recorded flights: NAME.yaml, NAME_waypoints.csv, NAME_track.csv",
    )
    args = parser.parse_args(argv)
    try:
        lines = [] if args.data is None else [*compare(args.data), ""]
    except RecordingError as error:
        sys.stderr.write(f"tracking: {error}\n")
        return 2
    sys.stdout.write("\n".join([*lines, *guided()]) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
