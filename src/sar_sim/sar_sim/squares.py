"""Expanding squares flown by the ``arduplane`` preset in calm air, wind, and from short legs."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace

import numpy as np

from sar_sim.coverage import ideal_tracks, measure
from sar_sim.missions import Observer, alerts_of, seeded, watched
from sar_sim.offline import OfflineFlight
from sar_sim.scenario import Scenario, Wind
from sar_sim.world import World

LAGS_M = (-300.0, 1000.0)
FROM_CORNER = 4
COVERED_FROM_CORNER = 3
TRACK_STEPS = 10


@dataclass(frozen=True, slots=True)
class Condition:
    """How a square is flown, and what is expected: |L(k)| and separation [m], coverage [%]."""

    redundancy: float = 0.0
    wind_mps: float = 0.0
    gust_mps: float = 0.0
    first_leg_m: float = 1500.0
    lag_m: float = math.inf
    separation_m: float = 0.0
    coverage_percent: float = 0.0

    def scenario(self, base: Scenario, seed: int) -> Scenario:
        """Return the scenario of one seed; the wind's direction is drawn with it."""
        drawn = seeded(base, seed, LAGS_M)
        direction = float(np.random.default_rng([seed, 1]).uniform(0.0, 360.0))
        spacing = base.corner.spacing_m * (1.0 - self.redundancy)
        return replace(
            drawn,
            corner=replace(drawn.corner, spacing_m=spacing),
            sensor=replace(drawn.sensor, redundancy=self.redundancy),
            pattern=replace(
                drawn.pattern, first_leg_m=self.first_leg_m, track_spacing_m=2.0 * spacing
            ),
            wind=Wind(self.wind_mps, direction, self.gust_mps, seed=seed),
        )


CONDITIONS: dict[str, Condition] = {
    "calm, f = 0 %": Condition(lag_m=15.0, separation_m=180.0, coverage_percent=99.65),
    "calm, f = 5 %": Condition(
        redundancy=0.05, lag_m=15.0, separation_m=180.0, coverage_percent=99.63
    ),
    "calm, f = 10 %": Condition(
        redundancy=0.1, lag_m=15.0, separation_m=180.0, coverage_percent=99.83
    ),
    "wind 6 m/s": Condition(wind_mps=6.0, gust_mps=1.0, lag_m=25.0, separation_m=150.0),
    "wind 10 m/s": Condition(wind_mps=10.0, gust_mps=1.5),
    "first legs 500 m": Condition(first_leg_m=500.0),
}


@dataclass(frozen=True)
class Square:
    """One mission: true L(k) and least separation [m], coverage [%], lists, what was said."""

    lags_m: tuple[float, ...]
    separation_m: float
    coverage_percent: float
    lists: int
    problems: frozenset[str]
    flown_s: float
    alerts: dict[str, int]


def _kinds(problem: str) -> set[str]:
    """Return what is wrong without the numbers."""
    return {re.sub(r"\s*[\d.]+ m/s", "", part.split(":")[0]) for part in problem.split("; ")}


def coverage_percent(world: World, track: np.ndarray) -> float:
    """Return the share [%] seen of what the ideal formation sees from the third corner on.

    ``track``: helicopter's and UAV's positions, shape (n, 4).
    """
    scenario = world.scenario
    stops = [(c.stop.x_m, c.stop.y_m) for c in world.corners[COVERED_FROM_CORNER - 1 :]]
    ideal = ideal_tracks(
        np.vstack((stops, track[-1, :2])),
        spacing_m=scenario.corner.spacing_m,
        turn_side=scenario.pattern.turn_side,
    )
    return measure(
        track[:, :2],
        track[:, 2:],
        ideal,
        radius_m=scenario.sensor.radius_m,
        footprint=scenario.sensor.footprint,
    ).percent


def fly_square(
    seed: int, base: Scenario, condition: Condition, rules: str, *, watch_only: bool = False
) -> Square:
    """Fly one mission."""
    flight = OfflineFlight(condition.scenario(base, seed), rules=rules, watch_only=watch_only)
    seen = Observer(flight.world)
    track: list[tuple[float, float, float, float]] = []
    problems: set[str] = set()
    steps = 0

    def observe(world: World) -> None:
        nonlocal steps
        seen(world)
        steps += 1
        if flight.planner.problem:
            problems.update(_kinds(flight.planner.problem))
        if steps % TRACK_STEPS == 0 and world.helicopter is not None:
            leader, uav = world.helicopter.motion(world.time_s), world.autopilot.motion
            track.append((leader.x_m, leader.y_m, uav.x_m, uav.y_m))

    flight.run(observe=observe)
    lists = 0 if flight.planner.list is None else flight.planner.list.number
    return Square(
        tuple(seen.lags_m),
        seen.separation_m,
        coverage_percent(flight.world, np.array(track)),
        lists,
        frozenset(problems),
        flight.world.time_s,
        alerts_of(flight),
    )


def summary(name: str, condition: Condition, squares: list[Square]) -> str:
    """Return one condition's line, and what the planner said."""
    late = np.abs([square.lags_m[FROM_CORNER - 1 :] for square in squares])
    apart = np.array([square.separation_m for square in squares])
    covered = np.array([square.coverage_percent for square in squares])
    within = ""
    if math.isfinite(condition.lag_m):
        within = f"{(late <= condition.lag_m).mean():8.1%} of corners within {condition.lag_m:g} m"
    said = sorted({problem for square in squares for problem in square.problems})
    lists = np.mean([square.lists / max(1, len(square.lags_m)) for square in squares])
    return (
        f"{name:18s}{np.median(late):8.1f}{np.percentile(late, 95):8.1f}{late.max():8.1f}"
        f"{apart.min():9.1f}{np.median(apart):8.1f}{covered.mean():9.2f}{covered.min():8.2f}"
        f"{lists:8.1f}{within}\n    {watched(squares)}"
        + (f"\n    said: {'; '.join(said)}" if said else "")
    )


HEADER = (
    "condition          |L(k)| from corner 4  [m]   apart  [m]     coverage  [%]   lists\n"
    "                    median     p95     max    least  median     mean   least  /corner"
)
