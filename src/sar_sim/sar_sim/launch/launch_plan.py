"""Which nodes a flight needs, with which parameters. Pure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from sar_bridge.mavlink.link import GROUND_SYSTEM
from sar_planner.rules.paper_rules import Rule
from sar_sim.scenario.monitor import limits_of, model_of
from sar_sim.scenario.options import RECORDED_FIX_SIGMA_M
from sar_sim.scenario.scenario import Scenario, ScenarioError

ADDRESS_FILE = "console.txt"
"""In the results folder: the address of the operator's page, with its token."""


@dataclass(frozen=True)
class FlightOptions:
    """What was asked for on the command line.

    ``helicopter``: ``sim``, ``topic``, or the path of a track. ``autopilot``: the first UAV's URL,
    empty where the UAVs are simulated. ``speed``: times real time, None for the default.
    ``watch_only``: the monitor says what it sees and does nothing. ``engage``: an autopilot that is
    not simulated here is engaged as soon as the planner agrees. ``gps``: URL of the helicopter's
    receiver, empty where another driver gives its fixes. ``gcs``: URLs of ground stations beside.
    ``console``: port of the operator's page, 0 for none. ``tiles``: folder of map tiles for it.
    """

    helicopter: str = "sim"
    autopilot: str = ""
    rules: str = "deadbeat"
    speed: float | None = None
    simulation: bool = True
    watch_only: bool = False
    engage: bool = False
    gps: str = ""
    gcs: tuple[str, ...] = ()
    console: int = 0
    tiles: str = ""

    def __post_init__(self) -> None:
        """Refuse combinations that make no flight."""
        if not self.simulation and not self.autopilot:
            raise ScenarioError("--no-sim: expected --autopilot URL, the UAV's autopilot")
        if self.gps and self.helicopter != "topic":
            raise ScenarioError(f"--gps {self.gps}: expected no --helicopter {self.helicopter}")
        if not self.simulation and self.helicopter != "topic":
            raise ScenarioError("--no-sim: expected --gps URL, or --helicopter topic, a live fix")
        if self.watch_only and not self.simulation:
            raise ScenarioError("--watch-only: expected a simulation, not a real flight")
        if self.engage and self.live:
            raise ScenarioError("--engage: expected a simulation; in a flight the operator engages")
        if self.engage and not self.autopilot:
            raise ScenarioError("--engage: expected --autopilot URL; the simulated UAV is engaged")
        if self.rules == "follow" and not self.simulation:
            raise ScenarioError("--rules follow keeps no separation: expected a simulation")
        if self.speed is not None and not 0.0 < self.speed <= 100.0:
            raise ScenarioError(f"--speed {self.speed}: expected more than 0, at most 100")
        if self.speed not in (None, 1.0) and self.helicopter == "topic":
            raise ScenarioError(f"--speed {self.speed}: a live helicopter flies at 1")

    @property
    def recorded(self) -> bool:
        """Whether a recorded track is flown."""
        return self.helicopter not in ("sim", "topic")

    @property
    def live(self) -> bool:
        """Whether the helicopter is a real one."""
        return self.helicopter == "topic"

    @property
    def pace(self) -> float:
        """Times real time: 10 for a whole simulation, 1 as soon as anything is real."""
        if self.speed is not None:
            return self.speed
        return 1.0 if self.live or self.autopilot else 10.0


@dataclass(frozen=True)
class NodeSpec:
    """One process: the executable of a package, and its node's name and parameters.

    ``uav``: the namespace of a UAV's own node, empty for none.
    """

    package: str
    executable: str
    parameters: dict[str, Any] = field(default_factory=dict)
    uav: str = ""

    @property
    def name(self) -> str:
        """The node's name with its namespace."""
        return f"{self.uav}/{self.executable}" if self.uav else self.executable


def _sim_parameters(
    scenario_file: Path, options: FlightOptions, ports: Sequence[int]
) -> dict[str, Any]:
    return {
        "scenario": str(scenario_file),
        "speed": options.pace,
        "uav": not options.autopilot,
        "follow_autopilot": bool(options.autopilot),
        "mavlink_ports": list(ports),
        "live_helicopter": options.live,
        "track": options.helicopter if options.recorded else "",
        "wait_for_listeners": 2,
    }


