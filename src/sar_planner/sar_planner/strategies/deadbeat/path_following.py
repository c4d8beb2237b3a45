"""A path that is flown: how far it is, whether it still fits, and when it is left."""

from __future__ import annotations

import math

from sar_estimator.common.frozen import replaced
from sar_estimator.common.states import Phase
from sar_planner.paths.flight_path import FlightPath
from sar_planner.prediction.separation import beside_apart_m, least_apart_m
from sar_planner.rejoin.tracked_path import (
    TrackedPath,
    final_lag_m,
    is_on_track,
    total_turn_rad,
)
from sar_planner.strategies.deadbeat.correction import correct
from sar_planner.strategies.deadbeat.leg_following import follow_leg
from sar_planner.strategies.deadbeat.state import (
    MARGIN_SHARE,
    WATCH_S,
    Decision,
    State,
    Tick,
)

BESIDE_M = 3.0
SETTLED_RAD = math.radians(20.0)
LATE_FACTOR = 2.5
FLOWN_FACTOR = 2.5  # of what is off its path, beside which nothing is learnt of it
LOST_SPACINGS = 0.4  # beside its path, where the UAV flies something else


def follow_path(state: State, tick: Tick) -> Decision:
    """Watch the path being flown; solve again what is left of it when it no longer fits."""
    path, now_s = state.path, tick.now_s
    assert path is not None
    if state.followed_s <= now_s < state.followed_s + WATCH_S:
        return Decision(state)
    here = tick.uav_in(path.frame)
    path = path.followed(here, path.speed_mps * (now_s - state.followed_s))
    there = path.path.pose_at(path.flown_m)
    beside = here.x_m - there.x_m, here.y_m - there.y_m
    off_m = math.hypot(*beside)
    efficiency = state.efficiency.moved()  # one that flies elsewhere: its list was refused
    if off_m < FLOWN_FACTOR * tick.mission.off_path_m:
        speed_mps = tick.flown_mps(path.speed_mps)
        efficiency = state.efficiency.watched(now_s, path.flown_m, speed_mps)
    share = tick.speed_share(path)
    lost = state.is_lost or off_m > LOST_SPACINGS * tick.corner.spacing_m
    state = replaced(
        state,
        path=path,
        followed_s=now_s,
        efficiency=efficiency,
        speed_share=share,
        is_lost=lost,
    )
    rest = path.path.cut(min(path.flown_m, path.path.length_m))
    if _is_over(path, rest, tick):
        return follow_leg(state.left(tick), tick)
    if (path.is_flown and not lost) or now_s < state.retry_s:
        return Decision(state)
    moved = tick.corner.turn_radius_m > state.planned_radius_m or path.misses(
        tick.slot_frame, rest.length_m, tick.mission.far_tolerance
    )
    forecasts = tick.forecasts_in(path.frame)
    slowest, fastest = tick.path_speeds_mps(state.planned_share, forecasts[0].speed_mps)
    if state.flies_outside:
        if tick.situation.slows or tick.situation.phase is Phase.STOPPED:
            # Not before the nose of one that may go straight on: the leg makes up for it.
            slowest = fastest = state.speed_up * tick.expected.speed_mps
        else:  # as fast as the wind lets it on each course
            fastest = max(fastest, (1.0 + tick.turned_faster) * tick.expected.speed_mps)
    path = path.timed(rest, forecasts[0], now_s, (slowest, fastest), state.share)
    state = replaced(state, path=path, speed_mps=path.speed_mps)
    speed_mps = path.speed_mps * state.share
    lag_m = final_lag_m(rest, forecasts[0], start_s=now_s, speed_mps=speed_mps)
    tolerance_m = max(tick.mission.lag_tolerance_m, tick.mission.far_tolerance * rest.length_m)
    settling = now_s - state.corrected_s < tick.mission.settling_s
    fits = abs(lag_m) < tolerance_m and not moved and (settling or off_m < tick.mission.off_path_m)
    # Outside, a lag is left on purpose, and what is left beside the slot is the leg's.
    fits = (fits or state.flies_outside) and not lost
    apart_m = least_apart_m(rest, forecasts, start_s=now_s, speed_mps=speed_mps)
    if off_m > BESIDE_M:
        now_m = beside_apart_m(rest, beside, forecasts, start_s=now_s, speed_mps=speed_mps)
        apart_m = min(apart_m, now_m)
    margin_m = 0.0 if settling else MARGIN_SHARE * tick.margin_m
    if fits and apart_m >= tick.corner.separation_m + margin_m:
        return Decision(state)
    stays = (not moved or state.flies_outside) and not lost
    safe = stays and apart_m >= tick.corner.separation_m
    return correct(state, tick, off_m, abs(lag_m) if safe else math.inf)


def _is_over(path: TrackedPath, rest: FlightPath, tick: Tick) -> bool:
    """Whether a path is left: nearly flown and on the slot, lost at its end, or far too late."""
    length_m = path.path.length_m
    settled = path.is_flown or total_turn_rad(rest) < SETTLED_RAD
    overdue = tick.now_s - path.begun_s > LATE_FACTOR * length_m / path.speed_mps
    lost = path.is_flown and not is_on_track(path.end_in(tick.slot_frame))
    return (settled and tick.on_slot()) or overdue or lost
