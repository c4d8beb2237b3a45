"""Missions flown offline: what came of one, as a row of plain values, and of many."""

from __future__ import annotations

import itertools
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sar_bridge.monitor.parameters import MonitorParameters
from sar_planner.patterns.legs import PatternTerms
from sar_planner.patterns.progress import places_of
from sar_planner.strategies.active_corner import ActiveCorner
from sar_sim.campaign.detection import matched
from sar_sim.flight.offline import OfflineFlight
from sar_sim.report.coverage import Coverage, IdealSlot, ideal_tracks, measure
from sar_sim.scenario.scenario import Scenario
from sar_sim.world.helicopter import CornerTruth
from sar_sim.world.world import World

COVERED_FROM_CORNER = 3
COVERED_FROM_CROSS = 2
TRACK_LOOKS = 2
SAME_CORNER_S = 15.0
LAYER_APART_M = MonitorParameters().layer_separation_m


@dataclass(frozen=True)
class Mission:
    """One mission.

    ``lags_m``: true L(k) at every corner's onset; ``predicted_m``: L(k+1) as the path for corner k
    was planned last, NaN where none was; ``rules``: of those paths. ``separation_m``: the closest
    approach, at ``separation_s``. Coverage, ``reached_percent`` (that of what the helicopter's
    own track allows) and overlap [%] and the area seen [km^2] count from ``covered_from``
    on, over ``covered_s``. ``false_corners``: predicted where there was none. ``alerts``: the
    monitors', and lists passed and refused, counted; ``problems``: what the planner said, without
    numbers. Lags, rules and problems are the first UAV's; ``others_lags_m``: of the others.
    ``uavs_apart_m``: the least of two UAVs in one layer. ``alone_km2``: of the area seen, what the
    helicopter saw.
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
    others_lags_m: tuple[tuple[float, ...], ...] = ()
    uavs_apart_m: float = math.inf
    alone_km2: float = math.nan

    @property
    def extra_m(self) -> tuple[float, ...]:
        """How much farther than planned was flown at each corner, the last one left out [m]."""
        return tuple(
            lag - predicted
            for lag, predicted in zip(self.lags_m[1:], self.predicted_m, strict=False)
        )

    @property
    def alone_km2_per_h(self) -> float:
        """What of it the helicopter alone sees in an hour [km^2/h]."""
        return 3600.0 * self.alone_km2 / self.covered_s if self.covered_s > 0.0 else math.nan

    @property
    def rate_km2_per_h(self) -> float:
        """The area seen in an hour, from ``covered_from`` on [km^2/h]."""
        return 3600.0 * self.seen_km2 / self.covered_s if self.covered_s > 0.0 else math.nan


class Observer:
    """Watches a world: true lags at every onset, the least separations, all tracks.

    ``lags_m``: of every UAV. ``separation_m``: the least to the helicopter, at ``separation_s``;
    ``uavs_apart_m``: the least of two UAVs in one layer.
    """

    def __init__(self, world: World) -> None:
        """Nothing is seen yet."""
        self._corners = list(world.corners)
        self._looks = 0
        self._track: list[tuple[float, ...]] = []
        self._layers = list(pairs_in_one_layer(world.scenario))
        self.lags_m: list[list[float]] = [[] for _ in world.autopilots]
        self.separation_m = self.uavs_apart_m = math.inf
        self.separation_s = 0.0

    @property
    def track(self) -> np.ndarray:
        """The helicopter's and the UAVs' positions at every second look, shape (n, 2 + 2 u) [m]."""
        return np.array(self._track)

    def __call__(self, world: World) -> None:
        """Look at the present state."""
        assert world.helicopter is not None
        time_s = world.time_s
        _, x_m, y_m, *_ = world.helicopter.motion(time_s)
        uavs = [one.state[1:3] for one in world.autopilots.values()]
        apart = min([math.hypot(x - x_m, y - y_m) for x, y in uavs])
        if apart < self.separation_m:
            self.separation_m, self.separation_s = apart, time_s
        for i, j in self._layers:
            self.uavs_apart_m = min(self.uavs_apart_m, math.dist(uavs[i], uavs[j]))
        self._looks += 1
        if self._looks % TRACK_LOOKS == 0:
            self._track.append((x_m, y_m, *itertools.chain(*uavs)))
        while self._corners and self._corners[0].onset_time_s <= time_s:
            corner = self._corners.pop(0)
            for lags, one in zip(self.lags_m, world.autopilots.values(), strict=True):
                since = one.motion.speed_mps * (time_s - corner.onset_time_s)
                lags.append(since - corner.onset.along(one.state.x_m, one.state.y_m))


def pairs_in_one_layer(scenario: Scenario) -> Iterator[tuple[int, int]]:
    """Yield the numbers of the UAVs that altitude does not keep apart."""
    altitudes = [scenario.altitude_m(i) for i in range(len(scenario.formation))]
    for i, j in itertools.combinations(range(len(altitudes)), 2):
        if abs(altitudes[i] - altitudes[j]) < LAYER_APART_M:
            yield i, j


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


def covered_from(terms: PatternTerms) -> int:
    """Return the corner from which on coverage counts: where the next leg is a search leg."""
    return COVERED_FROM_CORNER if terms.turns_one_way else COVERED_FROM_CROSS


def covered(world: World, track: np.ndarray) -> Coverage:
    """Return what was seen of what the ideal formation sees from ``covered_from`` on.

    ``track``: helicopter's and UAVs' positions, shape (n, 2 + 2 u).
    """
    scenario = world.scenario
    terms = scenario.pattern.terms
    first = covered_from(terms)
    stops = [corner.crossing_m for corner in world.corners[first - 1 :]]
    slots = [
        IdealSlot([scenario.corner.spacing_m * place for place in places])
        for places in (
            places_of(terms, first, len(stops), member.slot) for member in scenario.formation
        )
    ]
    return measure(
        track[:, :2],
        [track[:, 2 * i : 2 * i + 2] for i in range(1, len(slots) + 1)],
        ideal_tracks(np.vstack((*stops, track[-1, :2])), slots),
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
        planner, expects = flight.planner, flight.estimator.corner is not None
        if expects and not ahead:
            predicted.append(world.time_s)
        ahead = expects
        active = planner.active
        if active is not None:
            planned[active.k] = active
        if planner.problem:
            problems.update(_kinds(planner.problem))

    flight.run(observe=observe)
    world = flight.world
    coverage = reached = overlap = seen_km2 = alone_km2 = math.nan
    covered_s = 0.0
    first = covered_from(scenario.pattern.terms)
    if len(world.corners) >= first:
        area = covered(world, seen.track)
        coverage, overlap = area.percent, area.overlap_percent
        reached = area.reached_percent
        seen_km2, alone_km2 = area.covered_m2 / 1e6, area.alone_m2 / 1e6
        covered_s = world.time_s - world.corners[first - 1].stop_time_s
    return Mission(
        scenario.gps.seed,
        tuple(seen.lags_m[0]),
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
        _counted(flight),
        frozenset(problems),
        tuple(tuple(lags) for lags in seen.lags_m[1:]),
        seen.uavs_apart_m,
        alone_km2,
    )


def _counted(flight: OfflineFlight) -> dict[str, int]:
    """Return the alerts of all monitors."""
    total = Counter[str]()
    for chain in flight.chains:
        total.update({str(name): count for name, count in chain.monitor.monitor.counts.items()})
    return dict(total)


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
