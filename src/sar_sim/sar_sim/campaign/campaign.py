"""Campaigns: which missions are flown, with which seeds, and what they come to.

A plan names a scenario, seeds, and what varies: planners, keys of the scenario, or named parts of
it. Every combination is flown with every seed, by the modules that fly.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeGuard, cast

import numpy as np

from sar_planner.parameters.corner import PLANNERS
from sar_sim.campaign.missions import Mission, fly, seeded
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import (
    Scenario,
    ScenarioError,
    read_document,
    scenario_document,
    scenario_of,
)

SPECIAL = ("scenario", "rules", "redundancy", "tolerance_m", "watch_only")
KEYS = ("name", *SPECIAL, "seeds", "lag_m", "from_corner", "vary")
TOLERANCE_M = 15.0
Document = dict[str, Any]


@dataclass(frozen=True)
class Combination:
    """One combination of what varies: ``labels`` by factor, and the scenario it is flown in.

    ``tolerance_m``: on |L(k)|. ``watch_only``: the monitor says
    what it sees and does nothing.
    """

    labels: dict[str, str]
    scenario: Scenario
    rules: str
    watch_only: bool
    tolerance_m: float

    @property
    def name(self) -> str:
        """The labels in one line."""
        return ", ".join(self.labels.values()) or self.scenario.name

    def fly(self, seed: int, lag_m: tuple[float, float] | None) -> Mission:
        """Fly one mission; the wind's direction is drawn with the seed."""
        scenario = seeded(self.scenario, seed, lag_m)
        direction = float(np.random.default_rng([seed, 1]).uniform(0.0, 360.0))
        wind = replace(scenario.wind, from_deg=direction, seed=seed)
        return fly(replace(scenario, wind=wind), self.rules, watch_only=self.watch_only)


@dataclass(frozen=True)
class Campaign:
    """A plan: what is flown, how often, and from which corner on |L(k)| counts."""

    name: str
    combinations: tuple[Combination, ...]
    seeds: int
    lag_m: tuple[float, float] | None
    from_corner: int
    document: Document


def load_campaign(path: Path) -> Campaign:
    """Read a plan. Raises ``ScenarioError`` in one line, naming file, key and expectation."""
    document = read_document(path)
    try:
        return _campaign(document, path.stem)
    except ValueError as error:
        raise ScenarioError(f"{path}: {error}") from error


def _campaign(document: Document, stem: str) -> Campaign:
    unknown = [key for key in document if key not in KEYS]
    if unknown:
        raise ScenarioError(f"{unknown[0]}: unknown key, expected one of {', '.join(KEYS)}")
    seeds, from_corner = document.get("seeds", 30), document.get("from_corner", 4)
    for key, value in (("seeds", seeds), ("from_corner", from_corner)):
        if not isinstance(value, int) or isinstance(value, bool) or value < 1:
            raise ScenarioError(f"{key} = {value!r}: expected a whole number, 1 or more")
    factors = document.get("vary", {})
    if not isinstance(factors, dict):
        raise ScenarioError(f"vary = {factors!r}: expected a mapping")
    common: Document = {key: document[key] for key in document if key in SPECIAL}
    combinations = tuple(_combinations(common, factors))
    return Campaign(
        str(document.get("name", stem)),
        combinations,
        seeds,
        _lags(document.get("lag_m")),
        from_corner,
        {**document, "scenarios": [scenario_document(one.scenario) for one in combinations]},
    )


def _lags(value: object) -> tuple[float, float] | None:
    if value is None:
        return None
    if isinstance(value, list) and len(value) == 2 and all(_is_number(item) for item in value):
        return float(value[0]), float(value[1])
    raise ScenarioError(f"lag_m = {value!r}: expected two numbers, [low, high]")


def _is_number(value: object) -> TypeGuard[float]:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and math.isfinite(cast("float", value))


def _combinations(common: Document, factors: Document) -> Iterator[Combination]:
    levels = [list(_levels(name, given)) for name, given in factors.items()]
    for chosen in itertools.product(*levels):
        part: Document = {}
        for _, values in (("", common), *chosen):
            _merge(part, values)
        labels = {name: label for name, (label, _) in zip(factors, chosen, strict=True)}
        yield _combination(labels, part)


def _levels(name: str, given: object) -> Iterator[tuple[str, Document]]:
    """Yield the levels of one factor: a label, and the part of a scenario that it stands for."""
    if isinstance(given, list) and given:
        for value in given:
            part: Document = {}
            at, *path = reversed(name.split("."))
            part[at] = value
            for key in path:
                part = {key: part}
            yield f"{at} {value:g}" if _is_number(value) else str(value), part
    elif isinstance(given, dict) and given:
        for label, values in given.items():
            if not isinstance(values, dict):
                raise ScenarioError(f"vary.{name}.{label} = {values!r}: expected a mapping")
            yield str(label), values
    else:
        raise ScenarioError(f"vary.{name} = {given!r}: expected a list, or parts of a scenario")


def _merge(into: Document, values: Mapping[str, Any]) -> None:
    """Put values into a document, those of inner mappings one by one."""
    for key, value in values.items():
        if isinstance(value, dict) and isinstance(into.get(key), dict):
            _merge(into[key], value)
        else:
            into[key] = deepcopy(value)


def _combination(labels: dict[str, str], part: Document) -> Combination:
    special = {key: part.pop(key) for key in SPECIAL if key in part}
    document = read_document(find_scenario(str(special.get("scenario", "arduplane"))))
    _merge(document, part)
    scenario = scenario_of(document)
    rules = str(special.get("rules", "deadbeat"))
    if rules not in PLANNERS:
        raise ScenarioError(f"rules = {rules}: expected one of {', '.join(PLANNERS)}")
    watch_only = special.get("watch_only", False)
    if not isinstance(watch_only, bool):
        raise ScenarioError(f"watch_only = {watch_only!r}: expected true or false")
    tolerance = special.get("tolerance_m", TOLERANCE_M)
    if not (_is_number(tolerance) and tolerance > 0.0):
        raise ScenarioError(f"tolerance_m = {tolerance!r}: expected more than 0")
    if "redundancy" in special:
        scenario = _redundant(scenario, special["redundancy"])
    return Combination(labels, scenario, rules, watch_only, float(tolerance))


def _redundant(scenario: Scenario, share: object) -> Scenario:
    """Return a scenario with tracks nearer to each other: d = (1 - f) of what is seen across."""
    if not (_is_number(share) and 0.0 <= share < 1.0):
        raise ScenarioError(f"redundancy = {share!r}: expected 0 or more, less than 1")
    spacing = scenario.corner.spacing_m * (1.0 - share)
    return replace(
        scenario,
        corner=replace(scenario.corner, spacing_m=spacing),
        sensor=replace(scenario.sensor, redundancy=float(share)),
        pattern=replace(scenario.pattern, track_spacing_m=2.0 * spacing),
    )
