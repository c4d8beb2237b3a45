"""The closed loop in flight: deadbeat rules, corrections inside the corner, rejoining, speed trim.

Whatever the UAV does is an approach: a path onto the slot that the helicopter's motion to come
defines. At a corner the deadbeat rules choose it; from anywhere else ``rejoin`` does. While it is
flown, it is looked at with every decision: where will it end, and will it stay apart? When that is
no longer as wanted, what is left of it is solved again from where the UAV really is.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate, Phase
from sar_planner.guidance.speed_control import MadeGood, trimmed_mps
from sar_planner.guidance.waypoint_lists import Listed
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import CornerFrame, FlightPath, FloatArray
from sar_planner.prediction.forecast import Forecast
from sar_planner.prediction.separation import beside_apart_m, least_apart_m
from sar_planner.prediction.situation import Situation
from sar_planner.rejoin.recapture import (
    Approach,
    Recapture,
    final_lag_m,
    is_on_track,
    row_of,
    total_turn_rad,
)
from sar_planner.rejoin.rejoin import RejoinPlan, RejoinTask, rejoin
from sar_planner.rules.corner_coverage import StripsAt
from sar_planner.rules.corner_speed import catching_up_mps, hurried_plan, hurries_of
from sar_planner.rules.deadbeat_rules import DeadbeatRules
from sar_planner.rules.paper_rules import CornerPlan, Rule
from sar_planner.strategies.active_corner import ActiveCorner, Mode, measured, unusable
from sar_planner.strategies.strategy import Pilot

OFF_PATH_M = 20.0
BESIDE_M = 3.0
SETTLED_RAD = math.radians(20.0)
MARGIN_SHARE = 0.4
CORRECTED_SHARE = 0.6
WIDER_M = 5.0
LONGER_SPACINGS = 1.0
LATE_FACTOR = 2.5
POOR_SHARE = 0.85
DETECTION_S = 4.0
RETRY_S = 2.0
WATCH_S = 0.39  # two decisions at 5 Hz, whatever their times round to


class DeadbeatPilot(Pilot):
    """Slot track with speed trim on legs, approaches everywhere else."""

    def __init__(
        self, situation: Situation, corner: CornerParameters, mission: MissionParameters
    ) -> None:
        """Begin on a leg."""
        super().__init__(situation, corner, mission)
        self.good = MadeGood(mission.bias_gain)
        self.approach: Approach | None = None
        self._unsafe = ""
        self._corner_note = ""
        self._hurry = 1.0
        self._holding = False
        self._planned: CornerEstimate | None = None
        self._done_corner = 0
        self._went_on = False
        self._retry_s = -math.inf
        self._followed_s = -math.inf
        self._corrected_s = -math.inf
        self._led_s = -math.inf

    # Engagement --------------------------------------------------------------------------------

    @property
    def mode(self) -> Mode:
        """What the UAV is being led along."""
        if self.active is not None:
            return Mode.CORNER
        if self._holding:
            return Mode.HOLD
        return Mode.LEG if self.approach is None else Mode.REJOIN

    @property
    def made_good(self) -> float:
        """The share of its speed that the UAV is expected to make good at corners."""
        return self.good.share

    @property
    def course_rad(self) -> float:
        """The course on which the UAV will be when a speed asked for now is flown."""
        if self.approach is None:
            return 0.0 if self.slot is None else self.slot.heading_rad
        path = self.approach.path
        ahead_m = self.approach.flown_m + self._mission.speed_lead_s * self.approach.speed_mps
        there = path.pose_at(min(max(ahead_m, 0.0), path.length_m))
        return self.approach.frame.pose_to_map(there).heading_rad

    def begin(self) -> None:
        """Begin to lead; a corner that is already over is not planned."""
        self._led_s = -math.inf
        self.lists.forget()
        self.problem = ""
        self._holding = False
        if self._s.phase is not Phase.DECELERATING:
            self._done_corner = self._s.corners_seen

    def end(self) -> None:
        """Stop leading."""
        if self.active is not None:
            self._done_corner = self.active.k
        self.active = self.approach = self.speed_mps = None
        self._holding = False

    def believes(self, leg: LegEstimate) -> bool:
        """Whether a leg is not older than the last stop."""
        estimate = self._s.estimate
        return estimate is None or self._s.went_on or leg.time_s >= estimate.stop_time_s

    def set_clock_back(self) -> None:
        """Forget the path being flown."""
        self.active = self.approach = None
        self._planned = None
        self._retry_s = self._corrected_s = -math.inf
        self._done_corner = self._s.corners_seen
        self.lists.forget()

    # Decisions ---------------------------------------------------------------------------------

    def update(self, now_s: float) -> Listed | None:
        """Return the mode and the waypoints of a new list when one is due."""
        if self._s.phase is Phase.CRUISE and self._led_s <= now_s < self._led_s + WATCH_S:
            return None  # it keeps its place on a leg, looked at a moment ago: what was said stands
        self.problem = ""
        if self._learn_radius(on_path=self.approach is not None):
            self.good.cancel()  # what wide turns cost in this corner is no bias of the next
        listed = self._decide(now_s)
        notes = (self.problem, self._unsafe, self._corner_note)
        self.problem = "; ".join(note for note in notes if note)
        return listed

    def _decide(self, now_s: float) -> Listed | None:
        self._led_s = -math.inf
        forecasts = self._s.forecasts(now_s)
        given_up, self._went_on = self._s.went_on and not self._went_on, self._s.went_on
        if self.approach is not None and self._s.went_on and forecasts:
            # The corner was none: a UAV that is still on its leg, or has not turned, stays there.
            begun = self.active is None or self.active.committed
            if not begun or (given_up and self._on_slot(now_s, forecasts[0])):
                self._leave()
        if not forecasts:
            self.problem = "helicopter's leg not known: the UAV stays on its list"
            return None
        self.slot = self._s.slot_of(forecasts[0].leg)
        listed = self._corner_list(now_s, forecasts)
        if listed is not None:
            return listed
        if self.active is not None and not self.active.committed:
            self._commit_when_due(now_s)
            return None
        slow, fast = (limit * self._corner.speed_mps for limit in self._mission.speed_range)
        if not slow <= forecasts[0].speed_mps <= fast:
            return self._hold(
                f"helicopter's speed {forecasts[0].speed_mps:.1f} m/s: "
                f"expected {slow:.1f} to {fast:.1f}"
            )
        self._holding = False
        if self.approach is not None:
            return self._follow(now_s, forecasts)
        return self._leg_list(now_s, forecasts)

    def _uav_in(self, frame: CornerFrame, now_s: float) -> Pose:
        """Return the UAV's pose now, in a frame."""
        uav = self._s.uav
        assert uav is not None
        return frame.to_frame(uav.pose.offset(uav.speed_mps * (now_s - uav.time_s)))

    def _ahead(self, frame: CornerFrame, now_s: float) -> Pose:
        """Return where the UAV will be, in a frame, when a list made now is flown."""
        approach = self.approach
        if approach is None:
            return self._uav_in(frame, now_s + self._mission.reaction_s)
        run_m = approach.speed_mps * self._share * self._mission.reaction_s
        here = self._uav_in(approach.frame, now_s)
        ahead = approach.carried_on(here, approach.flown_m + run_m)
        return frame.to_frame(approach.frame.pose_to_map(ahead))

    @property
    def _share(self) -> float:
        """What is made good of the UAV's speed on the path being flown; rejoining, all of it."""
        by_rule = self.active is not None and self.active.plan.rule is not Rule.RJ
        return self.good.now if by_rule else 1.0

    def _hold(self, reason: str) -> Listed | None:
        """Keep out of the way: the list ends ahead, where the bridge lets the UAV circle."""
        self.problem = f"holding: {reason}"
        if self._holding or self._s.uav is None:
            return None
        if self.active is not None:
            self._done_corner = self.active.k
        self.active = self.approach = None
        self._unsafe = ""
        self._holding = True
        self.lists.forget()
        ahead = self.lists.loiter(self._s.uav.pose, self._mission.capture_m)
        return str(Mode.HOLD), np.array([ahead])

    # Corners -----------------------------------------------------------------------------------

    def _corner_list(self, now_s: float, forecasts: tuple[Forecast, ...]) -> Listed | None:
        """Plan the corner ahead, or plan it again as it is refined, until the UAV turns."""
        estimate, k = self._s.estimate, self._s.corners_seen
        if estimate is None or k == self._done_corner or self._s.went_on:
            return None
        before = self.active if self.active is not None and self.active.k == k else None
        if estimate is self._planned or (before is not None and before.committed):
            return None
        tolerance_m = self._mission.corner_tolerance_m
        if before is not None and before.estimate.changed_m(estimate) <= tolerance_m:
            return None
        self._planned = estimate
        corner = self._corner
        reason = unusable(estimate, corner.speed_mps, corner.accel_mps2, self._mission)
        self._corner_note = f"corner {k}: {reason}" if reason else ""
        if reason:
            self._done_corner = k
            return None
        frame = CornerFrame(estimate.stop, self._mission.turn_side)
        planned = self._rule_plan(estimate, frame, now_s)
        if planned is None:
            return self._corner_from_anywhere(estimate, frame, now_s, forecasts)
        plan, self._hurry = planned
        uav = self._s.uav
        assert uav is not None
        first_stop = estimate.stop if before is None else before.first_stop
        self.active = ActiveCorner(k, estimate, frame, plan, first_stop, uav.speed_mps)
        self._holding = False
        slot = self._s.slot_frame(forecasts[0].leg)
        path = self.active.path
        flown = self.active.flown_m(now_s)
        self._begin(
            Approach(
                slot,
                slot.path_from_map(path),
                estimate.onset_time_s,
                self._faster(path.length_m - flown, plan.next_lag_m, estimate.speed_mps),
                flown,
            ),
            now_s,
        )
        self._commit_when_due(now_s)
        return str(plan.rule), self._list_of(path, from_m=flown)

    def _rule_plan(
        self, estimate: CornerEstimate, frame: CornerFrame, now_s: float
    ) -> tuple[CornerPlan, float] | None:
        """Return the plan and how much faster than V it is flown; None off the slot track."""
        uav = self._s.uav
        assert uav is not None
        pose = frame.to_frame(uav.pose)
        across = pose.y_m + self._corner.spacing_m
        if not is_on_track(Pose(pose.x_m, across, pose.heading_rad)):
            return None
        parameters, lag = measured(estimate, frame, uav, self._corner)
        passed = now_s - estimate.onset_time_s + self._mission.reaction_s
        lead = uav.speed_mps * max(0.0, passed)
        return hurried_plan(
            parameters,
            lag,
            lead_m=lead,
            separations_m=self._separations_m(),
            hurries=hurries_of(self.lists.air, estimate.speed_mps, self._mission.corner_hurry),
            made_good=self.good.share,
        )

    def _separations_m(self) -> tuple[float, float, float]:
        """Return the separations to plan with, the most wanted one first."""
        least, margin = self._corner.separation_m, self._s.margin_m(self._mission)
        return least + margin, least + MARGIN_SHARE * margin, least

    def _corner_from_anywhere(
        self,
        estimate: CornerEstimate,
        frame: CornerFrame,
        now_s: float,
        forecasts: tuple[Forecast, ...],
    ) -> Listed | None:
        """Go straight for the slot of the new leg, from wherever the UAV is."""
        listed = self._rejoin(now_s, forecasts)
        if listed is None or self.approach is None:
            return None
        k = self._s.corners_seen
        uav = self._s.uav
        assert uav is not None
        parameters, lag = measured(estimate, frame, uav, self._corner)
        path = self.approach.path
        in_map = self.approach.frame.path_to_map(path)
        plan = CornerPlan(
            Rule.RJ,
            lag,
            final_lag_m(
                path,
                forecasts[0].in_frame(self.approach.frame),
                start_s=self.approach.begun_s,
                speed_mps=self.approach.speed_mps,
            ),
            frame.path_from_map(in_map),
            parameters,
        )
        first_stop = estimate.stop
        if self.active is not None and self.active.k == k:
            first_stop = self.active.first_stop
        self.active = ActiveCorner(
            k, estimate, frame, plan, first_stop, uav.speed_mps, committed=True
        )
        return str(Rule.RJ), listed[1]

    def _commit_when_due(self, now_s: float) -> None:
        """Commit to the corner's path when the UAV is about to turn, or the corner is over."""
        active = self.active
        assert active is not None
        margin = self._mission.reaction_s * active.uav_speed_mps
        overtaken = self._s.corners_seen > active.k or self._s.phase is not Phase.DECELERATING
        if overtaken or active.plan.turn_start_m - active.flown_m(now_s) < margin + 1e-6:
            self.active = replace(active, committed=True)
            self.good.begin(self._corner.speed_mps)

    def _begin(self, approach: Approach, now_s: float) -> None:
        """Follow another path from now on."""
        self.turns.news = False
        self.approach = approach
        self.speed_mps = approach.speed_mps
        self._followed_s = now_s
        self._unsafe = ""

    def _faster(self, path_m: float, lag_m: float, speed_mps: float) -> float:
        """Return the speed for a path that leaves a lag, at a helicopter's speed."""
        worth_m = lag_m if lag_m >= self._mission.lag_tolerance_m else 0.0
        hurry, share, most = self._hurry, self._share, self._speeds_mps(speed_mps)[1]
        return catching_up_mps(path_m, worth_m, speed_mps, hurry=hurry, share=share, most_mps=most)

    def _speeds_mps(self, speed_mps: float) -> tuple[float, float]:
        """Return the slowest and the fastest speed of a path, at a helicopter's speed."""
        return self.lists.air.speeds_mps(speed_mps, self._mission.speed_trim)

    def _list_of(self, path: FlightPath, *, from_m: float = 0.0) -> FloatArray:
        """Return the waypoints of the path that was just begun, in the map."""
        assert self.approach is not None
        return self.lists.along(path, self.approach.speed_mps, from_m=from_m)

    def _leave(self) -> None:
        """Leave a path that is flown, or no longer wanted."""
        if self.active is not None:
            self._done_corner = self.active.k
            if self.active.committed:
                self.good.learn()
                self._hold_back()
        self.active = self.approach = None
        self._hurry = 1.0
        self._unsafe = ""
        self.lists.forget()

    def _hold_back(self) -> None:
        """Keep a lag on legs where the UAV makes so little good that it will need one."""
        self.kept_lag_m = 0.0
        if self.good.share < POOR_SHARE:
            lead_m = self._corner.speed_mps * (DETECTION_S + self._mission.reaction_s)
            rules = DeadbeatRules(self._corner, made_good=self.good.share)
            separation = self._corner.separation_m
            self.kept_lag_m = rules.least_lag_m(lead_m=lead_m, separation_m=separation)

    # Approaches --------------------------------------------------------------------------------

    def _follow(self, now_s: float, forecasts: tuple[Forecast, ...]) -> Listed | None:
        """Watch the path being flown; solve again what is left of it when it no longer fits."""
        assert self.approach is not None
        if self._followed_s <= now_s < self._followed_s + WATCH_S:
            return None
        here = self._uav_in(self.approach.frame, now_s)
        moved_m = self.approach.speed_mps * (now_s - self._followed_s)
        approach = self.approach = self.approach.followed(here, moved_m)
        self._followed_s = now_s
        flown = approach.flown_m
        self.good.watch(now_s, flown, approach.speed_mps)
        overdue = (
            now_s - approach.begun_s > LATE_FACTOR * approach.path.length_m / approach.speed_mps
        )
        done = flown >= approach.path.length_m - 1.0
        rest = approach.path.cut(min(flown, approach.path.length_m))
        settled = done or total_turn_rad(rest) < SETTLED_RAD
        frame = self._s.slot_frame(forecasts[0].leg)
        lost = done and not is_on_track(approach.end_in(frame))
        if (settled and self._on_slot(now_s, forecasts[0])) or overdue or lost:
            self._leave()
            return self._leg_list(now_s, forecasts)
        if done or now_s < self._retry_s:
            return None
        moved = self.turns.news or approach.misses(
            frame, rest.length_m, self._mission.far_tolerance
        )
        there = approach.path.pose_at(flown)
        off_m = math.hypot(here.x_m - there.x_m, here.y_m - there.y_m)
        expected = tuple(forecast.in_frame(approach.frame) for forecast in forecasts)
        speeds = self._speeds_mps(forecasts[0].speed_mps)
        approach = self.approach = approach.timed(rest, expected[0], now_s, speeds, self._share)
        self.speed_mps = approach.speed_mps
        speed = approach.speed_mps * self._share
        lag = final_lag_m(rest, expected[0], start_s=now_s, speed_mps=speed)
        tolerance = max(self._mission.lag_tolerance_m, self._mission.far_tolerance * rest.length_m)
        settling = now_s - self._corrected_s < self._mission.settling_s
        fits = abs(lag) < tolerance and not moved and (settling or off_m < OFF_PATH_M)
        margin = 0.0 if settling else MARGIN_SHARE * self._s.margin_m(self._mission)
        apart_m = least_apart_m(rest, expected, start_s=now_s, speed_mps=speed)
        if off_m > BESIDE_M:
            beside = here.x_m - there.x_m, here.y_m - there.y_m
            now = beside_apart_m(rest, beside, expected, start_s=now_s, speed_mps=speed)
            apart_m = min(apart_m, now)
        if fits and apart_m >= self._corner.separation_m + margin:
            return None
        safe = apart_m >= self._corner.separation_m and not moved
        return self._correct(now_s, forecasts, frame, off_m, abs(lag) if safe else math.inf)

    def _strips(self, frame: CornerFrame) -> StripsAt | None:
        """Return the UAV's strips about the corner that is flown; None where none is."""
        if self.active is None or self.active.plan.rule is Rule.RJ or self._s.estimate is None:
            return None
        return StripsAt(self._corner.spacing_m, frame.to_frame(self._s.estimate.stop).x_m)

    def _correct(
        self,
        now_s: float,
        forecasts: tuple[Forecast, ...],
        frame: CornerFrame,
        off_m: float,
        held_lag_m: float,
    ) -> Listed | None:
        """Solve what is left from where the UAV will be; ``held_lag_m``: of a path that is safe."""
        approach = self.approach
        assert approach is not None
        old, flown_m = approach.path, approach.flown_m
        run_m = approach.speed_mps * self._share * self._mission.reaction_s
        from_m = min(flown_m + run_m, old.length_m)
        kept = old.cut(min(flown_m, old.length_m), from_m)
        begin = old.pose_at(from_m)
        if off_m >= OFF_PATH_M:
            begin = approach.carried_on(self._uav_in(approach.frame, now_s), from_m)
            kept = FlightPath(begin, ())
        in_map = approach.frame.pose_to_map(begin)
        start = frame.to_frame(in_map)
        speed = forecasts[0].speed_mps
        search = Recapture(
            start,
            now_s + self._mission.reaction_s,
            tuple(forecast.in_frame(frame) for forecast in forecasts),
            self._corner.turn_radius_m,
            self._hurry * speed * self._share,
            self._corner.separation_m,
            old.length_m - from_m + LONGER_SPACINGS * self._corner.spacing_m,
            self._strips(frame),
        )
        row = row_of(old.cut(from_m))
        margin = self._s.margin_m(self._mission)
        least = self._corner.separation_m + MARGIN_SHARE * margin
        wanted = self._corner.separation_m + CORRECTED_SHARE * margin
        path = search.best(row, wanted, least)
        if path is None:
            return self._widest(search, now_s, forecasts, frame)
        self._retry_s = now_s + self._mission.correction_s
        target = forecasts[0].in_frame(frame)
        lag = final_lag_m(path, target, start_s=search.start_s, speed_mps=search.speed_mps)
        if off_m < OFF_PATH_M and abs(lag) > held_lag_m + self._corner.spacing_m:
            return None
        self.corrections += 1
        self._corrected_s = now_s
        whole = frame.path_from_map(approach.frame.path_to_map(kept)).then(path)
        self._begin(
            Approach(
                frame,
                whole,
                now_s if kept.segments else now_s + self._mission.reaction_s,
                self._faster(path.length_m, lag, speed),
            ),
            now_s,
        )
        self.good.moved()
        name = str(self.active.plan.rule) if self.active is not None else str(Mode.REJOIN)
        return name, self._list_of(frame.path_to_map(whole))

    def _widest(
        self,
        search: Recapture,
        now_s: float,
        forecasts: tuple[Forecast, ...],
        frame: CornerFrame,
    ) -> Listed | None:
        """No path that meets the slot in time keeps the separation: get back, or stay away."""
        approach = self.approach
        assert approach is not None
        self._retry_s = now_s + RETRY_S
        expected = tuple(forecast.in_frame(approach.frame) for forecast in forecasts)
        rest = approach.path.cut(min(approach.flown_m, approach.path.length_m))
        speed = approach.speed_mps * self._share
        kept_m = least_apart_m(rest, expected, start_s=now_s, speed_mps=speed)
        safe = kept_m >= self._corner.separation_m
        if safe and is_on_track(approach.end_in(frame)):
            return None
        plan = self._rejoin_plan(now_s, forecasts)
        if plan is not None and plan.kept:
            return self._take_rejoin(plan, now_s, frame)
        if safe:
            return None
        widest = search.widest()
        nearest = kept_m
        listed = None
        if widest is not None and widest[1] > kept_m + WIDER_M:
            nearest = widest[1]
            self._begin(Approach(frame, widest[0], search.start_s, forecasts[0].speed_mps), now_s)
            listed = str(Mode.REJOIN), self._list_of(frame.path_to_map(widest[0]))
        self._unsafe = f"no safe path: comes within {nearest:.0f} m of the helicopter"
        return listed

    def _rejoin(self, now_s: float, forecasts: tuple[Forecast, ...]) -> Listed | None:
        """Lead the UAV from anywhere onto the slot, at a speed of its own."""
        self._retry_s = now_s + RETRY_S
        plan = self._rejoin_plan(now_s, forecasts)
        if plan is None:
            self.problem = "no path back to the slot"
            return None
        listed = self._take_rejoin(plan, now_s, self._s.slot_frame(forecasts[0].leg))
        if plan.closest_m < self._corner.separation_m:
            self._unsafe = f"rejoining comes within {plan.closest_m:.0f} m of the helicopter"
        return listed

    def _rejoin_plan(self, now_s: float, forecasts: tuple[Forecast, ...]) -> RejoinPlan | None:
        frame = self._s.slot_frame(forecasts[0].leg)
        start_s = now_s + self._mission.reaction_s
        slowest, fastest = self._speeds_mps(forecasts[0].speed_mps)
        wide, _, least = self._separations_m()
        task = RejoinTask(
            self._ahead(frame, now_s),
            start_s,
            tuple(forecast.in_frame(frame) for forecast in forecasts),
            self._corner.turn_radius_m,
            slowest,
            fastest,
            wide,
        )
        plan = rejoin(task)
        if plan is None or plan.kept:
            return plan
        narrow = rejoin(replace(task, separation_m=least))
        return plan if narrow is None or narrow.closest_m < plan.closest_m else narrow

    def _take_rejoin(self, plan: RejoinPlan, now_s: float, frame: CornerFrame) -> Listed:
        start_s = now_s + self._mission.reaction_s
        self._begin(Approach(frame, plan.path, start_s, plan.speed_mps), now_s)
        self.lists.forget()
        self.good.cancel()
        return str(Mode.REJOIN), self._list_of(frame.path_to_map(plan.path))

    # Legs --------------------------------------------------------------------------------------

    def _on_slot(self, now_s: float, forecast: Forecast) -> bool:
        return is_on_track(self._uav_in(self._s.slot_frame(forecast.leg), now_s))

    def _leg_list(self, now_s: float, forecasts: tuple[Forecast, ...]) -> Listed | None:
        """Lead the UAV along its slot track and trim its speed, or back to it."""
        forecast = forecasts[0]
        frame = self._s.slot_frame(forecast.leg)
        pose = self._uav_in(frame, now_s)
        lag = forecast.in_frame(frame).slot_x_m(now_s) - pose.x_m
        on_slot = self._on_slot(now_s, forecast)
        if (not on_slot or lag < -self._mission.ahead_m) and now_s >= self._retry_s:
            return self._rejoin(now_s, forecasts)
        if not on_slot:
            return None
        self.speed_mps = trimmed_mps(
            lag - self.kept_lag_m,
            forecast.speed_mps,
            off_mps=self._mission.trim_follow * forecast.faster_mps(self._s.helicopter),
            gain=self._mission.trim_gain,
            trim=self._mission.speed_trim,
        )
        assert self._s.uav is not None
        assert self.slot is not None
        self._led_s = now_s
        points = self.lists.track(self.slot, self._s.uav)
        return None if points is None else (str(Mode.LEG), points)
