"""Missions flown offline: what came of one, as a row of plain values, and of many."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sar_planner.patterns.progress import sides_of
from sar_planner.strategies.active_corner import ActiveCorner
from sar_sim.campaign.detection import matched
from sar_sim.flight.offline import OfflineFlight
from sar_sim.report.coverage import Coverage, ideal_tracks, measure
from sar_sim.scenario.scenario import Scenario
from sar_sim.world.helicopter import CornerTruth
from sar_sim.world.world import World

COVERED_FROM_CORNER = 3
TRACK_LOOKS = 2
SAME_CORNER_S = 15.0


@dataclass(frozen=True)
class Mission:
    """One mission.

    ``lags_m``: true L(k) at every corner's onset; ``predicted_m``: L(k+1) as the path for corner k
    was planned last, NaN where none was; ``rules``: of those paths. ``separation_m``: the closest
    approach, at ``separation_s``. Coverage, ``reached_percent`` (that of what the helicopter's
    own track allows) and overlap [%] and the area seen [km^2] count from the third corner on,
    over ``covered_s``. ``false_corners``: predicted where there was none. ``alerts``: the
    monitor's, and lists passed and refused, counted; ``problems``: what the planner said, without
    numbers.
    """

    seed: int
    lags_m: tuple[float, ...]
    predicted_m: tuple[float, ...]
    rules: tuple[str, ...]
    separation_m: float
    separation_s: float
    coverage_percent: float
    reached_percent: float
    overlap_percent: float
    seen_km2: float
    covered_s: float
    corrections: int
    lists: int
    false_corners: int
    flown_s: float
    alerts: dict[str, int]
    problems: frozenset[str]

    @property
    def extra_m(self) -> tuple[float, ...]:
        """How much farther than planned was flown at each corner, the last one left out [m]."""
        return tuple(
            lag - predicted
            for lag, predicted in zip(self.lags_m[1:], self.predicted_m, strict=False)
        )

    @property
    def rate_km2_per_h(self) -> float:
        """The area seen in an hour, from the third corner on [km^2/h]."""
        return 3600.0 * self.seen_km2 / self.covered_s if self.covered_s > 0.0 else math.nan


class Observer:
    """Watches a world: true lags at every onset, the least separation, both tracks."""

    def __init__(self, world: World) -> None:
        """Nothing is seen yet."""
        self._corners = list(world.corners)
        self._looks = 0
        self._track: list[tuple[float, float, float, float]] = []
        self.lags_m: list[float] = []
        self.separation_m = math.inf
        self.separation_s = 0.0

    @property
    def track(self) -> np.ndarray:
        """The helicopter's and the UAV's positions at every second look, shape (n, 4) [m]."""
        return np.array(self._track).reshape(-1, 4)

    def __call__(self, world: World) -> None:
        """Look at the present state."""
        assert world.helicopter is not None
        uav, helicopter = world.autopilot.state, world.helicopter.motion(world.time_s)
        apart = math.hypot(uav.x_m - helicopter.x_m, uav.y_m - helicopter.y_m)
        if apart < self.separation_m:
            self.separation_m, self.separation_s = apart, world.time_s
        self._looks += 1
        if self._looks % TRACK_LOOKS == 0:
            self._track.append((helicopter.x_m, helicopter.y_m, uav.x_m, uav.y_m))
        while self._corners and self._corners[0].onset_time_s <= world.time_s:
            corner = self._corners.pop(0)
            speed = world.autopilot.motion.speed_mps
            since = speed * (world.time_s - corner.onset_time_s)
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


def covered(world: World, track: np.ndarray) -> Coverage:
    """Return what was seen of what the ideal formation sees from the third corner on.

    ``track``: helicopter's and UAV's positions, shape (n, 4).
    """
    scenario = world.scenario
    pattern = scenario.pattern
    stops = [corner.crossing_m for corner in world.corners[COVERED_FROM_CORNER - 1 :]]
    ideal = ideal_tracks(
        np.vstack((*stops, track[-1, :2])),
        spacing_m=scenario.corner.spacing_m,
        sides=sides_of(pattern.kind, pattern.turn_side, COVERED_FROM_CORNER, len(stops)),
    )
    return measure(
        track[:, :2],
        track[:, 2:],
        ideal,
        radius_m=scenario.sensor.radius_m,
        footprint=scenario.sensor.footprint,
    )


def fly(scenario: Scenario, rules: str, *, watch_only: bool = False) -> Mission:
    """Fly one mission with the estimator in the loop."""
    flight = OfflineFlight(scenario, rules=rules, watch_only=watch_only)
    seen = Observer(flight.world)
    planned: dict[int, ActiveCorner] = {}
    problems: set[str] = set()
    predicted: list[float] = []
    ahead = False

    def observe(world: World) -> None:
        nonlocal ahead
        seen(world)
        if flight.estimator.corner is not None and not ahead:
            predicted.append(world.time_s)
        ahead = flight.estimator.corner is not None
        if flight.planner.active is not None:
            planned[flight.planner.active.k] = flight.planner.active
        if flight.planner.problem:
            problems.update(_kinds(flight.planner.problem))

    flight.run(observe=observe)
    world = flight.world
    coverage, reached, overlap, seen_km2, covered_s = math.nan, math.nan, math.nan, math.nan, 0.0
    if len(world.corners) >= COVERED_FROM_CORNER:
        area = covered(world, seen.track)
        coverage, overlap = area.percent, area.overlap_percent
        reached = area.reached_percent
        seen_km2 = area.covered_m2 / 1e6
        covered_s = world.time_s - world.corners[COVERED_FROM_CORNER - 1].stop_time_s
    return Mission(
        scenario.gps.seed,
        tuple(seen.lags_m),
        tuple(_first_predicted_s(corner, planned.values()) for corner in world.corners),
        tuple(str(planned[k].plan.rule) for k in sorted(planned)),
        seen.separation_m,
        seen.separation_s,
        coverage,
        reached,
        overlap,
        seen_km2,
        covered_s,
        flight.planner.report.corrections,
        0 if flight.planner.list is None else flight.planner.list.number,
        matched(world.corners, predicted)[1],
        world.time_s,
        {str(name): count for name, count in flight.monitor.counts.items()},
        frozenset(problems),
    )


def _first_predicted_s(corner: CornerTruth, planned: Iterable[ActiveCorner]) -> float:
    """Return L(k+1) as it was planned last for a corner [m], NaN where it was not planned.

    By the time of its onset: the planner also counts corners that it predicted in vain.
    """
    for active in planned:
        if abs(active.estimate.onset_time_s - corner.onset_time_s) < SAME_CORNER_S:
            return active.plan.next_lag_m
    return math.nan


def _kinds(problem: str) -> set[str]:
    """Return what is wrong without the numbers."""
    return {re.sub(r"\s*[\d.]+ m/s", "", part.split(":")[0]) for part in problem.split("; ")}


def watched(missions: Sequence[Mission]) -> str:
    """Return what the monitor said and did in all of some missions as text."""
    total = Counter[str]()
    for mission in missions:
        total.update(mission.alerts)
    hours = sum(mission.flown_s for mission in missions) / 3600.0
    return (
        f"{hours:.1f} h flown: false corners {sum(m.false_corners for m in missions)}, "
        f"escapes {total['escape']}, warnings {total['warning']}, "
        f"cautions {total['caution']}; lists passed {total['passed']}, refused {total['refused']}"
    )
