"""Random changes of a formation in flight: slots exchanged, sides changed, a UAV lost, one late."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sar_planner.patterns.slot import Slot
from sar_planner.strategies.active_corner import Mode
from sar_sim.campaign.missions import pairs_in_one_layer
from sar_sim.flight.chain import Chain
from sar_sim.flight.offline import OfflineFlight
from sar_sim.scenario.formation import Member
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Scenario, load_scenario
from sar_sim.world.world import World

KINDS = ("exchanged", "other side", "farther out", "lost, replaced", "late")
CORNERS = 6
CHANGE_S = (60.0, 400.0)
LATE_M = (1200.0, 2500.0)
IN_SLOT_ACROSS_M, IN_SLOT_ALONG_M = 30.0, 60.0
CORNERS_ALLOWED = 2
THIRD_SPACING = 4.0


@dataclass(frozen=True)
class Trial:
    """One change: how it went.

    ``helicopter_m``, ``uavs_m``: the least separations from it on; of UAVs in one layer only,
    infinite where there are none. ``settled_s``: until every UAV was in its slot, NaN where one
    never was; ``corners``: begun by then. ``escapes``: of all monitors.
    """

    seed: int
    kind: str
    helicopter_m: float
    uavs_m: float
    settled_s: float
    corners: int
    escapes: int


def random_scenario(seed: int) -> tuple[Scenario, str, float]:
    """Return a mission behind a human, what is changed in it, and when [s]."""
    rng = np.random.default_rng([seed, 11])
    kind = KINDS[seed % len(KINDS)]
    base = load_scenario(find_scenario("human"))
    spacings = THIRD_SPACING if kind == "lost, replaced" else 3.0
    late_m = float(rng.uniform(*LATE_M)) if kind == "late" else 0.0
    members = [
        Member("uav1", "inside", lag_m=float(rng.uniform(-50.0, 300.0))),
        Member("uav2", "outside", lag_m=late_m or float(rng.uniform(0.0, 300.0))),
    ]
    if kind == "lost, replaced":
        members.append(Member("uav3", "inside", 2, lag_m=float(rng.uniform(0.0, 300.0))))
    layered = bool(rng.random() < 0.5)
    spacing_m = spacings * base.corner.spacing_m
    scenario = replace(
        base,
        pattern=replace(base.pattern, corners=CORNERS, track_spacing_m=spacing_m),
        pilot=replace(base.pilot, seed=seed),
        gps=replace(base.gps, seed=seed),
        formation=members,
        layer_m=base.layer_m if layered or len(members) > 2 else 0.0,
    )
    return scenario, kind, 0.0 if kind == "late" else float(rng.uniform(*CHANGE_S))


class _Change:
    """Does what is to be done, once."""

    def __init__(self, flight: OfflineFlight, kind: str, at_s: float) -> None:
        self._flight, self._kind, self._at_s = flight, kind, at_s
        self.done = False
        self.led: list[Chain] = list(flight.chains)

    def __call__(self, time_s: float) -> None:
        if self.done or time_s < self._at_s:
            return
        self.done = True
        chains = self._flight.chains
        act: dict[str, Callable[[], None]] = {
            "exchanged": lambda: self._slots(chains[1].mission.parameters.slot, Slot("inside")),
            "other side": lambda: self._slots(Slot("outside"), Slot("outside", 2)),
            "farther out": lambda: self._slots(Slot("inside", 2), Slot("outside", 2)),
            "lost, replaced": self._lose,
            "late": lambda: None,
        }
        act[self._kind]()

    def _slots(self, *slots: Slot) -> None:
        for chain, slot in zip(self._flight.chains, slots, strict=False):
            answer = chain.planner.change_slot(slot)
            assert answer.success, answer.message

    def _lose(self) -> None:
        """Send the first UAV home; the third takes its slot."""
        first, _, third = self._flight.chains
        first.leave()
        self.led.remove(first)
        assert third.planner.change_slot(Slot("inside")).success


def in_slot(chain: Chain) -> bool:
    """Whether a UAV is led on a leg, beside the helicopter, where it has its place."""
    planner = chain.mission
    slot, uav = planner.situation.slot, planner.situation.uav
    lag_m = planner.situation.lag_m(slot)
    if planner.mode is not Mode.LEG or slot is None or uav is None or lag_m is None:
        return False
    beside = abs(slot.across(uav.x_m, uav.y_m)) < IN_SLOT_ACROSS_M
    return beside and abs(lag_m) < IN_SLOT_ALONG_M


def fly(seed: int) -> Trial:
    """Fly one."""
    scenario, kind, at_s = random_scenario(seed)
    flight = OfflineFlight(scenario)
    change = _Change(flight, kind, at_s)
    in_layer = any(pairs_in_one_layer(scenario))
    helicopter_m = uavs_m = math.inf
    settled_s, corners = math.nan, 0

    def observe(world: World) -> None:
        nonlocal helicopter_m, uavs_m, settled_s, corners
        change(world.time_s)
        assert world.helicopter is not None
        if world.time_s < at_s:
            return
        helicopter = world.helicopter.motion(world.time_s)
        at = [world.autopilots[chain.name].motion for chain in change.led]
        apart = [math.hypot(one.x_m - helicopter.x_m, one.y_m - helicopter.y_m) for one in at]
        helicopter_m = min(helicopter_m, *apart)
        if in_layer:
            one, other = at
            uavs_m = min(uavs_m, math.hypot(one.x_m - other.x_m, one.y_m - other.y_m))
        if math.isnan(settled_s) and all(in_slot(chain) for chain in change.led):
            settled_s = world.time_s - at_s
            begun = [one.onset_time_s for one in world.corners]
            corners = sum(at_s <= onset <= world.time_s for onset in begun)

    flight.run(observe=observe)
    escapes = sum(chain.monitor.monitor.counts["escape"] for chain in flight.chains)
    return Trial(seed, kind, helicopter_m, uavs_m, settled_s, corners, escapes)


def summary(trials: list[Trial]) -> str:
    """Return what came of them, a line for each kind."""
    head = "change          trials  in slot within 2 corners  after [s] median/95 %  "
    lines = [f"{head}least to the helicopter [m]  under 200/180  UAVs in one layer [m]  escapes"]
    for kind in (*KINDS, "all"):
        some = [trial for trial in trials if kind in (trial.kind, "all")]
        if not some:
            continue
        times = np.array([t.settled_s for t in some if not math.isnan(t.settled_s)])
        good = sum(not math.isnan(t.settled_s) and t.corners <= CORNERS_ALLOWED for t in some)
        least = np.array([t.helicopter_m for t in some])
        between = min(t.uavs_m for t in some)
        middle, late = np.percentile(times, (50, 95)) if times.size else (math.nan, math.nan)
        lines.append(
            f"{kind:<16}{len(some):6d}{100.0 * good / len(some):25.1f}%{middle:14.0f}/{late:<8.0f}"
            f"{least.min():22.0f}{(least < 200.0).sum():14d}/{(least < 180.0).sum():<4d}"
            f"{between:21.0f}{sum(t.escapes for t in some):11d}"
        )
    return "\n".join(lines)
