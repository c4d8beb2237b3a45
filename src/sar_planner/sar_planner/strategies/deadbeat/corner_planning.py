"""The path for the corner ahead, planned again as the corner is refined, until the UAV turns."""

from __future__ import annotations

import functools
from dataclasses import replace

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate
from sar_planner.guidance.waypoint_lists import PathListing
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.rejoin.tracked_path import TrackedPath, final_lag_m, is_on_track
from sar_planner.rules.corner_speed import catching_up_mps, sped_up_plan
from sar_planner.rules.deadbeat_rules import CONVERGED_M
from sar_planner.rules.outside_rules import OutsideRules
from sar_planner.rules.paper_rules import OUTSIDE, CornerPlan, Rule
from sar_planner.strategies.active_corner import ActiveCorner, measured, unusable
from sar_planner.strategies.deadbeat.outside_planning import outside_plan
from sar_planner.strategies.deadbeat.rejoining import start_rejoining
from sar_planner.strategies.deadbeat.state import Decision, State, Tick

WIDER_M = (0.0, 20.0, 40.0)  # planned with, where the wind brings a path nearer than it should
SHARE_LOOKS, SHARE_CHANGE = 3, 0.02  # at what the wind makes of a plan's speed
UNSURE_SHARE = 0.65  # of its speed that a UAV may make good that was not seen in a turn yet


def plan_corner(state: State, tick: Tick) -> Decision:
    """Plan the corner ahead where that is due."""
    situation, mission, corner = tick.situation, tick.mission, tick.corner
    estimate, k = situation.estimate, situation.corners_seen
    if estimate is None or k == state.done_corner or situation.went_on:
        return Decision(state, goes_on=True)
    before = state.corner if state.corner is not None and state.corner.k == k else None
    if estimate is state.planned or (before is not None and before.committed):
        return Decision(state, goes_on=True)
    if before is not None and before.estimate.changed_m(estimate) <= mission.corner_tolerance_m:
        return Decision(state, goes_on=True)
    reason = unusable(estimate, corner.speed_mps, corner.accel_mps2, mission)
    problem = f"corner {k}: {reason}" if reason else ""
    state = replace(state, planned=estimate, corner_problem=problem)
    if reason:
        return Decision(replace(state, done_corner=k), goes_on=True)
    first_stop = estimate.stop if before is None else before.first_stop
    frame = CornerFrame(estimate.stop, situation.turn_side)
    planned = _rule_plan(estimate, frame, state, tick)
    if planned is None:
        return _from_anywhere(estimate, frame, first_stop, state, tick)
    plan, speed_up, lead_mps = planned
    unsure = not tick.turns.is_sure
    active = ActiveCorner(k, estimate, frame, plan, first_stop, lead_mps, unsure=unsure)
    slot = tick.slot_frame
    path, flown_m = active.path, active.flown_m(tick.now_s)
    state = replace(state, speed_up=speed_up)
    speed_mps = path_speed_mps(
        tick,
        path.length_m - flown_m,
        0.0 if plan.rule in OUTSIDE else plan.next_lag_m - tick.aim_m,
        helicopter_mps=estimate.speed_mps,
        planned_share=speed_up,
        share=state.efficiency.now,
    )
    tracked = TrackedPath(slot, slot.path_from_map(path), estimate.onset_time_s, speed_mps, flown_m)
    state = state.on_path(tracked, tick, active)
    listing = PathListing(str(plan.rule), path, speed_mps, flown_m)
    return Decision(commit_when_due(state, tick), listing)


def _rule_plan(
    estimate: CornerEstimate, frame: CornerFrame, state: State, tick: Tick
) -> tuple[CornerPlan, float, float] | None:
    """Return the plan, how much faster than V it is flown, and how fast it begins [m/s].

    None off the slot track, or where the UAV is to come from the outside of the turn to its inside.
    """
    uav, places_m = tick.situation.uav, tick.situation.places_m
    assert uav is not None
    assert places_m is not None
    before_m, after_m = places_m
    pose = frame.to_frame(uav.pose)
    on_slot = is_on_track(Pose(pose.x_m, pose.y_m + before_m, pose.heading_rad))
    if not on_slot or before_m < 0.0 < after_m:
        return None
    passed_s = max(0.0, tick.now_s - estimate.onset_time_s + tick.mission.reaction_s)
    if after_m < 0.0:
        parameters, lag_m = measured(estimate, frame, uav, tick.corner)
        lead_m = uav.speed_mps * passed_s
        rules = OutsideRules(
            parameters, abs(tick.situation.turn_rad), from_m=-before_m, to_m=-after_m
        )
        outside = outside_plan(rules, frame, estimate, lag_m, lead_m, tick)
        return None if outside is None else (*outside, uav.speed_mps)
    # Its beginning is flown at V by plan: as one that is now where this one is.
    lead_mps = estimate.speed_mps
    parameters, lag_m = measured(estimate, frame, uav, tick.corner, lead_mps)
    lag_m -= (uav.speed_mps - lead_mps) * tick.mission.reaction_s
    best: tuple[float, CornerPlan, float] | None = None
    for wider_m in WIDER_M:
        separations_m = tuple(wider_m + one for one in tick.separations_m)
        planned = _in_wind(parameters, lag_m, lead_mps, passed_s, frame, separations_m, state, tick)
        if planned is None:
            break
        if best is None or planned[0] > best[0]:
            best = planned
        if planned[0] >= tick.corner.separation_m:
            break
    return None if best is None else (*best[1:], lead_mps)


