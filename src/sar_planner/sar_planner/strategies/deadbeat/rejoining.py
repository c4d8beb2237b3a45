"""From anywhere onto the slot."""

from __future__ import annotations

from dataclasses import replace

from sar_estimator.common.pose import Pose
from sar_planner.guidance.waypoint_lists import PathListing
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.rejoin.rejoin import RejoinPlan, RejoinTask, onto_track, rejoin
from sar_planner.rejoin.tracked_path import TrackedPath
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.deadbeat.state import Decision, State, Tick

LATE_S = 240.0


def start_rejoining(state: State, tick: Tick, share: float = 1.0) -> Decision:
    """Lead the UAV from anywhere onto the slot, at a speed of its own.

    ``share``: what it makes good of its speed.
    """
    state = replace(state, retry_s=tick.now_s + tick.mission.retry_s)
    plan = rejoin_plan(state, tick, share)
    taken = take(plan, state, tick)
    if plan.closest_m >= tick.corner.separation_m:
        return taken
    problem = f"rejoining comes within {plan.closest_m:.0f} m of the helicopter"
    return taken._replace(state=replace(taken.state, path_problem=problem))


def rejoin_plan(state: State, tick: Tick, share: float = 1.0) -> RejoinPlan:
    """Return the way back: with the whole margin where there is one, else what keeps more apart.

    Where the slot is not met within ``LATE_S``, onto its track: the leg makes up for the rest.
    ``share``: what the UAV makes good of its speed; the plan's speed is the one to ask for. It is
    kept where it keeps the least, if not the margin.
    """
    slowest, fastest = (share * one for one in tick.path_speeds_mps(None, tick.expected.speed_mps))
    wide, _, least = (one + state.room_m for one in tick.separations_m)
    task = RejoinTask(
        _ahead(state, tick, tick.slot_frame),
        tick.now_s + tick.mission.reaction_s,
        tick.forecasts_in(tick.slot_frame),
        tick.turn_radius_m(None),
        slowest,
        fastest,
        wide,
        is_shared=tick.situation.is_shared(tick.now_s),
    )
    plan = _way_back(task)
    if not plan.kept:
        narrow = _way_back(replace(task, separation_m=least))
        plan = narrow if narrow.closest_m >= plan.closest_m else plan
    return replace(plan, speed_mps=plan.speed_mps / share, kept=plan.closest_m >= least)


def _way_back(task: RejoinTask) -> RejoinPlan:
    """Return the way onto the slot; onto its track where that takes too long, or for ever."""
    plan = rejoin(task)
    if plan is not None and plan.duration_s <= LATE_S:
        return plan
    late = onto_track(task)
    return late if plan is None or late.kept >= plan.kept else plan


def take(plan: RejoinPlan, state: State, tick: Tick) -> Decision:
    """Fly a way back from now on; a corner's is flown as its path was."""
    start_s = tick.now_s + tick.mission.reaction_s
    path = TrackedPath(tick.slot_frame, plan.path, start_s, plan.speed_mps)
    state = replace(state.on_path(path, tick), efficiency=state.efficiency.moved())
    listing = PathListing(str(Mode.REJOIN), path.frame.path_to_map(plan.path), path.speed_mps)
    return Decision(state, listing)


def _ahead(state: State, tick: Tick, frame: CornerFrame) -> Pose:
    """Return where the UAV will be, in a frame, when a list made now is flown."""
    path, reaction_s = state.path, tick.mission.reaction_s
    if path is None or state.is_lost:
        return tick.uav_in(frame, reaction_s)
    run_m = path.speed_mps * state.share * reaction_s
    ahead = path.carried_on(tick.uav_in(path.frame), path.flown_m + run_m)
    return frame.to_frame(path.frame.pose_to_map(ahead))
