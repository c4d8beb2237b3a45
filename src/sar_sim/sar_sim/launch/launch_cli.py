"""``launch``: starts every node of a flight, shows progress, stops them, writes the report."""

from __future__ import annotations

import argparse
import os
import signal
import socket
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import FrameType

import yaml
from ament_index_python.packages import get_package_prefix

from sar_bridge.mavlink.link import opener
from sar_estimator.common import priorities, topics
from sar_estimator.common.completion import add_completion, of_file, of_folder
from sar_estimator.common.node_support import Persistent
from sar_estimator.gps.source import check_url
from sar_planner.parameters.corner import PLANNERS, ParameterError
from sar_sim.autopilot.home_link import home_of
from sar_sim.bags.tracks import load_track
from sar_sim.jobs.processes import NodeProcess, run_apart
from sar_sim.launch.dds_cut import DdsCut
from sar_sim.launch.launch_plan import (
    ADDRESS_FILE,
    FlightOptions,
    NodeSpec,
    parameter_document,
    plan_nodes,
    read_tuned,
    with_autopilots,
)
from sar_sim.launch.watcher_node import HANGS_S, Watcher, start_watching
from sar_sim.scenario.faults import NodeFaults
from sar_sim.scenario.options import (
    add_flight_options,
    find_scenario,
    new_run_folder,
    scenario_folder,
    scenario_from,
)
from sar_sim.scenario.scenario import NODES, Scenario, read_document, scenario_document

TELL_TERMINAL_S, TELL_FILE_S = 0.5, 5.0
RESTARTS = 5
LEADING = (*NODES, "gps", "radio_hub")
"""The nodes that are started again when they end or hang."""
SETTLED_S = 3.0
ASK_AGAIN_S = 3.0
FAULT_SIGNALS = {"kill": signal.SIGKILL, "stop": signal.SIGSTOP, "go on": signal.SIGCONT}


