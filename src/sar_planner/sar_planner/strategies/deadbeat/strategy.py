"""The closed loop in flight: deadbeat rules, corrections inside the corner, rejoining, speed trim.

Whatever the UAV does off its slot track is a path onto the slot that the helicopter's motion to
come defines. At a corner the deadbeat rules choose it; from anywhere else ``rejoin`` does. While it
is flown it is looked at with every decision: where will it end, and will it stay apart? When that
is no longer as wanted, what is left of it is solved again from where the UAV really is.
"""

from __future__ import annotations

import math

from sar_estimator.common.frozen import replaced
from sar_estimator.common.states import LegEstimate, Phase
from sar_planner.guidance.leg_lag import drift_m
from sar_planner.guidance.path_efficiency import PathEfficiency
from sar_planner.guidance.turn_radius import Turns
from sar_planner.guidance.waypoint_lists import Listed
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.prediction.situation import Situation
from sar_planner.strategies.active_corner import ActiveCorner, Mode
from sar_planner.strategies.deadbeat.corner_planning import commit_when_due, plan_corner
from sar_planner.strategies.deadbeat.leg_following import follow_leg, hold, unfit_speed
from sar_planner.strategies.deadbeat.path_following import follow_path
from sar_planner.strategies.deadbeat.state import (
    WATCH_S,
    Decision,
    State,
    Tick,
)
from sar_planner.strategies.deadbeat.surely_apart import with_sure
from sar_planner.strategies.strategy import Strategy, StrategyReport

MOST_AIM_SPACINGS = 1.2
"""The most lag that is aimed at for the wind's sake, either way: a corner is flown from there."""
WARY_SPACINGS = 0.5
"""The lag left by a UAV's first corner: who turns wider than is known is not abeam then."""


class DeadbeatStrategy(Strategy):
    """Slot track with speed trim on legs, paths everywhere else.

    ``state``: the one thing that changes; only this class assigns it.
    """

    def __init__(
        self, situation: Situation, corner: CornerParameters, mission: MissionParameters
    ) -> None:
        """Begin on a leg."""
        super().__init__(situation, corner, mission)
        self.state = State(PathEfficiency(mission.bias_gain))
        self._reported: tuple[State, StrategyReport] | None = None

    @property
    def report(self) -> StrategyReport:
        """What is told of the state, worked out once for each: it is asked for again and again."""
        if self._reported is None or self._reported[0] is not self.state:
            self._reported = self.state, self._report()
        return self._reported[1]

    def _report(self) -> StrategyReport:
        state = self.state
        notes = (state.problem, state.path_problem, state.corner_problem)
        return StrategyReport(
            mode=state.mode,
            corner=state.corner,
            slot=state.slot,
            speed_mps=state.speed_mps,
            course_rad=self._course_rad,
            problem="; ".join(note for note in notes if note),
            efficiency=state.efficiency.share,
            lag_setpoint_m=state.aim_m,
            corrections=state.corrections,
        )

    @property
    def _course_rad(self) -> float:
        """The course on which the UAV will be when a speed asked for now is flown."""
        path, slot, uav = self.state.path, self.state.slot, self._s.uav
        if path is None or uav is None:
            return 0.0 if slot is None else slot.heading_rad
        if self.state.is_lost:
            return uav.course_rad
        # As far as it really gets: one that stands in the wind is told what it needs here.
        ahead_m = path.flown_m + self._mission.speed_lead_s * uav.speed_mps
        there = path.path.pose_at(min(max(ahead_m, 0.0), path.path.length_m))
        return path.frame.pose_to_map(there).heading_rad

    def begin(self) -> None:
        """Begin to lead; a corner that is already over is not planned."""
        self.lists.forget()
        state = replaced(self.state, led_s=-math.inf, problem="")
        if state.mode is Mode.HOLD:
            state = state.without_path(Mode.LEG)
        if self._s.phase is not Phase.DECELERATING:
            state = replaced(state, done_corner=self._s.corners_seen)
        self.state = state

    def refused(self, now_s: float) -> None:
        """Take note that the newest list is not flown: what was flown before it still is."""
        self.state = self.state.refused(now_s + self._mission.retry_s)

    def end(self) -> None:
        """Stop leading."""
        self.state = replaced(self.state.without_path(Mode.LEG), speed_mps=None)

    def believes(self, leg: LegEstimate) -> bool:
        """Whether a leg is not older than the last stop."""
        estimate = self._s.estimate
        return estimate is None or self._s.went_on or leg.time_s >= estimate.stop_time_s

    def set_clock_back(self) -> None:
        """Forget the path being flown."""
        self.lists.forget()
        mode = Mode.HOLD if self.state.mode is Mode.HOLD else Mode.LEG
        self.state = replaced(
            self.state.without_path(mode),
            planned=None,
            retry_s=-math.inf,
            corrected_s=-math.inf,
            done_corner=self._s.corners_seen,
        )

    def update(self, now_s: float) -> Listed | None:
        """Return the mode and the waypoints of a new list when one is due."""
        state = self.state
        if self._s.phase is Phase.CRUISE and state.led_s <= now_s < state.led_s + WATCH_S:
            return None  # it keeps its place on a leg, looked at a moment ago: what was said stands
        if self._learn_radius(None if state.path is None else state.path.path):
            # What wide turns have cost until now is no bias of the next corner.
            state = replaced(state, efficiency=state.efficiency.restarted())
        air, turns = self.lists.air, self._believed_turns
        tick = tick_at(now_s, self._s, self._corner, self._mission, air, turns, state)
        if tick.forecasts:
            self.lists.side = tick.slot_frame.turn_side
        decision = decide(state, tick)
        self.state = decision.state
        if decision.listing is None or self._s.uav is None:
            return None
        self.state = with_sure(decision.state, tick).listed(state)
        return self.lists.make(decision.listing, self._s.uav)


