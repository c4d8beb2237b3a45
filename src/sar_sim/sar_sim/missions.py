"""Many missions flown offline: what came of each, and of all."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from sar_sim.offline import OfflineFlight
from sar_sim.scenario import Scenario
from sar_sim.world import World


@dataclass(frozen=True)
class Outcome:
    """One mission: true L(k) [m], rules, least separation [m] and its time, path corrections.

    ``alerts``: the monitor's, and lists passed and refused, counted.
    """

    seed: int
    lags_m: tuple[float, ...]
    rules: tuple[str, ...]
    separation_m: float
    separation_s: float
    corrections: int
    flown_s: float
    alerts: dict[str, int]


class Watched(Protocol):
    """A mission that the monitor watched."""

    @property
    def flown_s(self) -> float:
        """How long it was [s]."""

    @property
    def alerts(self) -> dict[str, int]:
        """What the monitor said and did, counted."""


class Observer:
    """Watches a world: true lags at every onset, and the least separation."""

    def __init__(self, world: World) -> None:
        """Nothing is seen yet."""
        self._corners = list(world.corners)
        self.lags_m: list[float] = []
        self.separation_m = math.inf
        self.separation_s = 0.0

    def __call__(self, world: World) -> None:
        """Look at the present state."""
        assert world.helicopter is not None
        uav, helicopter = world.autopilot.motion, world.helicopter.motion(world.time_s)
        apart = math.hypot(uav.x_m - helicopter.x_m, uav.y_m - helicopter.y_m)
        if apart < self.separation_m:
            self.separation_m, self.separation_s = apart, world.time_s
        while self._corners and self._corners[0].onset_time_s <= world.time_s:
            corner = self._corners.pop(0)
            since = uav.speed_mps * (world.time_s - corner.onset_time_s)
            self.lags_m.append(since - corner.onset.along(uav.x_m, uav.y_m))


def seeded(scenario: Scenario, seed: int, lags_m: tuple[float, float] | None) -> Scenario:
    """Return a scenario with a seed for everything, and L(1) drawn from a range [m] with it."""
    lag = scenario.uav.lag_m
    if lags_m is not None:
        lag = float(np.random.default_rng(seed).uniform(*lags_m))
    return replace(
        scenario,
        gps=replace(scenario.gps, seed=seed),
        pilot=replace(scenario.pilot, seed=seed),
        uav=replace(scenario.uav, seed=seed, lag_m=lag),
    )


def fly_once(scenario: Scenario, rules: str, *, watch_only: bool = False) -> Outcome:
    """Fly one mission with the estimator in the loop."""
    flight = OfflineFlight(scenario, rules=rules, watch_only=watch_only)
    seen = Observer(flight.world)
    flown: dict[int, str] = {}

    def observe(world: World) -> None:
        seen(world)
        active = flight.planner.active
        if active is not None:
            flown[active.k] = str(active.plan.rule)

    flight.run(observe=observe)
    return Outcome(
        scenario.gps.seed,
        tuple(seen.lags_m),
        tuple(flown[k] for k in sorted(flown)),
        seen.separation_m,
        seen.separation_s,
        flight.planner.corrections,
        flight.world.time_s,
        alerts_of(flight),
    )


def alerts_of(flight: OfflineFlight) -> dict[str, int]:
    """Return what the monitor said and did, counted by name."""
    return {str(name): count for name, count in flight.monitor.counts.items()}


def watched(missions: Sequence[Watched]) -> str:
    """Return what the monitor said and did in all of some missions as text."""
    total = Counter[str]()
    for mission in missions:
        total.update(mission.alerts)
    hours = sum(mission.flown_s for mission in missions) / 3600.0
    return (
        f"{hours:.1f} h flown: escapes {total['escape']}, warnings {total['warning']}, "
        f"cautions {total['caution']}; lists passed {total['passed']}, refused {total['refused']}"
    )


def summary(outcomes: list[Outcome], *, tolerance_m: float, from_corner: int) -> str:
    """Return a table of |L(k)| by corner, and the separation, over missions of equal length."""
    lags = np.abs(np.array([outcome.lags_m for outcome in outcomes]))
    separation = np.array([outcome.separation_m for outcome in outcomes])
    lines = ["corner   median |L|      p95      max  [m]"]
    for k, column in enumerate(lags.T, start=1):
        lines.append(
            f"{k:6d} {np.median(column):12.1f} {np.percentile(column, 95):8.1f} {column.max():8.1f}"
        )
    late = lags[:, from_corner - 1 :]
    lines.append(
        f"|L(k)| <= {tolerance_m:g} m at every corner from {from_corner} on: "
        f"{(late <= tolerance_m).all(axis=1).mean():.1%} of {len(outcomes)} missions; "
        f"at {(late <= tolerance_m).mean():.1%} of those corners"
    )
    worst = outcomes[int(separation.argmin())]
    lines.append(
        f"least separation {separation.min():.1f} m (seed {worst.seed}, "
        f"t = {worst.separation_s:.0f} s), 1 % of missions below "
        f"{np.percentile(separation, 1):.1f} m, median {np.median(separation):.1f} m"
    )
    lines.append(watched(outcomes))
    return "\n".join(lines)
