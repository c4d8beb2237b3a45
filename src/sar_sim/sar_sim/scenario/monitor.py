"""What a mission prescribes to its monitors: how the helicopter is flown, how far to stay apart."""

from __future__ import annotations

import math

from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.parameters import MonitorParameters
from sar_planner.parameters.corner import CornerParameters
from sar_planner.patterns.legs import PatternTerms


def model_of(corner: CornerParameters, terms: PatternTerms) -> HelicopterModel:
    """Return how the helicopter is expected to be flown."""
    turn_deg = math.degrees(terms.angle_rad)
    return HelicopterModel(corner.speed_mps, corner.accel_mps2, terms.side, turn_deg)


def limits_of(corner: CornerParameters, *, watch_only: bool = False) -> MonitorParameters:
    """Return how far a UAV is to stay apart."""
    return MonitorParameters(min_separation_m=corner.separation_m, watch_only=watch_only)
