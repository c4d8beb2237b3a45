"""The deadbeat strategy's state, what every decision is taken from, and what comes of one.

Activities are functions of a ``State`` and a ``Tick``. They return a ``Decision``; what follows
another activity in the same tick takes the state that it left. Nothing in them is assigned.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from sar_estimator.common.frozen import replaced
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate
from sar_planner.guidance.flown_speed import FlownPath, airspeed_of, flown
from sar_planner.guidance.path_efficiency import PathEfficiency
from sar_planner.guidance.turn_radius import Turns
from sar_planner.guidance.waypoint_lists import Listing
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.prediction.forecast import Forecast
from sar_planner.prediction.situation import Situation
from sar_planner.rejoin.tracked_path import TrackedPath, is_on_track
from sar_planner.rules.corner_speed import CornerSpeed, corner_speeds, lag_to_begin_with_m
from sar_planner.rules.paper_rules import OUTSIDE, Rule
from sar_planner.strategies.active_corner import ActiveCorner, Mode

MARGIN_SHARE = 0.4  # of the margin: what a path that is flown may have lost of it
AHEAD_SPACINGS = 2.0  # on a cross leg, onto which the UAV came ahead
ENDS_SOON_S = 40.0  # a leg, before which a UAV that is ahead would not be back on it
OUTSIDE_SLOWER = 0.3  # share of V by which a UAV flies slower about the outside of a corner
TURNED_FASTER = 0.2  # share of V, by which it flies faster at most where it turns there
CROSSING_SLOWER = 0.3  # share of V by which a UAV flies slower on a cross leg
UNSURE_SPACINGS = 0.16  # planned beyond the least separation before it was seen how a UAV turns
LATER_S = 1.0  # a lag for corners is one for those, too, that are seen later than as a rule
REFUSED_ROOM_M, MOST_REFUSALS = 15.0, 3
WATCH_S = 0.39  # between two looks: two decisions at 5 Hz, whatever their times round to

NEEDS = {
    Mode.LEG: (False, False),
    Mode.HOLD: (False, False),
    Mode.REJOIN: (False, True),
    Mode.CORNER: (True, True),
}
"""Whether a mode has a corner, and a path."""


@dataclass(frozen=True)
class State:
    """Everything that the strategy remembers from one decision to the next.

    ``mode``: LEG, CORNER, REJOIN or HOLD. ``corner``: the corner being flown, in CORNER only.
    ``path``: the path being flown, in CORNER and REJOIN. ``slot``: the slot track now.
    ``speed_mps``: the ground speed asked for, None where it is left to the autopilot.
    ``speed_up``: of the path, over V. ``lag_setpoint_m``: kept on legs. ``planned``: the estimate
    that a corner was planned from last; ``done_corner``: the last one that needs no plan any more.
    ``went_on``: the corner that was predicted was none. ``aim_m``: the lag that the wind asks
    for. ``planned_radius_m``: of turns of the path. ``speed_share``: what of the path's speed
    the wind and the airspeeds are expected to let the UAV make good on the rest of it.
    ``is_lost``: the UAV flies something else than the path: its list was refused, or never came.
    ``before``: what was flown before the newest list; what is flown still where that is refused.
    ``refusals``: how many lists were refused since the UAV left its leg.
    ``followed_s``, ``led_s``: when a path, a leg was looked at last; ``corrected_s``: when a
    path was corrected last; ``retry_s``: before which none is. ``problem``: of the last
    decision; ``path_problem``, ``corner_problem``: as long as path or corner are flown.
    Raises ``ValueError`` for a mode without what it needs, or with what it has no use for.
    """

    efficiency: PathEfficiency
    mode: Mode = Mode.LEG
    corner: ActiveCorner | None = None
    path: TrackedPath | None = None
    slot: Pose | None = None
    speed_mps: float | None = None
    speed_up: float = 1.0
    lag_setpoint_m: float = 0.0
    planned_radius_m: float = 0.0
    speed_share: float = 1.0
    planned: CornerEstimate | None = None
    done_corner: int = 0
    went_on: bool = False
    aim_m: float = 0.0
    corrections: int = 0
    retry_s: float = -math.inf
    is_lost: bool = False
    before: State | None = None
    refusals: int = 0
    followed_s: float = -math.inf
    corrected_s: float = -math.inf
    led_s: float = -math.inf
    problem: str = ""
    path_problem: str = ""
    corner_problem: str = ""

    def __post_init__(self) -> None:
        """Check that the mode has what it needs."""
        has = self.corner is not None, self.path is not None
        if NEEDS.get(self.mode) != has:
            raise ValueError(f"{self.mode}: corner and path are {has}")

    @property
    def room_m(self) -> float:
        """What a path keeps beyond what is wanted, as others were refused [m].

        After the third that is more than the slot has: then the way leads out, not into it.
        """
        return REFUSED_ROOM_M * self.refusals

    @property
    def share(self) -> float:
        """What is made good of the path's speed; off corners all that the wind lets it."""
        return self.speed_share * self.made_good

    @property
    def made_good(self) -> float:
        """What an autopilot makes good of its speed on the path, whatever the wind."""
        return 1.0 if self.corner is None else self.efficiency.now

    @property
    def planned_share(self) -> float | None:
        """The speed over V that a rule's path is planned with; None where none is flown."""
        by_rule = self.corner is not None and self.corner.plan.rule is not Rule.RJ
        return self.speed_up if by_rule else None

    @property
    def flies_outside(self) -> bool:
        """Whether the path being flown leads about the outside of a corner."""
        return self.corner is not None and self.corner.plan.rule in OUTSIDE

    def without_path(self, mode: Mode) -> State:
        """Return the state in a mode that flies no path; a corner that was flown is done."""
        done = self.done_corner if self.corner is None else self.corner.k
        begun = self.corner is not None and self.corner.committed
        efficiency = self.efficiency.learnt() if begun else self.efficiency.cancelled()
        return replaced(
            self,
            mode=mode,
            corner=None,
            path=None,
            is_lost=False,
            refusals=0,
            speed_up=1.0,
            done_corner=done,
            efficiency=efficiency,
        )

    def on_path(self, path: TrackedPath, tick: Tick, corner: ActiveCorner | None = None) -> State:
        """Return the state with another path from now on.

        Of ``corner``, or of the one that is flown; rejoining where there is none.
        """
        corner = self.corner if corner is None else corner
        return replaced(
            self,
            mode=Mode.REJOIN if corner is None else Mode.CORNER,
            corner=corner,
            path=path,
            speed_mps=path.speed_mps,
            speed_share=tick.speed_share(path),
            is_lost=False,
            planned_radius_m=tick.corner.turn_radius_m,
            followed_s=tick.now_s,
            path_problem="",
        )

    def listed(self, before: State) -> State:
        """Return the state once a list goes out, after one in which another was flown."""
        return replaced(self, before=replaced(before, before=None))

    def refused(self, retry_s: float) -> State:
        """Return the state once the newest list was refused, not to be solved again before a time.

        The UAV is on the path that it had before; where it had none it flies on along its leg, and
        the path of this state is one that nobody flies. Who was refused asks for more room.
        """
        before = self.before
        if self.path is None or before is None:
            return self
        on_leg = before.path is None
        return replaced(
            self,
            before=None,
            refusals=min(self.refusals + 1, MOST_REFUSALS),
            efficiency=self.efficiency.moved(),
            corner=None if self.corner is None else replaced(self.corner, sure=None),
            retry_s=retry_s,
            path=self.path if on_leg else before.path,
            is_lost=on_leg or before.is_lost,
            speed_mps=self.speed_mps if before.speed_mps is None else before.speed_mps,
            speed_up=before.speed_up,
            speed_share=before.speed_share,
            planned_radius_m=before.planned_radius_m,
            followed_s=before.followed_s,
        )

    def left(self, tick: Tick) -> State:
        """Return the state once a path is flown, or no longer wanted: on the leg."""
        leg = replaced(self.without_path(Mode.LEG), path_problem="")
        if self.corner is None or not self.corner.committed:
            return leg
        return replaced(leg, lag_setpoint_m=tick.lag_setpoint_m(leg.efficiency.share))


