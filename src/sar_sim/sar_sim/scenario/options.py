"""Command line options that flights of the graph and offline flights share."""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path

from sar_estimator.common.checked import changed
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_sim.scenario.scenario import Scenario, ScenarioError, load_scenario

RECORDED_FIX_SIGMA_M = 10.0


def scenario_folder() -> Path:
    """Return where named scenarios are: ``config/scenarios`` of the nearest parent folder."""
    for base in (Path.cwd(), *Path.cwd().parents, *Path(__file__).resolve().parents):
        folder = base / "config" / "scenarios"
        if folder.is_dir():
            return folder
    raise ScenarioError("config/scenarios: not found in this folder or any above it")


def find_scenario(name: str) -> Path:
    """Return the file of a scenario given as a path or as a name."""
    return _find(name, "scenarios", "--scenario ")


def find_plan(name: str) -> Path:
    """Return the file of a campaign's plan given as a path or as a name in config/campaigns."""
    return _find(name, "campaigns", "")


def _find(name: str, kind: str, option: str) -> Path:
    given = Path(name)
    if given.suffix in (".yaml", ".yml") or given.is_file():
        if not given.is_file():
            raise ScenarioError(f"{option}{name}: no such file")
        return given
    path = scenario_folder().parent / kind / f"{name}.yaml"
    if not path.is_file():
        known = ", ".join(sorted(item.stem for item in path.parent.glob("*.yaml")))
        raise ScenarioError(f"{option}{name}: expected a file or one of {known}")
    return path


def add_flight_options(parser: argparse.ArgumentParser, *, rule_sets: tuple[str, ...]) -> None:
    """Add what says which mission is flown and where its results go."""
    parser.add_argument("--scenario", default="human", help="a scenario's name or YAML file")
    parser.add_argument("--rules", choices=rule_sets, default="deadbeat", help="the rule set")
    parser.add_argument("--seed", type=int, help="of receiver noise and pilot, not the scenario's")
    parser.add_argument("--lag", type=float, help="L(1) in metres, instead of the scenario's")
    parser.add_argument(
        "--watch-only", action="store_true", help="the monitor does nothing (only in simulation)"
    )
    parser.add_argument("--out", type=Path, help="results folder, default runs/<time>")
    parser.add_argument(
        "--helicopter",
        default="sim",
        metavar="sim|topic|FILE.csv|BAG",
        help="the simulated pilot, a live /helicopter/fix, or a recorded track",
    )


def scenario_from(args: argparse.Namespace) -> Scenario:
    """Return the scenario that the options ask for. Raises ``ScenarioError``."""
    scenario = load_scenario(find_scenario(args.scenario))
    if args.seed is not None:
        scenario = replace(
            scenario,
            gps=replace(scenario.gps, seed=args.seed),
            pilot=replace(scenario.pilot, seed=args.seed),
            uav=replace(scenario.uav, seed=args.seed),
        )
    if args.lag is not None:
        scenario = replace(scenario, uav=changed(scenario.uav, lag_m=args.lag))
    return scenario


def estimator_parameters(scenario: Scenario, *, recorded: bool) -> EstimatorParameters:
    """Return the estimator's parameters: the legs that are expected.

    Fixes of recorded tracks bear no covariance, and follow no pattern that is known.
    """
    if recorded:
        return EstimatorParameters(default_fix_sigma_m=RECORDED_FIX_SIGMA_M)
    return EstimatorParameters(expected_legs_m=scenario.pattern.terms.lengths_m())


def new_run_folder(wanted: Path | None) -> Path:
    """Create and return the results folder. Raises ``ValueError`` when it holds a bag already."""
    out = wanted or Path("runs") / time.strftime("%Y-%m-%d_%H-%M-%S")
    if (out / "bag").exists():
        raise ValueError(f"--out {out}: holds a bag already, expected a new folder")
    out.mkdir(parents=True, exist_ok=True)
    return out
