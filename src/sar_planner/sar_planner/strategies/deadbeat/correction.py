"""A path that no longer fits: what is left of it is solved again from where the UAV will be."""

from __future__ import annotations

import math
from dataclasses import replace

from sar_estimator.common.pose import Pose
from sar_planner.guidance.waypoint_lists import PathListing
from sar_planner.paths.flight_path import FlightPath
from sar_planner.paths.slot_intercept import row_of
from sar_planner.prediction.separation import least_apart_m
from sar_planner.rejoin.recapture import Recapture
from sar_planner.rejoin.tracked_path import TrackedPath, final_lag_m, is_on_track
from sar_planner.rules.corner_coverage import SweepAt
from sar_planner.rules.paper_rules import Rule
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.deadbeat.corner_planning import path_speed_mps
from sar_planner.strategies.deadbeat.rejoining import rejoin_plan, take
from sar_planner.strategies.deadbeat.state import (
    MARGIN_SHARE,
    Decision,
    State,
    Tick,
)

CORRECTED_SHARE = 0.6  # of the margin: what a corrected path is to have of it
WIDER_M = 5.0
LONGER_SPACINGS = 1.0


def correct(state: State, tick: Tick, off_m: float, held_lag_m: float) -> Decision:
    """Solve what is left of a path again.

    ``off_m``: how far the UAV is beside it. ``held_lag_m``: that it leaves, infinite where it is
    not safe: a new path must not be much worse.
    """
    old = state.path
    assert old is not None
    frame, now_s = tick.slot_frame, tick.now_s
    begin, kept, left = _joined(state, tick, off_m)
    left_m = math.inf if left is None else left.length_m
    speed_mps = tick.expected.speed_mps
    search = Recapture(
        frame.to_frame(old.frame.pose_to_map(begin)),
        now_s + tick.mission.reaction_s,
        tick.forecasts_in(frame),
        tick.turn_radius_m(state.planned_share),
        state.speed_up * speed_mps * state.share,
        tick.corner.separation_m,
        left_m + LONGER_SPACINGS * tick.corner.spacing_m,
        _sweep(state, tick),
    )
    separation_m = tick.corner.separation_m + state.room_m
    least_m = separation_m + MARGIN_SHARE * tick.margin_m
    wanted_m = separation_m + CORRECTED_SHARE * tick.margin_m
    path = search.best(None if left is None else row_of(left), wanted_m, least_m)
    if path is None:
        return _widest(search, state, tick)
    state = replace(state, retry_s=now_s + tick.mission.correction_s)
    lag_m = final_lag_m(
        path, search.forecasts[0], start_s=search.start_s, speed_mps=search.speed_mps
    )
    if off_m < tick.mission.off_path_m and abs(lag_m) > held_lag_m + tick.corner.spacing_m:
        return Decision(state)
    whole = frame.path_from_map(old.frame.path_to_map(kept)).then(path)
    begun_s = now_s if kept.segments else now_s + tick.mission.reaction_s
    new_mps = path_speed_mps(
        tick,
        path.length_m,
        lag_m,
        helicopter_mps=speed_mps,
        planned_share=state.planned_share,
        share=state.share,
    )
    state = replace(
        state.on_path(TrackedPath(frame, whole, begun_s, new_mps), tick),
        corrections=state.corrections + 1,
        corrected_s=now_s,
        efficiency=state.efficiency.moved(),
    )
    name = str(Mode.REJOIN) if state.corner is None else str(state.corner.plan.rule)
    return Decision(state, PathListing(name, frame.path_to_map(whole), new_mps))


def _joined(state: State, tick: Tick, off_m: float) -> tuple[Pose, FlightPath, FlightPath | None]:
    """Return where a new path begins, what is flown of the old one until then, and its rest.

    In the old path's frame. A UAV that is lost flies neither: it goes straight on.
    """
    old = state.path
    assert old is not None
    if state.is_lost:
        begin = tick.uav_in(old.frame, tick.mission.reaction_s)
        return begin, FlightPath(begin, ()), None
    run_m = old.speed_mps * state.share * tick.mission.reaction_s
    from_m = min(old.flown_m + run_m, old.path.length_m)
    left = old.path.cut(from_m)
    if off_m >= tick.mission.off_path_m:
        begin = old.carried_on(tick.uav_in(old.frame), from_m)
        return begin, FlightPath(begin, ()), left
    kept = old.path.cut(min(old.flown_m, old.path.length_m), from_m)
    return old.path.pose_at(from_m), kept, left


def _sweep(state: State, tick: Tick) -> SweepAt | None:
    """Return the UAV's swaths about the corner that is flown; None where none is."""
    estimate = tick.situation.estimate
    no_rule = state.corner is None or state.corner.plan.rule is Rule.RJ or state.flies_outside
    if no_rule or estimate is None:
        return None
    corner_x_m = tick.slot_frame.to_frame(estimate.stop).x_m
    return SweepAt(tick.corner.spacing_m, corner_x_m, abs(tick.situation.turn_rad))


def _widest(search: Recapture, state: State, tick: Tick) -> Decision:
    """No path that meets the slot in time keeps the separation: get back, or stay away."""
    old = state.path
    assert old is not None
    frame, now_s = tick.slot_frame, tick.now_s
    state = replace(state, retry_s=now_s + tick.mission.retry_s)
    rest = old.path.cut(min(old.flown_m, old.path.length_m))
    kept_m = least_apart_m(
        rest,
        tick.forecasts_in(old.frame),
        start_s=now_s,
        speed_mps=old.speed_mps * state.share,
    )
    safe = kept_m >= tick.corner.separation_m and not state.is_lost
    if safe and is_on_track(old.end_in(frame)):
        return Decision(state)
    plan = rejoin_plan(state, tick, state.made_good)
    if plan.kept:
        return take(plan, state, tick)
    if safe:
        return Decision(state)
    widest = search.widest()
    listing = None
    if widest is not None and (state.is_lost or widest[1] > kept_m + WIDER_M):
        path, kept_m = widest
        tracked = TrackedPath(frame, path, search.start_s, tick.expected.speed_mps)
        state = state.on_path(tracked, tick)
        listing = PathListing(str(Mode.REJOIN), frame.path_to_map(path), tracked.speed_mps)
    problem = f"no safe path: comes within {kept_m:.0f} m of the helicopter"
    return Decision(replace(state, path_problem=problem), listing)
