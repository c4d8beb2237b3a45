"""What a list that goes out at a corner keeps, whatever the corner turns out to be."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sar_estimator.common.states import CornerEstimate, Phase
from sar_planner.prediction.situation import STRAY_SIGMAS
from sar_planner.prediction.tube import SureApart, sure_apart, tube_about
from sar_planner.rejoin.tracked_path import TrackedPath
from sar_planner.strategies.deadbeat.state import State, Tick


def with_sure(state: State, tick: Tick) -> State:
    """Return the state with what the path of its corner keeps; the same where it has none."""
    if state.corner is None or state.path is None:
        return state
    sure, estimate = None, tick.situation.estimate
    if estimate is not None and tick.situation.phase is Phase.DECELERATING:
        sure = _sure(state.path, state.path.speed_mps * state.share, estimate, tick)
    return replace(state, corner=replace(state.corner, sure=sure))


def _sure(
    path: TrackedPath, speed_mps: float, estimate: CornerEstimate, tick: Tick
) -> SureApart | None:
    """Return what a path keeps; off is what the UAV is beside it, and the helicopter its line."""
    across = estimate.stop.heading_rad + 0.5 * math.pi
    normal = np.array((math.cos(across), math.sin(across)))
    sigma_m = math.sqrt(max(float(normal @ estimate.covariance @ normal), 0.0))
    here, there = tick.uav_in(path.frame), path.path.pose_at(path.flown_m)
    beside_m = STRAY_SIGMAS * max(sigma_m, tick.situation.strays_m)
    beside_m += math.hypot(here.x_m - there.x_m, here.y_m - there.y_m)
    expected = tick.expected.in_frame(path.frame)
    tube = tube_about(expected, estimate.stop_time_sigma_s, beside_m)
    if tube is None:
        return None
    rest = path.path.cut(min(max(path.flown_m, 0.0), path.path.length_m))
    return sure_apart(
        rest, tube, start_s=tick.now_s, speed_mps=speed_mps, reaction_s=tick.mission.reaction_s
    )
