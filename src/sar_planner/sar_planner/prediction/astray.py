"""How near a path comes to a helicopter that leaves its corner another way than expected. Pure.

Until it is seen to fly its new leg it may stand on, go straight on, or turn to the other side. Who
watches over the UAV looks ``LOOK_S`` ahead for that: what is found here is what he will find, at
any time until then.
"""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.states import CornerEstimate
from sar_planner.paths.flight_path import FloatArray

LOOK_S = 10.0
LEAVES_MPS2 = 2.0
"""With which one speeds up that leaves a corner another way."""
STANDS_S = 10.0
"""For how long a pilot may stand in a corner as a matter of course, and be seen to leave it."""


def astray_apart_m(
    times_s: FloatArray, points_m: FloatArray, corner: CornerEstimate, turn_rad: float, now_s: float
) -> float:
    """Return the least distance [m] to one that was as expected until ``LOOK_S`` before.

    ``times_s``, ``points_m``: where the UAV is when, in the map, shapes (n,), (n, 2). ``corner``:
    where the helicopter slows and stands; ``turn_rad``: the turn expected there, left positive.
    Infinite where it has left before the first of them.
    """
    ends_s = corner.stop_time_s + STANDS_S + LOOK_S
    looked_at = (times_s >= now_s) & (times_s <= ends_s)
    if not looked_at.any():
        return math.inf
    times, points = times_s[looked_at], points_m[looked_at]
    begun = np.maximum(times - LOOK_S, now_s)
    left_s = np.maximum(corner.stop_time_s - begun, 0.0)
    slowing_s = corner.speed_mps / corner.accel_mps2
    braked_s = np.minimum(left_s, slowing_s)
    speed = corner.accel_mps2 * braked_s
    to_stop = 0.5 * corner.accel_mps2 * braked_s**2 + corner.speed_mps * (left_s - braked_s)
    on_m = _run(times - begun, speed, corner.speed_mps) - to_stop
    out_m = _run(np.maximum(times - begun - left_s, 0.0), np.zeros_like(times), corner.speed_mps)
    stop = np.array(corner.stop[:2])
    old = corner.stop.heading_rad
    stands_m = np.minimum(on_m, 0.0)
    ways = ((old, on_m), (old, stands_m), (old - turn_rad, out_m))
    least = math.inf
    for heading, run in ways:
        there = stop + run[:, None] * np.array((math.cos(heading), math.sin(heading)))
        least = min(least, float(np.hypot(*(points - there).T).min()))
    return least


def _run(for_s: FloatArray, speed_mps: FloatArray, until_mps: float) -> FloatArray:
    """Return the way [m] after times, shape (n,), from speeds on, speeding up until another."""
    ramp_s = np.minimum(for_s, np.maximum(until_mps - speed_mps, 0.0) / LEAVES_MPS2)
    run: FloatArray = speed_mps * for_s + LEAVES_MPS2 * ramp_s * (for_s - 0.5 * ramp_s)
    return run
