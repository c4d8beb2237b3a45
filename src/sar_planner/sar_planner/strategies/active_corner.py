"""What the UAV is being led along, and the corner being flown."""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, Motion
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import CornerFrame, FlightPath
from sar_planner.prediction.tube import SureApart
from sar_planner.rules.paper_rules import CornerPlan


class Mode(enum.StrEnum):
    """What the UAV is being led along."""

    IDLE = "idle"
    LEG = "leg"
    CORNER = "corner"
    REJOIN = "rejoin"
    HOLD = "hold"
    ORBIT = "orbit"


@dataclass(frozen=True)
class ActiveCorner:
    """The corner being flown: ``k`` from 1, the estimate it was planned from, and the plan.

    ``uav_speed_mps``: along the path, since the onset. ``sure``: what the newest list keeps from a
    tube of such corners, None where that is not known: once the helicopter has stopped.
    ``unsure``: planned before it was seen how the UAV turns.
    """

    k: int
    estimate: CornerEstimate
    frame: CornerFrame
    plan: CornerPlan
    first_stop: Pose
    uav_speed_mps: float
    committed: bool = False
    sure: SureApart | None = None
    unsure: bool = False

    @property
    def path(self) -> FlightPath:
        """The planned path in the map."""
        return self.frame.path_to_map(self.plan.path)

    def flown_m(self, time_s: float) -> float:
        """Distance along the path at ``time_s``, flown since the onset [m]."""
        return self.uav_speed_mps * (time_s - self.estimate.onset_time_s)


def measured(
    estimate: CornerEstimate,
    frame: CornerFrame,
    uav: Motion,
    nominal: CornerParameters,
    led_back_mps: float | None = None,
) -> tuple[CornerParameters, float]:
    """Return a corner's parameters as estimated, and L(k) [m], led back to the onset.

    ``led_back_mps``: at which speed; the UAV's own where it is not given.
    """
    parameters = replace(nominal, speed_mps=estimate.speed_mps, accel_mps2=estimate.accel_mps2)
    since = uav.time_s - estimate.onset_time_s
    speed_mps = uav.speed_mps if led_back_mps is None else led_back_mps
    at_onset = frame.to_frame(uav.pose).x_m - speed_mps * since
    return parameters, -parameters.stopping_m - at_onset


def unusable(
    estimate: CornerEstimate, speed_mps: float, accel_mps2: float, m: MissionParameters
) -> str:
    """Return why the rules are not used for such a corner, empty when they are."""
    for name, value, nominal, limits in (
        ("speed", estimate.speed_mps, speed_mps, m.speed_range),
        ("deceleration", estimate.accel_mps2, accel_mps2, m.accel_range),
    ):
        if not limits[0] * nominal <= value <= limits[1] * nominal:
            return (
                f"helicopter's {name} {value:.2f}: the rules expect "
                f"{limits[0] * nominal:.2f} ... {limits[1] * nominal:.2f}"
            )
    return ""