class Flight:
    """The running nodes of one flight."""

    def __init__(self, specs: list[NodeSpec], out: Path, scenario: Scenario, speed: float) -> None:
        """Write the parameters. Raises ``OSError`` where a fault is not possible here."""
        self.out, self.bag = out, out / "bag"
        self.stopped_by = ""
        parameters = out / "params.yaml"
        parameters.write_text(yaml.safe_dump(parameter_document(specs)), encoding="utf-8")
        logs = out / "log"
        logs.mkdir(exist_ok=True)
        self.specs, self._parameters, self._logs = specs, parameters, logs
        self.nodes: list[NodeProcess] = []
        self.restarts = 0
        self._faults, self._speed = NodeFaults(scenario.faults, (*NODES, "dds")), speed
        cut = any(fault.component == "dds" for fault in scenario.faults)
        self._cut = DdsCut() if cut else None

    def start(self) -> None:
        """Start every node, unless the flight shall end already."""
        for spec in self.specs:
            if self.stopped_by:
                return
            self.nodes.append(self._run(spec))

    def _run(self, spec: NodeSpec) -> NodeProcess:
        program = Path(get_package_prefix(spec.package), "lib", spec.package, spec.executable)
        command = [str(program), "--ros-args", "--params-file", str(self._parameters)]
        if spec.uav:
            command += ["-r", f"__ns:=/{spec.uav}"]
        return NodeProcess(spec.name, command, self._logs / f"{spec.name.replace('/', '_')}.log")

    def restart(self, node: NodeProcess) -> bool:
        """Start a node again that has ended in flight; return False where that is no use.

        It takes up its work from latched topics. One that ends at once, or by its own decision,
        would do so again.
        """
        if node.name == "console" or (node.name == "record" and node.age_s > SETTLED_S):
            lost = "nothing is recorded any more" if node.name == "record" else "without a page"
            sys.stderr.write(
                f"launch: node {node.name} ended with exit code {node.exit_code}: flying on, "
                f"{lost}\n{node.last_lines()}\n"
            )
            self.nodes.remove(node)
            return True
        hopeless = node.exit_code in (0, 2) or node.age_s < SETTLED_S
        if not leads(node) or hopeless or self.restarts >= RESTARTS:
            return False
        self.restarts += 1
        sys.stderr.write(
            f"launch: node {node.name} ended with exit code {node.exit_code}: started again; "
            f"its last lines:\n{node.last_lines()}\n"
        )
        spec = next(item for item in self.specs if item.name == node.name)
        self.nodes[self.nodes.index(node)] = self._run(spec)
        return True

    def on_signal(self, number: int, _frame: FrameType | None) -> None:
        """Note that the flight shall end."""
        self.stopped_by = signal.Signals(number).name

    def ended(self) -> NodeProcess | None:
        """Return a node that has ended, None while all run."""
        return next((node for node in self.nodes if node.exit_code is not None), None)

    def watch(self, watcher: Watcher, engaging: dict[str, Persistent]) -> NodeProcess | None:
        """Show progress until a node ends for good or a signal comes; return the node."""
        terminal = sys.stdout.isatty()
        told = 0.0
        address: Path | None = self.out / ADDRESS_FILE
        while not self.stopped_by:
            if address is not None and address.exists():
                sys.stdout.write(f"operator's page: {address.read_text('utf-8')}")
                address = None
            ended = self.ended()
            if ended is not None and not self.restart(ended):
                return ended
            watcher.listen(0.1)
            for uav, asking in engaging.items():
                answer = asking.ask()
                if answer:
                    text = f"{uav} engage: {answer}".lstrip()
                    sys.stdout.write(f"\n{text}\n" if terminal else f"{text}\n")
            self._inject(watcher.time_s(self._speed))
            for node in self.nodes:
                if leads(node) and node.age_s > HANGS_S and watcher.hangs(node.name):
                    sys.stderr.write(f"launch: node {node.name} hangs: killed\n")
                    node.kill()
            if time.monotonic() - told > (TELL_TERMINAL_S if terminal else TELL_FILE_S):
                told = time.monotonic()
                text = watcher.line(self.bag)
                sys.stdout.write(f"\r\x1b[K{text}" if terminal else f"{text}\n")
                sys.stdout.flush()
        return None

    def _inject(self, time_s: float) -> None:
        """Inject the faults of nodes and of DDS that are due."""
        for name, action in self._faults.due(time_s):
            if self._cut is not None and name == "dds":
                (self._cut.on if action == "go on" else self._cut.off)()
            for node in self.nodes:
                if kind_of(node) == name:
                    node.signal(FAULT_SIGNALS[action])

    def stop(self) -> None:
        """Stop every node, the recorder last so that it hears the others to the end."""
        for node in reversed(self.nodes):
            if not node.stop():
                sys.stderr.write(f"launch: {node.name} did not stop and was killed\n")


def kind_of(node: NodeProcess) -> str:
    """Return a node's name without its namespace."""
    return node.name.rpartition("/")[2]


def leads(node: NodeProcess) -> bool:
    """Whether a node is started again when it ends or hangs."""
    return kind_of(node) in LEADING


