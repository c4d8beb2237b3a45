"""The speed trim on legs."""

from __future__ import annotations

import math

SLOWING_MPS2 = 0.25


def trimmed_mps(
    lag_m: float,
    speed_mps: float,
    *,
    gain: float,
    trim: float,
    faster: float = 0.0,
    off_mps: float = 0.0,
) -> float:
    """Return the ground speed [m/s] that takes out a lag [m]: V + off + gain L.

    ``off_mps``: by how much the helicopter is faster at present than V. It and the correction are
    each kept within V ``trim``, so that a lag is still taken out behind who flies fast for a while;
    the correction may be up to V ``faster`` upwards, no more than can be slowed from while the lag
    lasts (v^2 = 2 a L).
    """
    most = trim * speed_mps
    upwards = max(most, min(faster * speed_mps, math.sqrt(2.0 * SLOWING_MPS2 * max(lag_m, 0.0))))
    return speed_mps + min(max(off_mps, -most), most) + min(max(gain * lag_m, -most), upwards)
