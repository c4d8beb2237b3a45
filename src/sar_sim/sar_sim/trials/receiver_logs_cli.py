"""``receiver_logs``: real receivers' logs by a port, and by gpsd, beside gpsd's own answers."""

from __future__ import annotations

import argparse
import shutil
import socket
import sys
from pathlib import Path

from sar_sim.launch.launch_cli import free_port
from sar_sim.trials.receiver_logs import Comparison
from sar_sim.trials.receiver_terminal import by_gpsd, by_port

HEAD = f"{'log':20s} {'by':5s} {'fixes':>5s} {'compared':>8s} {'worst':>9s} {'worst':>9s} otherwise"


def line(way: str, found: Comparison) -> str:
    """Return a row of the table."""
    said = found.problem if found.fixes == 0 else ""
    return (
        f"{found.log:20s} {way:5s} {found.fixes:5d} {found.compared:8d} "
        f"{1e6 * found.worst_deg:7.3f}u° {found.worst_mps:6.3f}m/s {found.otherwise:5d}  {said}"
    ).rstrip()


def main(argv: list[str] | None = None) -> int:
    """Read all logs of a folder and print the table; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="receiver_logs", description=__doc__)
    parser.add_argument("folder", type=Path, help="with NAME.log and NAME.log.chk, as gpsd's tests")
    parser.add_argument("--no-gpsd", action="store_true", help="by a port alone")
    args = parser.parse_args(argv)
    logs = sorted(args.folder.glob("*.log"))
    if not logs:
        sys.stderr.write(f"receiver_logs: {args.folder}: expected NAME.log and NAME.log.chk\n")
        return 2
    gpsd = shutil.which("gpsd") or shutil.which("gpsd", path="/usr/sbin")
    sys.stdout.write(f"{HEAD}\n")
    for log in logs:
        sys.stdout.write(f"{line('port', by_port(log))}\n")
        if gpsd is not None and not args.no_gpsd:
            port = free_port(socket.SOCK_STREAM)
            sys.stdout.write(f"{line('gpsd', by_gpsd(log, gpsd, port))}\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
