"""``faults``: flies the whole graph with every fault in turn and prints what came of it."""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml

from sar_sim.jobs.processes import launch_command
from sar_sim.launch.dds_cut import IN_OWN_NETWORK, own_network_possible
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Fault, Scenario, load_scenario, scenario_document
from sar_sim.trials.fault_runs import CASES, HEADER, fault_scenario, fault_speed, read_run

PATIENCE_S = 400.0


def fly(fault: Fault, base: Scenario, out: Path) -> Path:
    """Fly the graph with a fault into ``out``, unless that was done; return the bag.

    Raises ``OSError`` if it failed.
    """
    bag, file = out / "run" / "bag", out / "fault.yaml"
    flown = yaml.safe_dump(scenario_document(fault_scenario(base, fault)))
    whole = (bag / "metadata.yaml").exists()
    if whole and file.exists() and file.read_text("utf-8") == flown:
        return bag
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    file.write_text(flown, "utf-8")
    speed = f"{fault_speed(fault):g}"
    command = launch_command(out / "run", "--scenario", str(file), "--speed", speed)
    if fault.component == "dds":
        command = [*IN_OWN_NETWORK, *command]
    done = subprocess.run(  # noqa: S603
        command, capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )
    if done.returncode != 0:
        raise OSError(f"{fault.component} {fault.kind}: the flight failed:\n{done.stderr}")
    return bag


def main(argv: list[str] | None = None) -> int:
    """Fly them and print the table, a row after each flight; 1 when one failed."""
    parser = argparse.ArgumentParser(prog="faults", description=__doc__)
    parser.add_argument("--scenario", default="arduplane", help="a scenario's name or YAML file")
    parser.add_argument("--only", default="", help="components that begin with this")
    parser.add_argument("--keep", type=Path, help="keep the flights here, and go on")
    args = parser.parse_args(argv)
    chosen = [fault for fault in CASES if fault.component.startswith(args.only)]
    if any(fault.component == "dds" for fault in chosen) and not own_network_possible():
        sys.stderr.write("faults: dds: left out: `unshare -rn` with tc is not possible here\n")
        chosen = [fault for fault in chosen if fault.component != "dds"]
    failed = 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = args.keep or Path(scratch)
        try:
            base = load_scenario(find_scenario(args.scenario))
            folder.mkdir(parents=True, exist_ok=True)
        except (OSError, ValueError) as error:
            sys.stderr.write(f"faults: {error}\n")
            return 2
        sys.stdout.write(HEADER + "\n")
        for i, fault in enumerate(chosen):
            out = folder / f"{i:02d}_{fault.component}_{fault.kind}"
            try:
                row = read_run(fault, fly(fault, base, out)).row()
            except (OSError, ValueError, subprocess.TimeoutExpired) as error:
                failed += 1
                sys.stderr.write(f"faults: {error}\n")
                continue
            sys.stdout.write(row + "\n")
            sys.stdout.flush()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