def _estimator_parameters(scenario: Scenario, options: FlightOptions) -> dict[str, Any]:
    if options.recorded:
        return {"default_fix_sigma_m": RECORDED_FIX_SIGMA_M}
    expected = {"expected_legs_m": list(scenario.pattern.terms.lengths_m())}
    if options.live:
        return expected
    return expected | {f"datum_{key}": value for key, value in asdict(scenario.datum).items()}


def _planner_parameters(scenario: Scenario, options: FlightOptions, number: int) -> dict[str, Any]:
    corner = {key: value or 0.0 for key, value in asdict(scenario.corner).items()}
    told = scenario.planner_parameters(number, recorded=options.recorded)
    return corner | told | {"rules": options.rules, "yields_to": scenario.before(number)}


def _monitor_parameters(scenario: Scenario, options: FlightOptions, number: int) -> dict[str, Any]:
    limits = limits_of(scenario.corner, watch_only=options.watch_only)
    found = {
        "others": scenario.others(number),
        "min_separation_m": limits.min_separation_m,
        **asdict(model_of(scenario.corner, scenario.pattern.terms)),
    }
    return found | ({"watch_only": True} if limits.watch_only else {})


def _console_parameters(scenario: Scenario, options: FlightOptions, bag: Path) -> dict[str, Any]:
    return {
        "port": options.console,
        "spacing_m": scenario.corner.spacing_m,
        "turn_side": scenario.pattern.turn_side,
        "swath_m": 2.0 * scenario.sensor.radius_m,
        "address_file": str(bag.parent / ADDRESS_FILE),
        "folder": str(bag.parent),
        "tiles": options.tiles,
        "uavs": [one.name for one in scenario.formation],
    }


def plan_nodes(
    scenario: Scenario,
    scenario_file: Path,
    options: FlightOptions,
    *,
    bag: Path,
    ports: Sequence[int],
    tuned: dict[str, dict[str, Any]],
) -> list[NodeSpec]:
    """Return the nodes in the order of their start, the recorder first.

    ``ports``: of every UAV's link where it is simulated. ``tuned``: parameters from the parameter
    file by node name, over which the scenario's go.
    """
    clock = {"use_sim_time": not options.live}
    wanted: list[tuple[str, str, dict[str, Any], str]] = [
        ("sar_sim", "record", {"bag": str(bag)} | clock, ""),
        ("sar_estimator", "estimator", _estimator_parameters(scenario, options) | clock, ""),
    ]
    if options.gps:
        wanted.insert(1, ("sar_estimator", "gps", {"receiver": options.gps} | clock, ""))
    shared = _shared_radios(scenario, ports)
    wanted += [("sar_bridge", "radio_hub", radio | clock, "") for radio in shared]
    for number, member in enumerate(scenario.formation):
        planner = _planner_parameters(scenario, options, number)
        monitor = _monitor_parameters(scenario, options, number)
        bridge = _bridge_parameters(scenario, options, number, ports[number])
        wanted += [
            ("sar_planner", "planner", planner | clock, member.name),
            ("sar_bridge", "monitor", monitor | clock, member.name),
            ("sar_bridge", "bridge", bridge | clock, member.name),
        ]
    if options.console:
        console = _console_parameters(scenario, options, bag) | clock
        wanted.append(("sar_bridge", "console", console, ""))
    if options.simulation and not (options.live and options.autopilot):
        wanted.append(("sar_sim", "sim", _sim_parameters(scenario_file, options, ports), ""))
    return [
        NodeSpec(package, name, _given(tuned.get(name, {}) | own), uav)
        for package, name, own, uav in wanted
    ]


def _bridge_parameters(
    scenario: Scenario, options: FlightOptions, number: int, port: int
) -> dict[str, Any]:
    member = scenario.formation[number]
    found: dict[str, Any] = {
        "autopilot_url": f"udp:127.0.0.1:{port}",
        "altitude_m": scenario.altitude_m(number),
    }
    if member.autopilot and _users(scenario, member.autopilot) == 1:
        found["autopilot_url"] = member.autopilot
    elif member.autopilot:
        # All UAVs on a radio hear all bridges: a heartbeat counts for the one whose
        # MAV_GCS_SYSID it has, so that a silent bridge is missed by its own UAV.
        before = sum(one.autopilot == member.autopilot for one in scenario.formation[:number])
        found["source_system"] = GROUND_SYSTEM - before
    if len(scenario.formation) > 1:
        found["target_system"] = member.system_id
    if options.gcs and number == 0:
        found["gcs_url"] = " ".join(options.gcs)
    return found