@dataclass(frozen=True)
class Tick:
    """What a decision is taken from, all of it at ``now_s``.

    ``forecasts``: the motion that is expected of the helicopter, then others that must be kept
    apart from too; none while its leg is not known. The slot of the first is ``aim_m`` [m] behind:
    what is wanted of the lag for what the wind does along the leg. ``corner``: with the radius that
    was learnt; ``turns``: what is believed of it. ``wary_m``: what of ``aim_m`` is for that nobody
    knows it yet: on a leg no reason to lead the UAV back.
    """

    now_s: float
    situation: Situation
    forecasts: tuple[Forecast, ...]
    corner: CornerParameters
    mission: MissionParameters
    air: AirEnvelope
    turns: Turns
    aim_m: float = 0.0
    wary_m: float = 0.0

    @property
    def expected(self) -> Forecast:
        """The motion that is expected of the helicopter."""
        return self.forecasts[0]

    @cached_property
    def slot_frame(self) -> CornerFrame:
        """The frame of the slot track of the leg that is expected in the end."""
        return self.situation.slot_frame(self.expected.leg)

    @property
    def margin_m(self) -> float:
        """What is planned beyond the least separation [m]."""
        return self.situation.margin_m(self.mission)

    @property
    def separations_m(self) -> tuple[float, float, float]:
        """The separations to plan with, the most wanted one first."""
        least = self.corner.separation_m
        wanted = least + self.margin_m, least + MARGIN_SHARE * self.margin_m, least
        if self.turns.is_sure:
            return wanted
        # Nobody knows how wide it turns, or how much it makes good meanwhile.
        return least + UNSURE_SPACINGS * self.corner.spacing_m, *wanted[1:]

    @property
    def faster(self) -> float:
        """The share of V by which the UAV may be asked to fly faster."""
        stays = self.situation.progress.stays_inside
        return self.mission.speed_trim if stays else self.mission.outside_speed_up

    @property
    def turned_faster(self) -> float:
        """The same where it turns with the radius that is planned with."""
        return min(self.faster, TURNED_FASTER)

    @property
    def on_cross_leg(self) -> bool:
        """Whether the UAV is on a cross leg outside of its turns, onto which it came ahead."""
        progress = self.situation.progress
        crosses = progress.is_cross_leg(self.expected.leg.heading_rad)
        return crosses and progress.slot.side == "inside"

    @property
    def slower(self) -> float:
        """The share of V by which the UAV may be asked to fly slower on a leg."""
        return CROSSING_SLOWER if self.on_cross_leg else self.mission.speed_trim

    @property
    def most_ahead_m(self) -> float:
        """How far ahead of its slot the UAV may be on a leg before it is led back [m].

        Outside of a turn that is near it is no longer led back: it is not to be met on its way. Nor
        while it is still behind the helicopter.
        """
        if self.on_cross_leg:
            return AHEAD_SPACINGS * self.corner.spacing_m
        heading, speed_mps = self.expected.leg.heading_rad, self.expected.speed_mps
        ends_soon = self.situation.left_m(heading) < ENDS_SOON_S * speed_mps
        if not self.situation.progress.stays_outside(heading):
            return self.mission.ahead_m + self.wary_m
        if ends_soon:
            return self.corner.spacing_m
        return max(self.mission.ahead_m, self.aim_m)

    def turn_radius_m(self, planned_share: float | None) -> float:
        """Return the radius [m] of turns of a path: at its speed over V, None for the fastest."""
        if planned_share is None:
            v_mps = self.expected.speed_mps
            planned_share = self.path_speeds_mps(None, v_mps)[1] / v_mps
        return self.turns.at_m(planned_share)

    def path_speeds_mps(
        self, planned_share: float | None, helicopter_mps: float
    ) -> tuple[float, float]:
        """Return the slowest and the fastest ground speed of a path beside a helicopter.

        ``planned_share``: its speed over that of the helicopter, by plan: a UAV that turns wide, or
        may, flies it no faster, or it would leave it. None for a path of any speed.
        """
        slowest, fastest = self.air.speeds_mps(helicopter_mps, self.mission.speed_trim, self.faster)
        if planned_share is not None and (self.turns.is_wide or not self.turns.is_sure):
            fastest = min(fastest, planned_share * helicopter_mps)
        return min(slowest, fastest), fastest

    def forecasts_in(self, frame: CornerFrame) -> tuple[Forecast, ...]:
        """Return all forecasts in a frame."""
        return tuple(forecast.in_frame(frame) for forecast in self.forecasts)

    def uav_in(self, frame: CornerFrame, after_s: float = 0.0) -> Pose:
        """Return the UAV's pose in a frame, ``after_s`` [s] from now."""
        uav = self.situation.uav
        assert uav is not None
        return frame.to_frame(uav.pose.offset(uav.speed_mps * (self.now_s + after_s - uav.time_s)))

    def on_course_mps(self, course_rad: float) -> tuple[float, float]:
        """Return the slowest and the fastest ground speed on a course in the wind over minutes."""
        return self.air.over_minutes.on_course_mps(course_rad)

    def flown_mps(self, wanted_mps: float) -> float:
        """Return the ground speed that a UAV is flying at; the wanted where that is not known."""
        uav = self.situation.uav
        return wanted_mps if uav is None or math.isinf(self.air.fastest_mps) else uav.speed_mps

    def speed_share(self, path: TrackedPath) -> float:
        """Return what of its speed the UAV can make good on the rest of a path."""
        return self.flown(path).share

    def apart_m(self, path: FlownPath) -> float:
        """Return the least distance [m] on the rest of a path as the wind lets the UAV fly it."""
        return min(path.apart_m(one, self.now_s) for one in self.forecasts)

    def flown(self, path: TrackedPath) -> FlownPath:
        """Return how the UAV will fly the rest of a path, by the wind and its airspeeds."""
        uav = self.situation.uav
        assert uav is not None
        return flown(
            path.frame.path_to_map(path.path),
            path.speed_mps,
            self.air,
            airspeed_of(uav, self.air),
            from_m=path.flown_m,
            lead_s=self.mission.speed_lead_s,
        )

    def lag_setpoint_m(self, share: float) -> float:
        """Return the lag [m] for legs of a UAV that makes a share of its speed good at corners.

        0 where that is most of it and it turns as it should; where not, a corner that is seen late
        cannot be flown without, or leaves much out.
        """
        if share >= self.mission.low_efficiency and not self.turns.is_wide:
            return 0.0
        return lag_to_begin_with_m(
            self.corner,
            self.corner_speeds(self.corner.speed_mps),
            lead_m=self.corner.speed_mps
            * (self.mission.detection_s + self.mission.reaction_s + LATER_S),
            separation_m=self.corner.separation_m,
            path_efficiency=share,
            turn_rad=abs(self.situation.turn_rad),
        )

    def corner_speeds(self, helicopter_mps: float) -> tuple[CornerSpeed, ...]:
        """Return the speeds a corner is planned with, beside a helicopter of a speed [m/s]."""
        return corner_speeds(self.air, helicopter_mps, self.mission.corner_speed_up, self.turns)

    def on_slot(self) -> bool:
        """Whether the UAV is about on the slot track."""
        return is_on_track(self.uav_in(self.slot_frame))


class Decision(NamedTuple):
    """What comes of an activity: the state it leaves, and what is to be listed, if anything.

    ``goes_on``: the activity had nothing to decide; the next one does.
    """

    state: State
    listing: Listing | None = None
    goes_on: bool = False
