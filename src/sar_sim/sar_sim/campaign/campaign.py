"""Campaigns: which missions are flown, with which seeds, and what they come to.

A plan names a scenario, seeds, and what varies: planners, keys of the scenario, or named parts of
it. Every combination is flown with every seed, by the modules that fly.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass as checked_dataclass

from sar_estimator.common.checked import CHECKED, Count, Positive, read
from sar_sim.campaign.missions import Mission, fly, seeded
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import (
    Scenario,
    ScenarioError,
    read_document,
    scenario_document,
    scenario_of,
)

Document = dict[str, Any]


@checked_dataclass(frozen=True, config=CHECKED)
class Way:
    """How a mission is flown, beside its scenario, whose name or file ``scenario`` is.

    ``redundancy``: f, by which tracks are nearer to each other. ``tolerance_m``: on |L(k)|, which
    counts from corner ``from_corner`` on.
    ``watch_only``: the monitor says what it sees and does nothing.
    """

    scenario: str = "arduplane"
    rules: Literal["deadbeat", "paper", "follow"] = "deadbeat"
    redundancy: Annotated[float, Field(ge=0.0, lt=1.0)] | None = None
    tolerance_m: Positive = 15.0
    from_corner: Count = 4
    watch_only: bool = False


WAYS = tuple(item.name for item in fields(Way))


@checked_dataclass(frozen=True, config=CHECKED)
class Plan(Way):
    """A plan as it is written. ``lag_m``: from and to which L(1) is drawn."""

    name: str = ""
    seeds: Count = 30
    lag_m: tuple[float, float] | None = None
    vary: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Combination:
    """One combination of what varies: ``labels`` by factor, and the scenario it is flown in.

    ``tolerance_m``: on |L(k)|, which counts from corner ``from_corner`` on. ``watch_only``: the
    monitor says what it sees and does nothing.
    """

    labels: dict[str, str]
    scenario: Scenario
    rules: str
    watch_only: bool
    tolerance_m: float
    from_corner: int

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
    """A plan: what is flown, and how often."""

    name: str
    combinations: tuple[Combination, ...]
    seeds: int
    lag_m: tuple[float, float] | None
    document: Document


def load_campaign(path: Path) -> Campaign:
    """Read a plan. Raises ``ScenarioError`` in one line, naming file, key and expectation."""
    document = read_document(path)
    try:
        return _campaign(document, path.stem)
    except ValueError as error:
        raise ScenarioError(f"{path}: {error}") from error


def _campaign(document: Document, stem: str) -> Campaign:
    plan = read(Plan, document)
    common: Document = {key: document[key] for key in document if key in WAYS}
    combinations = tuple(_combinations(common, plan.vary))
    return Campaign(
        plan.name or stem,
        combinations,
        plan.seeds,
        plan.lag_m,
        {**document, "scenarios": [scenario_document(one.scenario) for one in combinations]},
    )


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


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _merge(into: Document, values: Mapping[str, Any]) -> None:
    """Put values into a document, those of inner mappings one by one."""
    for key, value in values.items():
        if isinstance(value, dict) and isinstance(into.get(key), dict):
            _merge(into[key], value)
        else:
            into[key] = deepcopy(value)


def _combination(labels: dict[str, str], part: Document) -> Combination:
    way = read(Way, {key: part.pop(key) for key in WAYS if key in part})
    document = read_document(find_scenario(way.scenario))
    _merge(document, part)
    scenario = scenario_of(document)
    if way.redundancy is not None:
        scenario = _redundant(scenario, way.redundancy)
    return Combination(
        labels, scenario, way.rules, way.watch_only, way.tolerance_m, way.from_corner
    )


def _redundant(scenario: Scenario, share: float) -> Scenario:
    """Return a scenario with tracks nearer to each other: d = (1 - f) of what is seen across."""
    spacing = scenario.corner.spacing_m * (1.0 - share)
    return replace(
        scenario,
        corner=replace(scenario.corner, spacing_m=spacing),
        sensor=replace(scenario.sensor, redundancy=share),
        pattern=replace(scenario.pattern, track_spacing_m=2.0 * spacing),
    )
