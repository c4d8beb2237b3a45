"""Random finds: marked, orbited and left again in whole missions, offline."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from sar_estimator.common.reports import Mark
from sar_planner.strategies.active_corner import Mode
from sar_sim.flight.offline import OfflineFlight
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Find, FindKind, Scenario, load_scenario
from sar_sim.world.world import World

CORNERS = 5
PILOTS = ("goes on", "stands at corners", "breaks off", "comes to hover", "circles", "stays")
COMES: dict[str, FindKind] = {"comes to hover": "hovers", "circles": "circles", "stays": "stays"}
TIMES_S, ORBITS_S = (60.0, 450.0), (120.0, 400.0)
AROUND_M = 1000.0
UNDER_SHARE = 0.25
HOVER_S = 120.0
HOVERS_S = (30.0, 240.0)
FAR_M, STANDING_MPS = 1000.0, 2.0
ON_CIRCLE_M = 50.0


@dataclass(frozen=True)
class Trial:
    """One find: how it went.

    ``pilot``: what he does. ``wait_s``: from the order to the first list; ``reach_s``: to the
    circle, NaN where it was not reached. ``held``: for which share of the time it was on it from
    then on, of when the helicopter stood or was far: it makes way for one that comes or leaves.
    ``closest_m``: to the helicopter, from the order to the mission's end; ``orbit_closest_m``:
    until the UAV was called back. ``regained``: whether it was in formation again.
    """

    seed: int
    pilot: str
    wait_s: float
    reach_s: float
    held: float
    closest_m: float
    orbit_closest_m: float
    escapes: int
    regained: bool


def random_scenario(seed: int) -> tuple[Scenario, str]:
    """Return a mission behind a human with a find in it, and what the pilot does."""
    rng = np.random.default_rng(seed)
    base = load_scenario(find_scenario("human"))
    kind = PILOTS[seed % len(PILOTS)]
    pilot = replace(base.pilot, seed=seed)
    if kind == "stands at corners":
        pilot = replace(pilot, hover_s=HOVER_S)
    elif kind == "breaks off":
        pilot = replace(pilot, anomaly_corner=int(rng.integers(2, CORNERS)), anomaly="break_off")
    under = rng.random() < UNDER_SHARE
    ahead_m, left_m = (0.0, 0.0) if under else rng.uniform(-AROUND_M, AROUND_M, 2)
    find = Find(
        time_s=float(rng.uniform(*TIMES_S)),
        orbit_s=float(rng.uniform(*ORBITS_S)),
        ahead_m=float(ahead_m),
        left_m=float(left_m),
        helicopter=COMES.get(kind, "goes_on"),
        hover_s=float(rng.uniform(*HOVERS_S)),
    )
    scenario = replace(
        base,
        pattern=replace(base.pattern, corners=CORNERS),
        pilot=pilot,
        gps=replace(base.gps, seed=seed),
        finds=[find],
    )
    return scenario, kind


class _Observer:
    """Watches a mission with one find."""

    def __init__(self, flight: OfflineFlight, find: Find) -> None:
        self._flight, self._find = flight, find
        self.wait_s = self.reach_s = math.nan
        self.closest_m = self.orbit_closest_m = math.inf
        self.on: list[bool] = []

    def __call__(self, world: World) -> None:
        since_s = world.time_s - self._find.time_s
        if since_s < 0.0 or world.helicopter is None:
            return
        helicopter, uav = world.helicopter.motion(world.time_s), world.autopilot.motion
        apart_m = math.hypot(helicopter.x_m - uav.x_m, helicopter.y_m - uav.y_m)
        self.closest_m = min(self.closest_m, apart_m)
        planner = self._flight.planner
        mark = planner.find.marks.newest
        if planner.mode is Mode.ORBIT and mark is not None:
            self.orbit_closest_m = min(self.orbit_closest_m, apart_m)
            away_m = math.hypot(helicopter.x_m - mark.x_m, helicopter.y_m - mark.y_m)
            alone = away_m > FAR_M or helicopter.speed_mps < STANDING_MPS
            self._orbit(mark, since_s, (uav.x_m, uav.y_m), alone=alone)

    def _orbit(self, mark: Mark, since_s: float, uav: tuple[float, float], *, alone: bool) -> None:
        if math.isnan(self.wait_s):
            self.wait_s = since_s
        state = self._flight.planner.find.orbit.state
        radius_m = self._flight.planner.parameters.orbit_radius_m
        if state is not None and state.path is not None:
            radius_m = state.circle_m
        off_m = abs(math.hypot(uav[0] - mark.x_m, uav[1] - mark.y_m) - radius_m)
        if math.isnan(self.reach_s) and off_m < ON_CIRCLE_M:
            self.reach_s = since_s
        if alone and not math.isnan(self.reach_s):
            self.on.append(off_m < ON_CIRCLE_M)


def fly(seed: int) -> Trial:
    """Fly one."""
    scenario, kind = random_scenario(seed)
    flight = OfflineFlight(scenario)
    seen = _Observer(flight, scenario.finds[0])
    flight.run(observe=seen)
    slot = flight.planner.situation.slot
    uav = flight.planner.situation.uav
    regained = False
    if slot is not None and uav is not None:
        regained = abs(slot.across(uav.x_m, uav.y_m)) < 50.0 and flight.planner.mode is Mode.LEG
    return Trial(
        seed,
        kind,
        seen.wait_s,
        seen.reach_s,
        float(np.mean(seen.on)) if seen.on else math.nan,
        seen.closest_m,
        seen.orbit_closest_m,
        int(flight.monitor.counts["escape"]),
        regained,
    )