def free_port(kind: socket.SocketKind = socket.SOCK_DGRAM) -> int:
    """Return a port of loopback that nobody uses; of UDP, unless otherwise asked for."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _arguments(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="launch.sh", description=__doc__)
    add_flight_options(parser, rule_sets=PLANNERS)
    parser.add_argument("--speed", type=float, help="times real time, default 10 in simulation")
    parser.add_argument(
        "--autopilot",
        action="append",
        default=[],
        metavar="[NAME=]URL",
        help="udp:H:P, tcp:H:P or /dev/NAME,BAUD; with the UAV's name where there are several",
    )
    parser.add_argument(
        "--engage", action="store_true", help="lead that autopilot's UAV as soon as it can be led"
    )
    parser.add_argument(
        "--gps", default="", metavar="URL", help="receiver: /dev/NAME,BAUD, tcp:, udp: or gpsd:HOST"
    )
    parser.add_argument(
        "--gcs", action="append", default=[], metavar="URL", help="ground station, udpout:H:P"
    )
    parser.add_argument(
        "--console-port", type=int, default=8080, metavar="PORT", help="of the operator's page"
    )
    tiles = parser.add_argument("--tiles", type=Path, metavar="DIR", help="map tiles, Z/X/Y.png")
    parser.add_argument("--no-console", action="store_true", help="without the operator's page")
    parser.add_argument("--no-sim", action="store_true", help="nothing simulated: a real flight")
    params = parser.add_argument(
        "--params", type=Path, help="node parameters, default config/params.yaml"
    )
    parser.add_argument(
        "--no-priorities", action="store_true", help="raise and lower no node's priority"
    )
    parser.add_argument("--setup", action="store_true", help="only set up and build")
    of_folder(tiles)
    of_file(params)
    add_completion(parser)
    return parser.parse_args(argv)


def prepare(args: argparse.Namespace) -> Flight:
    """Check everything that was asked for before anything is started.

    Raises ``ValueError`` in one line.
    """
    find_scenario(args.scenario)
    scenario = with_autopilots(scenario_from(args), args.autopilot)
    helicopter = "topic" if args.gps and args.helicopter == "sim" else args.helicopter
    options = FlightOptions(
        helicopter,
        scenario.formation[0].autopilot,
        args.rules,
        args.speed,
        simulation=not args.no_sim,
        watch_only=args.watch_only,
        engage=args.engage,
        gps=args.gps,
        gcs=tuple(args.gcs),
        console=0 if args.no_console else args.console_port,
        tiles="" if args.tiles is None else str(args.tiles.resolve()),
    )
    if args.tiles is not None:
        run_apart("sar_bridge.console.tiles:levels_of", args.tiles)
    if options.gps:
        check_url(options.gps)
    for member in scenario.formation:
        if member.autopilot:
            opener(member.autopilot)
    for url in options.gcs:
        opener(url, "--gcs")
    if options.autopilot and options.helicopter == "sim" and scenario.datum == Scenario().datum:
        scenario = replace(scenario, datum=home_of(options.autopilot))
    run_apart("sar_planner.rules.rule_sets:check_planner", args.rules, scenario.corner)
    if options.recorded:
        load_track(Path(options.helicopter))
    file = args.params or scenario_folder().parent / "params.yaml"
    tuned = read_tuned(read_document(file), str(file))
    out = new_run_folder(args.out).resolve()
    flown = out / "scenario.yaml"
    flown.write_text(yaml.safe_dump(scenario_document(scenario)), encoding="utf-8")
    ports = [free_port() for _ in scenario.formation]
    specs = plan_nodes(scenario, flown, options, bag=out / "bag", ports=ports, tuned=tuned)
    return Flight(specs, out, scenario, options.pace)


def main(argv: list[str] | None = None) -> int:
    """Fly; 0 when it ended in order, 1 when a node failed, 2 on bad input."""
    args = _arguments(argv)
    try:
        flight = prepare(args)
    except (OSError, ValueError, ParameterError) as error:
        sys.stderr.write(f"launch: {error}\n")
        return 2
    if args.no_priorities:
        os.environ.update([priorities.OFF])
    watcher = start_watching([spec.uav for spec in flight.specs if spec.executable == "planner"])
    engaging = {
        name: Persistent(watcher, topics.name_of(topics.of_uav(topics.ENGAGE, name)), ASK_AGAIN_S)
        for name in (watcher.uavs if args.engage else ())
    }
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, flight.on_signal)
    failed = None
    try:
        flight.start()
        ended = flight.watch(watcher, engaging)
        if ended is not None and not (ended.name == "sim" and ended.exit_code == 0):
            failed = ended
    finally:
        flight.stop()
        watcher.close()
    sys.stdout.write("\n")
    if failed is not None:
        sys.stderr.write(
            f"launch: node {failed.name} ended with exit code {failed.exit_code}; its last lines:\n"
            f"{failed.last_lines()}\n"
        )
    if flight.stopped_by:
        sys.stdout.write(f"stopped by {flight.stopped_by}\n")
    try:
        sys.stdout.write(run_apart("sar_sim.report.report_cli:reported", flight.bag, flight.out))
    except Exception as error:  # noqa: BLE001 - a cut bag may hold anything
        sys.stderr.write(f"launch: {flight.bag}: no report: {error}\n")
        return 1
    return 0 if failed is None else 1


if __name__ == "__main__":
    sys.exit(main())