def _users(scenario: Scenario, url: str) -> int:
    """Return how many UAVs are on a link."""
    return sum(member.autopilot == url for member in scenario.formation)


def _shared_radios(scenario: Scenario, ports: Sequence[int]) -> list[dict[str, Any]]:
    """Return the parameters of a node for every radio that several UAVs are on."""
    urls = dict.fromkeys(member.autopilot for member in scenario.formation)
    return [
        {
            "radio_url": url,
            "ports": [
                port
                for member, port in zip(scenario.formation, ports, strict=True)
                if member.autopilot == url
            ],
        }
        for url in urls
        if url and _users(scenario, url) > 1
    ]


def _given(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return parameters without empty lists, which have no type in ROS."""
    return {key: value for key, value in parameters.items() if value != []}


def parameter_document(specs: list[NodeSpec]) -> dict[str, Any]:
    """Return a ROS parameter file's content for the nodes."""
    return {
        f"/{spec.name}" if spec.uav else spec.executable: {"ros__parameters": spec.parameters}
        for spec in specs
    }


def read_tuned(document: object, name: str) -> dict[str, dict[str, Any]]:
    """Return a parameter file's content by node. Raises ``ScenarioError`` naming what is wrong."""
    known = (
        *("gps", "radio_hub", "estimator", "planner", "monitor", "bridge"),
        *("console", "record", "sim"),
    )
    if not isinstance(document, dict):
        raise ScenarioError(f"{name}: expected node names with ros__parameters")
    tuned = {}
    for node, block in document.items():
        if node not in known:
            raise ScenarioError(f"{name}: {node}: expected one of {', '.join(known)}")
        values = block.get("ros__parameters") if isinstance(block, dict) else None
        if not isinstance(values, dict):
            raise ScenarioError(f"{name}: {node}: expected a mapping ros__parameters")
        for key, value in values.items():
            if not isinstance(key, str) or not _is_value(value):
                expected = "a number, a word, true or false, or a list of one kind of these"
                raise ScenarioError(f"{name}: {node}: {key} = {value!r}: expected {expected}")
        tuned[node] = values
    return tuned


def _is_value(value: object) -> bool:
    """Whether ROS has parameters of this kind."""
    items = value if isinstance(value, list) else [value]
    alike = len({type(item) for item in items}) == 1
    return alike and isinstance(items[0], bool | int | float | str)


def leg_flown(corner: int, rule: str, phase: str) -> int:
    """Return the number of the leg that is flown, from 1: in a corner, of the one before it.

    ``corner``: how many corners were told of. ``rule``, ``phase``: as told.
    """
    in_corner = rule in set(Rule) or phase == "decelerating"
    return max(1, corner if in_corner else corner + 1)


def with_autopilots(scenario: Scenario, given: Sequence[str]) -> Scenario:
    """Return a scenario whose UAVs have the autopilots given: URL, or NAME=URL for each of several.

    Raises ``ScenarioError`` where some have one and others have none.
    """
    names = [member.name for member in scenario.formation]
    urls = {member.name: member.autopilot for member in scenario.formation}
    for text in given:
        name, is_named, url = text.rpartition("=")
        if not is_named and len(names) > 1:
            raise ScenarioError(f"--autopilot {text}: expected NAME=URL, one of {', '.join(names)}")
        if is_named and name not in names:
            raise ScenarioError(f"--autopilot {text}: expected one of {', '.join(names)}")
        urls[name if is_named else names[0]] = url
    without = [name for name, url in urls.items() if not url]
    if without and len(without) < len(names):
        raise ScenarioError(
            f"--autopilot: none for {', '.join(without)}: expected one for each UAV"
        )
    formation = [replace(one, autopilot=urls[one.name]) for one in scenario.formation]
    return replace(scenario, formation=formation)
