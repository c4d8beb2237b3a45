"""A mission flown offline: the components that fly, in lockstep, without DDS and sockets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from sar_bridge.monitor.component import MonitorComponent
from sar_bridge.monitor.separation_monitor import SeparationMonitor
from sar_estimator.bags.bag import BagWriter, serialised
from sar_estimator.common import topics
from sar_estimator.common.component import Component
from sar_estimator.common.conversions import stamped_s
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import Target
from sar_estimator.common.states import Motion
from sar_estimator.common.wires import Quality
from sar_estimator.estimation.component import EstimatorComponent
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_planner.component import PlannerComponent
from sar_planner.mission_planner import MissionPlanner
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.patterns.legs import PatternTerms
from sar_sim.flight.bus import Bus, Joined, Listener
from sar_sim.flight.chain import Chain
from sar_sim.flight.upload import SimulatedBridge
from sar_sim.scenario.monitor import limits_of, model_of
from sar_sim.scenario.scenario import Find, Scenario
from sar_sim.world.detour import found_beside, place
from sar_sim.world.finder import Finder
from sar_sim.world.truth import TruthComponent
from sar_sim.world.wires import ALL_WIRES
from sar_sim.world.world import World

STEPS_PER_TICK = 2
STEPS_PER_GUARD = 5
STEPS_PER_STATUS = 10
LATCHED = {topic for topic, wire in ALL_WIRES.items() if wire.quality is Quality.LATCHED}


def message_kind(message: Any) -> str:
    """Return a message's type as ``pkg/msg/Name``."""
    package = type(message).__module__.split(".")[0]
    return f"{package}/msg/{type(message).__name__}"


def monitor_for(
    corner: CornerParameters,
    terms: PatternTerms,
    *,
    watch_only: bool = False,
    others: Sequence[str] = (),
) -> MonitorComponent:
    """Return the monitor of a UAV's mission, as the launcher sets it up."""
    limits, model = limits_of(corner, watch_only=watch_only), model_of(corner, terms)
    return MonitorComponent(limits, model, others=others)


@dataclass(frozen=True, slots=True)
class Progress:
    """What is told while flying."""

    time_s: float
    end_s: float
    corner: int
    rule: str
    lag_m: float | None
    separation_m: float | None