def tick_at(
    now_s: float,
    situation: Situation,
    corner: CornerParameters,
    mission: MissionParameters,
    air: AirEnvelope,
    turns: Turns,
    state: State,
) -> Tick:
    """Return what a decision is taken from: with the lag that the wind and the UAV ask for."""
    forecasts = situation.forecasts(now_s)
    if not forecasts:
        return Tick(now_s, situation, forecasts, corner, mission, air, turns)
    expected, *others = forecasts
    heading, speed = expected.leg.heading_rad, expected.speed_mps
    most_m = MOST_AIM_SPACINGS * corner.spacing_m
    aim_m = state.lag_setpoint_m + drift_m(air, heading, speed, situation.left_m(heading))
    wary_m = _wary_m(situation, corner, turns, state.corner, heading)
    aim_m = min(max(aim_m + wary_m, -most_m), most_m)
    forecasts = (expected.behind(aim_m), *others)
    return Tick(now_s, situation, forecasts, corner, mission, air, turns, aim_m, wary_m)


def _wary_m(
    situation: Situation,
    corner: CornerParameters,
    turns: Turns,
    flown: ActiveCorner | None,
    heading_rad: float,
) -> float:
    """Return the lag [m] that the first corner is to leave, of a UAV not seen in a turn yet."""
    if situation.went_on or situation.progress.stays_outside(heading_rad):
        return 0.0
    wary = not turns.is_sure and situation.phase is not Phase.CRUISE
    if flown is not None:
        wary = flown.unsure
    return WARY_SPACINGS * corner.spacing_m if wary else 0.0


def decide(state: State, tick: Tick) -> Decision:
    """Return what is to be done: the corner ahead first, then the path, then the leg."""
    situation = tick.situation
    went_on = situation.went_on
    given_up = went_on and not state.went_on
    state = replaced(state, problem="", led_s=-math.inf, went_on=went_on, aim_m=tick.aim_m)
    if not tick.forecasts:
        problem = "helicopter's leg not known: the UAV stays on its list"
        return Decision(replaced(state, problem=problem))
    if state.path is not None and went_on:
        # The corner was none: a UAV that is still on its leg, or has not turned, stays there.
        begun = state.corner is None or state.corner.committed
        if not begun or (given_up and tick.on_slot()):
            state = state.left(tick)
    state = replaced(state, slot=tick.slot_frame.origin)
    planned = plan_corner(state, tick)
    if not planned.goes_on:
        return planned
    state = planned.state
    if state.corner is not None and not state.corner.committed:
        return Decision(commit_when_due(state, tick))
    unfit = unfit_speed(tick)
    if unfit:
        return hold(state, tick, unfit)
    if state.mode is Mode.HOLD:
        state = state.without_path(Mode.LEG)
    return follow_leg(state, tick) if state.path is None else follow_path(state, tick)
