"""The mode-switching planner: leads the UAV along its slot track and around the corners.

Pure: it is told what is known, and asked at any time whether there is a new waypoint list.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, replace

import numpy as np

from sar_estimator.plane import Pose, wrap_angle
from sar_estimator.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.geometry import CornerFrame, FlightPath, FloatArray
from sar_planner.parameters import CornerParameters, ParameterError
from sar_planner.rule_sets import make_rule_set
from sar_planner.rules import CornerPlan
from sar_planner.waypoints import path_waypoints

ON_TRACK_M = 60.0
ON_HEADING_RAD = math.radians(25.0)
LATE_FACTOR = 1.5
MAX_WAYPOINTS = 400
CLOCK_STEP_S = 1.0
ENGAGE_MODES = ("AUTO", "GUIDED")


@dataclass(frozen=True, slots=True)
class MissionParameters:
    """How the planner flies, beside the corner's own parameters (metres and seconds).

    turn_side: 1 for right-turn patterns, -1 for left. rules: rule set. arc_spacing_m: between
    waypoints on arcs, 0 for arc ends only. reaction_s: from a decision to the autopilot flying the
    new list. horizon_m: how far ahead of the UAV the list reaches. slot_tolerance_m: shift of the
    slot track that is worth a new list. capture_m: from the UAV to the first waypoint of a slot
    track. stale_s: age at which a position is no longer planned with. speed_range: speeds of the
    helicopter, relative to V, that the rules are used for; accel_range: decelerations likewise.
    """

    turn_side: int = 1
    rules: str = "paper"
    arc_spacing_m: float = 20.0
    reaction_s: float = 2.0
    horizon_m: float = 4000.0
    slot_tolerance_m: float = 4.0
    capture_m: float = 150.0
    stale_s: float = 5.0
    speed_range: tuple[float, float] = (0.75, 1.25)
    accel_range: tuple[float, float] = (0.6, 2.0)

    def __post_init__(self) -> None:
        """Refuse values out of bounds, naming them."""
        if self.turn_side not in (1, -1):
            raise ParameterError(f"turn_side = {self.turn_side}: expected 1 (right) or -1 (left)")
        if not 0.0 <= self.arc_spacing_m < math.inf:
            raise ParameterError(f"arc_spacing_m = {self.arc_spacing_m}: expected 0 or more")
        if not 0.0 <= self.reaction_s < math.inf:
            raise ParameterError(f"reaction_s = {self.reaction_s}: expected 0 or more")
        for name in ("horizon_m", "slot_tolerance_m", "capture_m", "stale_s"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ParameterError(f"{name} = {getattr(self, name)}: expected more than 0")
        for name in ("speed_range", "accel_range"):
            limits = getattr(self, name)
            if len(limits) != 2 or not 0.0 < limits[0] <= limits[1]:
                raise ParameterError(f"{name} = {limits}: expected two numbers, 0 < low <= high")


class Mode(enum.StrEnum):
    """What the UAV is being led along."""

    IDLE = "idle"
    LEG = "leg"
    CORNER = "corner"


@dataclass(frozen=True, slots=True)
class UavStatus:
    """What the autopilot says of itself: flight mode, arming, and whether it is heard."""

    mode: str = ""
    armed: bool = False
    connected: bool = False


@dataclass(frozen=True)
class WaypointList:
    """A whole list for the autopilot: ``points``, shape (n, 2) [m] in the map."""

    number: int
    time_s: float
    mode: str
    points: FloatArray


@dataclass(frozen=True)
class ActiveCorner:
    """The corner being flown: ``k`` from 1, the estimate it was planned from, and the plan."""

    k: int
    estimate: CornerEstimate
    frame: CornerFrame
    plan: CornerPlan
    first_stop: Pose
    uav_speed_mps: float
    committed: bool = False

    @property
    def path(self) -> FlightPath:
        """The planned path in the map."""
        return self.frame.path_to_map(self.plan.path)

    def flown_m(self, time_s: float) -> float:
        """Distance along the path at ``time_s``, flown since the onset [m]."""
        return self.uav_speed_mps * (time_s - self.estimate.onset_time_s)


class MissionPlanner:
    """Switches between slot track and path rules.

    ``problem``: why the planner cannot do what it should, empty when all is well.
    Raises ``ParameterError`` at construction for parameters outside the rule set's conditions.
    """

    def __init__(self, corner: CornerParameters, mission: MissionParameters) -> None:
        """Check both parameter sets."""
        make_rule_set(mission.rules, corner)
        self.corner_parameters = corner
        self.parameters = mission
        self.mode = Mode.IDLE
        self.active: ActiveCorner | None = None
        self.corners_seen = 0
        self.problem = ""
        self.list: WaypointList | None = None
        self.helicopter: Motion | None = None
        self.uav: Motion | None = None
        self.phase = Phase.LOST
        self.status = UavStatus()
        self._in_auto = False
        self._slot: Pose | None = None
        self._listed_slot: Pose | None = None
        self._estimate: CornerEstimate | None = None
        self._planned: CornerEstimate | None = None
        self._lists = 0
        self._done_corner = 0
        self._went_on = False
        self._corner_problem = ""
        self._leg_after_s = -math.inf

    # What is known -----------------------------------------------------------------------------

    def set_helicopter(self, motion: Motion) -> None:
        """Take the helicopter's newest motion."""
        if motion.is_finite():
            self.helicopter = motion

    def set_uav(self, motion: Motion) -> None:
        """Take the UAV's newest motion."""
        if motion.is_finite():
            self.uav = motion

    def set_status(self, status: UavStatus) -> None:
        """Take the autopilot's status; a mode that somebody else chose ends the engagement."""
        self.status = status
        if self.mode is Mode.IDLE or not status.connected:
            return
        if status.mode not in ENGAGE_MODES or (self._in_auto and status.mode != "AUTO"):
            self.disengage()
            self.problem = f"released: the UAV was taken to mode {status.mode}"
        self._in_auto = status.mode == "AUTO"

    def set_leg(self, leg: LegEstimate) -> None:
        """Take the leg being flown: the slot track lies d to its inside."""
        old_leg = leg.time_s < self._leg_after_s
        if old_leg or not math.isfinite(leg.foot.x_m + leg.foot.y_m + leg.foot.heading_rad):
            return
        inside = -self.parameters.turn_side * self.corner_parameters.spacing_m
        self._slot = leg.foot.offset(0.0, inside)

    def set_phase(self, phase: Phase) -> None:
        """Take the helicopter's phase."""
        if self.phase is Phase.DECELERATING and phase in (Phase.CRUISE, Phase.ACCELERATING):
            self._went_on = True
        self.phase = phase

    def set_corner(self, estimate: CornerEstimate) -> None:
        """Take a prediction, or a refinement, of the corner ahead."""
        if self._is_new(estimate):
            self.corners_seen += 1
            self._went_on = False
            self._corner_problem = ""
        self._estimate = estimate

    def _is_new(self, estimate: CornerEstimate) -> bool:
        known = self._estimate
        if known is None or estimate.time_s < known.time_s - CLOCK_STEP_S:
            return True
        return estimate.onset_time_s > max(known.stop_time_s, known.time_s)

    # Operator ----------------------------------------------------------------------------------

    def obstacle(self, now_s: float) -> str:
        """Return why the planner cannot lead the UAV at ``now_s``, empty when it can."""
        for name, motion in (("UAV", self.uav), ("helicopter", self.helicopter)):
            if motion is None:
                return f"no {name} position"
            age = now_s - motion.time_s
            if age > self.parameters.stale_s:
                return f"{name} position {age:.1f} s old (limit {self.parameters.stale_s} s)"
        if self.phase is Phase.LOST:
            return "helicopter GPS lost"
        if self._slot is None:
            return "helicopter's leg not known yet"
        return ""

    def engage(self, now_s: float) -> str:
        """Begin to lead the UAV; return why not, empty when begun."""
        reason = self._not_flying() or self.obstacle(now_s)
        if not reason and self.mode is Mode.IDLE:
            self.mode = Mode.LEG
            self._listed_slot = None
            self._corner_problem = ""
            if self.phase is not Phase.DECELERATING:
                self._done_corner = self.corners_seen
            self._in_auto = self.status.mode == "AUTO"
        return reason

    def _not_flying(self) -> str:
        status = self.status
        if not status.connected:
            return "no heartbeat from the autopilot"
        if not status.armed:
            return "UAV not armed: expected it in the air"
        if status.mode not in ENGAGE_MODES:
            return f"UAV in mode {status.mode}: expected {' or '.join(ENGAGE_MODES)}"
        return ""

    def disengage(self) -> None:
        """Stop leading the UAV."""
        if self.active is not None:
            self._done_corner = self.active.k
        self.mode = Mode.IDLE
        self.active = None
        self.list = None

    # Measured ----------------------------------------------------------------------------------

    def lag_m(self) -> float | None:
        """Return the UAV's lag [m]: L(k) in a corner, on a leg the present along-track lag."""
        if self.active is not None:
            return self.active.plan.lag_m
        if self.uav is None or self.helicopter is None or self._slot is None:
            return None
        ahead = self._slot.along(self.helicopter.x_m, self.helicopter.y_m)
        behind = self._slot.along(self.uav.x_m, self.uav.y_m)
        return ahead - behind - self.uav.speed_mps * (self.helicopter.time_s - self.uav.time_s)

    def separation_m(self) -> float | None:
        """Return the horizontal distance between the aircraft [m]."""
        if self.uav is None or self.helicopter is None:
            return None
        return math.hypot(self.uav.x_m - self.helicopter.x_m, self.uav.y_m - self.helicopter.y_m)

    @property
    def rule(self) -> str:
        """The active rule's name, or the mode's."""
        if self.mode is Mode.CORNER and self.active is not None:
            return str(self.active.plan.rule)
        return str(self.mode)

    # Decisions ---------------------------------------------------------------------------------

    def update(self, now_s: float) -> WaypointList | None:
        """Return a new waypoint list when one is due."""
        if self.mode is Mode.IDLE:
            return None
        self.problem = self.obstacle(now_s)
        if self.problem:
            return None
        if self.mode is Mode.CORNER:
            self._follow_corner(now_s)
        listed = None
        if self.active is None or not self.active.committed:
            listed = self._corner_list(now_s) or self._leg_list(now_s)
        self.problem = self._corner_problem
        return listed

    def set_clock_back(self) -> None:
        """Forget what belongs to a time that has not come yet: the clock was set back."""
        if self.active is not None:
            self._leave_corner()
        self._estimate = self._planned = self.helicopter = self.uav = None
        self._leg_after_s = -math.inf
        self._done_corner = self.corners_seen

    def _follow_corner(self, now_s: float) -> None:
        """Commit to the corner's path when it begins to turn, and leave it when it is flown."""
        assert self.active is not None
        assert self.uav is not None
        active = self.active
        if not active.committed:
            if self._went_on:
                self._leave_corner()
                return
            margin = self.parameters.reaction_s * active.uav_speed_mps
            overtaken = self.corners_seen > active.k
            if overtaken or active.plan.turn_start_m - active.flown_m(now_s) < margin:
                self.active = replace(active, committed=True)
            return
        end = active.frame.pose_to_map(active.plan.path.end)
        arrived = (
            end.along(self.uav.x_m, self.uav.y_m) > 0.0
            and abs(end.across(self.uav.x_m, self.uav.y_m)) < ON_TRACK_M
            and abs(wrap_angle(self.uav.course_rad - end.heading_rad)) < ON_HEADING_RAD
        )
        late = active.flown_m(now_s) > LATE_FACTOR * active.plan.path.length_m + 200.0
        if arrived or late:
            self._leave_corner()
            if self._slot is None or self._slot_is_old_leg(end):
                self._slot = end

    def _leave_corner(self) -> None:
        assert self.active is not None
        self._done_corner = self.active.k
        if self.active.committed:
            self._leg_after_s = self.active.estimate.stop_time_s
        self.mode = Mode.LEG
        self.active = None
        self._listed_slot = None

    def _slot_is_old_leg(self, end: Pose) -> bool:
        assert self._slot is not None
        return abs(wrap_angle(self._slot.heading_rad - end.heading_rad)) > math.radians(45.0)

    def _usable(self, estimate: CornerEstimate) -> str:
        p, m = self.corner_parameters, self.parameters
        for name, value, nominal, limits in (
            ("speed", estimate.speed_mps, p.speed_mps, m.speed_range),
            ("deceleration", estimate.accel_mps2, p.accel_mps2, m.accel_range),
        ):
            if not limits[0] * nominal <= value <= limits[1] * nominal:
                return (
                    f"helicopter's {name} {value:.2f}: the rules expect "
                    f"{limits[0] * nominal:.2f} ... {limits[1] * nominal:.2f}"
                )
        return ""

    def _corner_list(self, now_s: float) -> WaypointList | None:
        """Plan the corner ahead, or plan it again as it is refined."""
        estimate = self._estimate
        if estimate is None or estimate is self._planned or self.corners_seen == self._done_corner:
            return None
        self._planned = estimate
        again = self.active is not None and self.active.k == self.corners_seen
        frame = CornerFrame(estimate.stop, self.parameters.turn_side)
        self._corner_problem = self._usable(estimate) or self._off_slot(frame)
        if self._corner_problem:
            return None
        try:
            plan = self._plan(estimate, frame, now_s)
        except ValueError as error:
            self._corner_problem = f"corner {self.corners_seen}: {error}"
            return None
        first_stop = self.active.first_stop if again and self.active else estimate.stop
        self.active = ActiveCorner(
            self.corners_seen, estimate, frame, plan, first_stop, self._uav_speed()
        )
        self.mode = Mode.CORNER
        path = self.active.path
        begin = self.active.flown_m(now_s) + self.parameters.reaction_s * self._uav_speed()
        points = path_waypoints(path, self.parameters.arc_spacing_m, from_m=begin)
        beyond = path.end.offset(self.parameters.horizon_m)
        points = np.vstack((points, (beyond.x_m, beyond.y_m)))
        return self._publish(now_s, str(plan.rule), points[:MAX_WAYPOINTS])

    def _off_slot(self, frame: CornerFrame) -> str:
        """Return why the UAV is not where the rules take it to be: on the old leg's slot track."""
        assert self.uav is not None
        pose = frame.to_frame(self.uav.pose)
        across = pose.y_m + self.corner_parameters.spacing_m
        if abs(across) < ON_TRACK_M and abs(pose.heading_rad) < ON_HEADING_RAD:
            return ""
        return (
            f"corner {self.corners_seen}: UAV {abs(across):.0f} m beside its slot track, "
            f"{abs(math.degrees(pose.heading_rad)):.0f} deg off its heading: not planned"
        )

    def _plan(self, estimate: CornerEstimate, frame: CornerFrame, now_s: float) -> CornerPlan:
        """Measure L(k), pick the rule and make its path from what the UAV can still do."""
        assert self.uav is not None
        parameters = replace(
            self.corner_parameters,
            speed_mps=estimate.speed_mps,
            accel_mps2=estimate.accel_mps2,
        )
        speed = self._uav_speed()
        at_onset = frame.to_frame(self.uav.pose).x_m - speed * (
            self.uav.time_s - estimate.onset_time_s
        )
        lag = -parameters.stopping_m - at_onset
        passed = now_s - estimate.onset_time_s + self.parameters.reaction_s
        rules = make_rule_set(self.parameters.rules, parameters, enforce=False)
        return rules.plan(lag, lead_m=speed * max(0.0, passed))

    def _uav_speed(self) -> float:
        assert self.uav is not None
        return self.uav.speed_mps

    def _leg_list(self, now_s: float) -> WaypointList | None:
        """Lead the UAV along the slot track, when the listed one is gone, shifted or ending."""
        if self.mode is not Mode.LEG or self._slot is None or self.uav is None:
            return None
        slot = self._slot
        here = slot.offset(slot.along(self.uav.x_m, self.uav.y_m))
        if self._listed_slot is not None:
            listed, far = self._listed_slot, here.offset(1000.0)
            shift = max(
                abs(listed.across(here.x_m, here.y_m)),
                0.5 * abs(listed.across(far.x_m, far.y_m)),
            )
            left = self.parameters.horizon_m - listed.along(self.uav.x_m, self.uav.y_m)
            if shift < self.parameters.slot_tolerance_m and left > 0.4 * self.parameters.horizon_m:
                return None
        self._listed_slot = here
        ahead = [here.offset(x) for x in (self.parameters.capture_m, self.parameters.horizon_m)]
        return self._publish(now_s, str(Mode.LEG), np.array([(p.x_m, p.y_m) for p in ahead]))

    def _publish(self, now_s: float, mode: str, points: FloatArray) -> WaypointList:
        self._lists += 1
        self.list = WaypointList(self._lists, now_s, mode, points)
        return self.list