class OfflineFlight:
    """One mission.

    ``truth`` replaces the estimator by the helicopter's true state. ``watch_only``: the monitor
    says what it sees and does nothing. ``chains``: what leads each UAV, the formation's first one
    first.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        rules: str = "deadbeat",
        truth: bool = False,
        watch_only: bool = False,
        track: list[Fix] | None = None,
        estimator_parameters: EstimatorParameters | None = None,
        bag: BagWriter | None = None,
    ) -> None:
        """Set everything up. Raises ``ValueError`` for a mission that cannot be flown."""
        self.world = world = World(scenario, track)
        self._bag = bag
        self._helicopter: Component
        self._truth = truth
        if truth:
            if world.helicopter is None:
                raise ValueError("truth: expected a simulated helicopter, not a recorded track")
            self._helicopter = TruthComponent(world.helicopter, world.datum)
        else:
            parameters = estimator_parameters or EstimatorParameters(
                expected_legs_m=() if track else scenario.pattern.terms.lengths_m()
            )
            self._helicopter = EstimatorComponent(parameters, world.datum)
        self.chains = [
            self._chain(i, rules, watch_only=watch_only) for i in range(len(scenario.formation))
        ]
        joined = [Joined(self._helicopter)]
        listeners: dict[str, Listener] = {}
        for chain in self.chains:
            joined += chain.joined
            listeners |= chain.listeners
        self._joined = tuple(joined)
        self._bus = Bus(
            self._joined, record=None if bag is None else self._record, listeners=listeners
        )
        self._finder = Finder(scenario.finds)
        self._corners = list(world.corners)
        self._steps = 0
        self._bus.now_s = self._clock_s()

    def _chain(self, number: int, rules: str, *, watch_only: bool) -> Chain:
        """Return what leads the formation's UAV of a number."""
        world, scenario = self.world, self.world.scenario
        member = scenario.formation[number]
        told = scenario.planner_parameters(number, recorded=world.helicopter is None)
        mission = MissionParameters(**told, rules=rules)
        if self._truth:
            mission = replace(mission, reaction_s=0.0, most_reaction_s=0.0)
        autopilot = world.autopilots[member.name]
        bridge = SimulatedBridge(
            autopilot,
            world.datum,
            altitude_m=scenario.altitude_m(number),
            item_s=scenario.uav.item_s,
        )
        terms = scenario.pattern.terms
        return Chain(
            member.name,
            PlannerComponent(scenario.corner, mission, yields_to=scenario.before(number)),
            monitor_for(
                scenario.corner, terms, watch_only=watch_only, others=scenario.others(number)
            ),
            bridge,
            autopilot,
        )

    @property
    def planner(self) -> MissionPlanner:
        """The first UAV's planner."""
        return self.chains[0].mission

    @property
    def monitor(self) -> SeparationMonitor:
        """The first UAV's monitor."""
        return self.chains[0].monitor.monitor

    @property
    def estimator(self) -> Any:
        """The estimator, or the simulation's truth in its place."""
        helicopter: Any = self._helicopter
        return helicopter.estimator

    def _clock_s(self) -> float:
        """Return the mission's clock [s], as stamps carry it."""
        return stamped_s(self.world.epoch_s + self.world.time_s)

    def run(
        self,
        progress: Callable[[Progress], None] | None = None,
        *,
        observe: Callable[[World], None] | None = None,
    ) -> None:
        """Fly to the end; ``progress`` is told once a simulated second, ``observe`` every tick."""
        self._bus.start(self._joined)
        self._record(topics.SCENARIO, self.world.scenario)
        for chain in self.chains:
            chain.start(self._bus)
        while not self.world.finished:
            self._step()
            if observe is not None and self._steps % STEPS_PER_TICK == 0:
                observe(self.world)
            if progress is not None and self._steps % STEPS_PER_STATUS == 0:
                progress(self.progress())

    def progress(self) -> Progress:
        """Return how far the mission is."""
        return Progress(
            self.world.time_s,
            self.world.end_s,
            self.planner.situation.corners_seen,
            self.planner.rule,
            self.planner.lag_m(),
            self.planner.situation.separation_m(),
        )

    def _record(self, topic: str, value: Any) -> None:
        if self._bag is not None:
            plain = topics.plain(topic)
            message = ALL_WIRES[plain].to_message(value, self._bus.now_s)
            kind = message_kind(message)
            data = serialised(kind, message)
            self._bag.write(topic, kind, data, self._bus.now_s, latched=plain in LATCHED)

    def _step(self) -> None:
        receptions = self.world.step()
        bus, time_s = self._bus, self.world.time_s
        bus.now_s = self._clock_s()
        self._steps += 1
        for chain in self.chains:
            chain.step(bus, time_s)
        while self._corners and self._corners[0].onset_time_s <= time_s:
            self._record(topics.TRUE_CORNER, self._corners.pop(0))
        for reception in receptions:
            bus.receive(reception)
        if self.world.scenario.finds:
            self._find()
        decides = self._truth or receptions or self._steps % STEPS_PER_TICK == 0
        if decides:
            self._tell_motions()
        for chain in self.chains:
            if decides:
                chain.decide(bus)
            if self._bag is not None and self._steps % STEPS_PER_STATUS == 0:
                chain.report(bus)
            if self._steps % STEPS_PER_GUARD == 0:
                chain.guard(bus)

    def _find(self) -> None:
        """Do what is due of the scenario's finds."""
        due = self._finder.due(self.world.time_s)
        if due is None:
            return
        what, find = due
        if what == topics.TARGET:
            mark = self._found_at(find)
            self._bus.publish(what, Target(self._bus.now_s, mark.x_m, mark.y_m))
            self._finder.granted()
            return
        if self.chains[0].ask(self._bus, what).success:
            self._finder.granted()

    def _found_at(self, find: Find) -> Pose:
        """Return where a find is; beside a recorded helicopter by what was estimated of it."""
        helicopter = self.world.helicopter
        if helicopter is not None:
            return found_beside(helicopter, find)
        estimated = self.planner.situation.helicopter or Motion(0.0, 0.0, 0.0, 0.0, 0.0)
        return place(find, estimated, estimated.course_rad)

    def _tell_motions(self) -> None:
        """Tell where all aircraft are; the helicopter, for which all wait, last."""
        if self._bag is not None:
            for topic, truth in self.world.truth(self._bus.now_s):
                self._record(topic, truth)
        for chain in self.chains:
            chain.tell(self._bus)
        self._bus.tick(self._helicopter)
