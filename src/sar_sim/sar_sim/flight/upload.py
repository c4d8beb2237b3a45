"""What a flight without sockets hands over itself: lists to the autopilot, news to the monitor."""

from __future__ import annotations

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.mavlink.mission_items import first_ahead
from sar_bridge.mission.mission_slots import MissionBanks, RunIn, Write
from sar_bridge.monitor.helicopter_hypotheses import Habits
from sar_bridge.monitor.separation_monitor import MonitorParameters, SeparationMonitor
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.states import (
    CornerEstimate,
    FloatArray,
    LegEstimate,
    MotionEstimate,
    Phase,
)
from sar_planner.parameters.corner import CornerParameters
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.presets import parameter_values


def monitor_for(
    corner: CornerParameters, turn_side: int, *, watch_only: bool = False
) -> SeparationMonitor:
    """Return the monitor of a mission, as the launcher sets it up."""
    return SeparationMonitor(
        MonitorParameters(min_separation_m=corner.separation_m, watch_only=watch_only),
        Habits(corner.speed_mps, corner.accel_mps2, turn_side),
    )


def load_list(
    autopilot: SimAutopilot,
    banks: MissionBanks,
    points: FloatArray,
    datum: Datum,
    *,
    climb_m: float = 0.0,
) -> None:
    """Put a list, shape (n, 2) [m], into its bank and lead over to it, as the bridge does."""
    if autopilot.mode is not FlightMode.AUTO or not banks.takes(points):
        autopilot.load(banks.whole(points, datum, climb_m=climb_m))
        autopilot.set_current(first_ahead(points, autopilot.motion) + 1)
        autopilot.set_mode(FlightMode.AUTO)
        return
    _put(autopilot, banks.fill(points, datum, autopilot.current, climb_m=climb_m))
    told = parameter_values(autopilot.uav)
    tuning = FollowerTuning.read(told)
    step = banks.join(autopilot.current, autopilot.motion, datum, within_s=0.0, tuning=tuning)
    _put(autopilot, step)
    if isinstance(step, RunIn):
        autopilot.set_current(step.start)


def _put(autopilot: SimAutopilot, write: Write) -> None:
    for i, item in enumerate(write.items):
        autopilot.replace_item(write.start + i, item)


def tell_monitor(
    monitor: SeparationMonitor,
    estimate: MotionEstimate | None,
    phase: Phase,
    corner: CornerEstimate | None,
    leg: LegEstimate | None,
) -> None:
    """Tell the monitor what the estimator knows of the helicopter."""
    watched = monitor.helicopter
    if estimate is not None:
        watched.set_motion(estimate.motion, *estimate.sigmas)
    watched.phase, watched.corner = phase, corner
    if leg is not None:
        watched.set_leg(leg)
