"""Whether the planner may, and can, lead the UAV."""

from __future__ import annotations

from sar_estimator.common.reports import UavStatus
from sar_estimator.common.states import Phase
from sar_planner.parameters.mission import MissionParameters
from sar_planner.prediction.situation import Situation

ENGAGE_MODES = ("AUTO", "GUIDED")


def not_flying(status: UavStatus) -> str:
    """Return why an autopilot's status forbids to lead the UAV, empty when it does not."""
    if not status.connected:
        return "no heartbeat from the autopilot"
    if not status.armed:
        return "UAV not armed: expected it in the air"
    if status.mode not in ENGAGE_MODES:
        return f"UAV in mode {status.mode}: expected {' or '.join(ENGAGE_MODES)}"
    return ""


def obstacle(situation: Situation, mission: MissionParameters, now_s: float) -> str:
    """Return what is missing at ``now_s`` [s] to lead the UAV, empty when nothing is."""
    for name, motion in (("UAV", situation.uav), ("helicopter", situation.helicopter)):
        if motion is None:
            return f"no {name} position"
        age = now_s - motion.time_s
        if age > mission.stale_s:
            return f"{name} position {age:.1f} s old (limit {mission.stale_s} s)"
    apart = situation.separation_m()
    if apart is not None and apart > mission.farthest_m:
        most = f"expected within {mission.farthest_m / 1e3:g} km"
        return f"helicopter {apart / 1e3:.0f} km from the UAV: {most}"
    if situation.phase is Phase.LOST:
        return "helicopter GPS lost"
    if situation.leg is None:
        return "helicopter's leg not known yet"
    return ""
