"""On a leg: beside the helicopter by speed, back to the slot, or out of the way."""

from __future__ import annotations

from sar_estimator.common.frozen import replaced
from sar_planner.guidance.speed_control import trimmed_mps
from sar_planner.guidance.waypoint_lists import HoldListing, SlotListing
from sar_planner.patterns.legs import CORNERS
from sar_planner.rejoin.tracked_path import is_on_track
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.deadbeat.rejoining import start_rejoining
from sar_planner.strategies.deadbeat.state import Decision, State, Tick

BEHIND_SPACINGS, KEPT_SPACINGS = 0.15, 0.9


def follow_leg(state: State, tick: Tick) -> Decision:
    """Lead the UAV along its slot track and trim its speed, or back to it."""
    expected, mission = tick.expected, tick.mission
    frame = tick.slot_frame
    uav = tick.uav_in(frame)
    lag_m = frame.to_frame(expected.leg).x_m + expected.along_m(tick.now_s) - uav.x_m
    on_slot = is_on_track(uav)
    if (not on_slot or lag_m < -tick.most_ahead_m) and tick.now_s >= state.retry_s:
        return start_rejoining(state, tick)
    if not on_slot:
        return Decision(state)
    assert state.slot is not None
    speed_mps = trimmed_mps(
        lag_m - _kept_lag_m(lag_m, tick),
        expected.speed_mps,
        off_mps=mission.trim_follow * expected.faster_mps(tick.situation.helicopter),
        gain=mission.trim_gain,
        trim=tick.slower,
        faster=tick.faster,
    )
    return Decision(
        replaced(state, speed_mps=speed_mps, led_s=tick.now_s),
        SlotListing(str(Mode.LEG), state.slot),
    )


def _kept_lag_m(lag_m: float, tick: Tick) -> float:
    """Return the lag that is kept [m] of a UAV that was not seen in a turn yet, and is behind.

    Were it slow in its first corner, no path would be safe from there on to beside the helicopter.
    """
    outside = tick.situation.progress.stays_outside(tick.expected.leg.heading_rad)
    straight_on = CORNERS.get(tick.mission.pattern, 1) == 0
    near = lag_m < BEHIND_SPACINGS * tick.corner.spacing_m
    if tick.turns.is_sure or outside or straight_on or near:
        return 0.0
    return KEPT_SPACINGS * tick.corner.spacing_m


def unfit_speed(tick: Tick) -> str:
    """Return why the helicopter is too slow or too fast to be followed, empty when it is not."""
    slow, fast = (limit * tick.corner.speed_mps for limit in tick.mission.speed_range)
    speed_mps = tick.expected.speed_mps
    if slow <= speed_mps <= fast:
        return ""
    return f"helicopter's speed {speed_mps:.1f} m/s: expected {slow:.1f} to {fast:.1f}"


def hold(state: State, tick: Tick, reason: str) -> Decision:
    """Keep out of the way: the list ends ahead, where the bridge lets the UAV circle."""
    state = replaced(state, problem=f"holding: {reason}")
    uav = tick.situation.uav
    if state.mode is Mode.HOLD or uav is None:
        return Decision(state)
    held = replaced(state.without_path(Mode.HOLD), path_problem="")
    return Decision(held, HoldListing(str(Mode.HOLD), uav.pose))
