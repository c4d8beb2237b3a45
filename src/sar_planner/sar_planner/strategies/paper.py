"""The paper's planner in flight: one path for a corner, flown as planned once it has begun."""

from __future__ import annotations

import math
from dataclasses import replace

from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.states import CornerEstimate, LegEstimate, Phase
from sar_planner.guidance.waypoint_lists import Listed
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.prediction.situation import Situation
from sar_planner.rules.paper_automaton import PaperAutomaton
from sar_planner.rules.paper_rules import CornerPlan
from sar_planner.strategies.active_corner import ActiveCorner, Mode, measured, unusable
from sar_planner.strategies.strategy import Strategy, StrategyReport

ON_TRACK_M = 60.0
ON_HEADING_RAD = math.radians(25.0)
LATE_FACTOR = 1.5


class PaperStrategy(Strategy):
    """Slot track on legs, one of the paper's four rules at corners; nothing in between."""

    def __init__(
        self, situation: Situation, corner: CornerParameters, mission: MissionParameters
    ) -> None:
        """Begin on a leg."""
        super().__init__(situation, corner, mission)
        self._active: ActiveCorner | None = None
        self._slot: Pose | None = None
        self._problem = ""
        self._planned: CornerEstimate | None = None
        self._done_corner = 0
        self._leg_after_s = -math.inf
        self._problem_corner = 0

    @property
    def report(self) -> StrategyReport:
        """What it tells of itself."""
        return StrategyReport(
            mode=Mode.LEG if self._active is None else Mode.CORNER,
            corner=self._active,
            slot=self._slot,
            problem=self._problem,
        )

    def begin(self) -> None:
        """Begin to lead; a corner that is already over is not planned."""
        self.lists.forget()
        self._problem = ""
        if self._s.phase is not Phase.DECELERATING:
            self._done_corner = self._s.corners_seen

    def end(self) -> None:
        """Stop leading."""
        if self._active is not None:
            self._done_corner = self._active.k
        self._active = None

    def believes(self, leg: LegEstimate) -> bool:
        """Whether a leg is not older than the corner that was flown last."""
        return leg.time_s >= self._leg_after_s

    def set_clock_back(self) -> None:
        """Forget the corner being flown."""
        if self._active is not None:
            self._leave_corner()
        self._planned = None
        self._leg_after_s = -math.inf
        self._done_corner = self._s.corners_seen

    def update(self, now_s: float) -> Listed | None:
        """Return the mode and the waypoints of a new list when one is due."""
        if self._s.slot is not None and self._slot_is_newer():
            self._slot = self._s.slot
        if self._problem_corner != self._s.corners_seen:
            self._problem = ""
        if self._active is not None:
            self._follow_corner(now_s)
        listed = None
        if self._active is None or not self._active.committed:
            listed = self._corner_list(now_s) or self._leg_list()
        return listed

    def _slot_is_newer(self) -> bool:
        leg = self._s.leg
        return leg is not None and leg.time_s >= self._leg_after_s

    def _follow_corner(self, now_s: float) -> None:
        """Commit to the corner's path when it begins to turn, and leave it when it is flown."""
        active, uav = self._active, self._s.uav
        assert active is not None
        assert uav is not None
        if not active.committed:
            if self._s.went_on:
                self._leave_corner()
                return
            margin = self._mission.reaction_s * active.uav_speed_mps
            overtaken = self._s.corners_seen > active.k
            if overtaken or active.plan.turn_start_m - active.flown_m(now_s) < margin:
                self._active = replace(active, committed=True)
            return
        end = active.frame.pose_to_map(active.plan.path.end)
        arrived = (
            end.along(uav.x_m, uav.y_m) > 0.0
            and abs(end.across(uav.x_m, uav.y_m)) < ON_TRACK_M
            and abs(wrap_angle(uav.course_rad - end.heading_rad)) < ON_HEADING_RAD
        )
        late = active.flown_m(now_s) > LATE_FACTOR * active.plan.path.length_m + 200.0
        if arrived or late:
            self._leave_corner()
            if self._slot is None or self._is_old_leg(end):
                self._slot = end

    def _leave_corner(self) -> None:
        assert self._active is not None
        self._done_corner = self._active.k
        if self._active.committed:
            self._leg_after_s = self._active.estimate.stop_time_s
        self._active = None
        self.lists.forget()

    def _is_old_leg(self, end: Pose) -> bool:
        assert self._slot is not None
        return abs(wrap_angle(self._slot.heading_rad - end.heading_rad)) > math.radians(45.0)

    def _corner_list(self, now_s: float) -> Listed | None:
        """Plan the corner ahead, or plan it again as it is refined."""
        estimate, k = self._s.estimate, self._s.corners_seen
        if estimate is None or estimate is self._planned or k == self._done_corner:
            return None
        self._planned = estimate
        self._problem_corner = k
        again = self._active is not None and self._active.k == k
        frame = CornerFrame(estimate.stop, self._mission.turn_side)
        corner = self._corner
        self._problem = unusable(
            estimate, corner.speed_mps, corner.accel_mps2, self._mission
        ) or self._off_slot(frame)
        if self._problem:
            return None
        try:
            plan = self._plan(estimate, frame, now_s)
        except ValueError as error:
            self._problem = f"corner {k}: {error}"
            return None
        assert self._s.uav is not None
        speed = self._s.uav.speed_mps
        first_stop = self._active.first_stop if again and self._active else estimate.stop
        self._active = ActiveCorner(k, estimate, frame, plan, first_stop, speed)
        begin = self._active.flown_m(now_s) + self._mission.reaction_s * speed
        return str(plan.rule), self.lists.along(self._active.path, speed, from_m=begin)

    def _off_slot(self, frame: CornerFrame) -> str:
        """Return why the UAV is not where the rules take it to be: on the old leg's slot track."""
        assert self._s.uav is not None
        pose = frame.to_frame(self._s.uav.pose)
        across = pose.y_m + self._corner.spacing_m
        if abs(across) < ON_TRACK_M and abs(pose.heading_rad) < ON_HEADING_RAD:
            return ""
        return (
            f"corner {self._s.corners_seen}: UAV {abs(across):.0f} m beside its slot track, "
            f"{abs(math.degrees(pose.heading_rad)):.0f} deg off its heading: not planned"
        )

    def _plan(self, estimate: CornerEstimate, frame: CornerFrame, now_s: float) -> CornerPlan:
        """Measure L(k), pick the rule and make its path from what the UAV can still do."""
        uav = self._s.uav
        assert uav is not None
        parameters, lag = measured(estimate, frame, uav, self._corner)
        passed = now_s - estimate.onset_time_s + self._mission.reaction_s
        rules = PaperAutomaton(parameters, enforce=False)
        return rules.plan(lag, lead_m=uav.speed_mps * max(0.0, passed))

    def _leg_list(self) -> Listed | None:
        """Lead the UAV along the slot track."""
        if self._active is not None or self._slot is None or self._s.uav is None:
            return None
        points = self.lists.track(self._slot, self._s.uav)
        return None if points is None else (str(Mode.LEG), points)