def _in_wind(
    parameters: CornerParameters,
    lag_m: float,
    lead_mps: float,
    passed_s: float,
    frame: CornerFrame,
    separations_m: tuple[float, ...],
    state: State,
    tick: Tick,
) -> tuple[float, CornerPlan, float] | None:
    """Return how far apart a plan stays as it will be flown in the wind, the plan, its speed-up."""
    share, found = 1.0, None
    for _ in range(SHARE_LOOKS):
        plan_with = functools.partial(
            sped_up_plan,
            parameters,
            lag_m,
            lead_m=lead_mps * passed_s,
            separations_m=separations_m,
            speeds=tick.corner_speeds(lead_mps),
            path_efficiency=state.efficiency.share * share,
            turn_rad=abs(tick.situation.turn_rad),
            aim_m=tick.aim_m,
        )
        planned = None if tick.turns.is_sure else plan_with(least_share=UNSURE_SHARE)
        if planned is None or abs(planned[0].next_lag_m - tick.aim_m) > CONVERGED_M:
            planned = plan_with()
        if planned is None:
            break
        plan, speed_up = planned
        path = TrackedPath(frame, plan.path, 0.0, speed_up * lead_mps, lead_mps * passed_s)
        flown = tick.flown(path)
        before, share = share, flown.share
        found = tick.apart_m(flown), plan, speed_up
        if abs(share - before) < SHARE_CHANGE:
            break
    return found


def _from_anywhere(
    estimate: CornerEstimate, frame: CornerFrame, first_stop: Pose, state: State, tick: Tick
) -> Decision:
    """Go straight for the slot of the new leg, from wherever the UAV is."""
    begun = start_rejoining(state, tick, state.efficiency.share)
    path, uav = begun.state.path, tick.situation.uav
    assert path is not None
    assert uav is not None
    assert isinstance(begun.listing, PathListing)
    parameters, lag_m = measured(estimate, frame, uav, tick.corner)
    next_lag_m = final_lag_m(
        path.path,
        tick.expected.in_frame(path.frame),
        start_s=path.begun_s,
        speed_mps=path.speed_mps,
    )
    in_corner = frame.path_from_map(path.frame.path_to_map(path.path))
    plan = CornerPlan(Rule.RJ, lag_m, next_lag_m, in_corner, parameters)
    k = tick.situation.corners_seen
    active = ActiveCorner(k, estimate, frame, plan, first_stop, uav.speed_mps, committed=True)
    problem = begun.state.path_problem
    state = begun.state.on_path(path, tick, active)
    efficiency = state.efficiency.begun(tick.corner.speed_mps, is_known=tick.turns.is_sure)
    state = replace(state, speed_up=1.0, path_problem=problem, efficiency=efficiency)
    return Decision(state, replace(begun.listing, mode=str(Rule.RJ)))


def commit_when_due(state: State, tick: Tick) -> State:
    """Commit to the corner's path when the UAV is about to turn, or the corner is over."""
    active = state.corner
    assert active is not None
    margin_m = tick.mission.reaction_s * active.uav_speed_mps
    overtaken = tick.situation.corners_seen > active.k or not tick.situation.slows
    if not (overtaken or active.plan.turn_start_m - active.flown_m(tick.now_s) < margin_m + 1e-6):
        return state
    efficiency = state.efficiency.begun(tick.corner.speed_mps, is_known=tick.turns.is_sure)
    if active.plan.rule in OUTSIDE:  # flown slowly on purpose: nothing is learnt of it
        efficiency = state.efficiency.cancelled()
    return replace(state, corner=replace(active, committed=True), efficiency=efficiency)


def path_speed_mps(
    tick: Tick,
    path_m: float,
    lag_m: float,
    *,
    helicopter_mps: float,
    planned_share: float | None,
    share: float,
) -> float:
    """Return the speed for a path that leaves a lag, at a helicopter's speed.

    ``planned_share``: its speed over that, by plan; None for one that is flown as fast as it takes.
    ``share``: what of its speed the UAV makes good.
    """
    return catching_up_mps(
        path_m,
        lag_m if lag_m >= tick.mission.lag_tolerance_m else 0.0,
        helicopter_mps,
        speed_up=1.0 if planned_share is None else planned_share,
        share=share,
        most_mps=tick.path_speeds_mps(planned_share, helicopter_mps)[1],
    )
