"""How the path of a corner is flown in a wind, by a UAV whose airspeeds have limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sar_estimator.common.pose import blown_mps
from sar_planner.guidance.flown_speed import FlownPath, flown
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.prediction.separation import corner_forecast
from sar_planner.rules.deadbeat_paths import slot_frame
from sar_planner.rules.deadbeat_rules import DeadbeatRules
from sar_planner.rules.paper_rules import CornerPlan

LOOKS = 4


@dataclass(frozen=True, slots=True)
class CornerWind:
    """A wind at a corner.

    ``speed_mps``, ``from_deg``: its speed, and from where. ``course_deg``: of the old leg.
    ``airspeeds_mps``: the slowest and the fastest.
    """

    speed_mps: float
    from_deg: float
    course_deg: float
    airspeeds_mps: tuple[float, float]

    @property
    def air(self) -> AirEnvelope:
        """The airspeeds in the wind, in the corner's frame: x along the old leg."""
        # Turned so that the old leg leads east.
        wind = blown_mps(self.speed_mps, self.from_deg - self.course_deg + 90.0)
        return AirEnvelope(*self.airspeeds_mps, wind)

    def __str__(self) -> str:
        """Return it in words."""
        slowest, fastest = self.airspeeds_mps
        return (
            f"wind {self.speed_mps:g} m/s from {self.from_deg:03.0f}, old leg on course "
            f"{self.course_deg:03.0f}, airspeed {slowest:g} to {fastest:g} m/s"
        )


def planned_in_wind(
    parameters: CornerParameters, lag_m: float, lead_m: float, wind: CornerWind
) -> tuple[CornerPlan, FlownPath]:
    """Return the plan of a corner for what the wind lets the UAV make good, and how it is flown.

    Raises ``NoPathError`` where no path keeps apart.
    """
    air, v_mps, lead_s = wind.air, parameters.speed_mps, MissionParameters().speed_lead_s
    airspeed_mps, separation_m = air.airspeed_mps(0.0, v_mps), parameters.separation_m
    share, best = 1.0, None
    for _ in range(LOOKS):
        rules = DeadbeatRules(parameters, path_efficiency=share)
        plan = rules.plan(lag_m, lead_m=lead_m, separation_m=separation_m)
        found = flown(plan.path, v_mps, air, airspeed_mps, lead_s=lead_s)
        if best is None or abs(found.share - share) < best[0]:
            best = abs(found.share - share), plan, found
        share = found.share
    assert best is not None
    return best[1:]


def described(plan: CornerPlan, found: FlownPath, wind: CornerWind) -> str:
    """Return in lines how a plan is flown in the wind."""
    ground_mps = np.diff(found.along_m) / np.diff(found.times_s)
    forecast, frame = corner_forecast(plan.parameters), slot_frame(plan.parameters)
    slot_x_m = forecast.in_frame(frame).slot_x_m(float(found.times_s[-1]))
    next_lag_m = slot_x_m - frame.to_frame(plan.path.end).x_m
    return (
        f"{wind}\n"
        f"ground speed      {ground_mps.min():.1f} to {ground_mps.max():.1f} m/s,"
        f" {100.0 * found.share:.0f} % of V made good\n"
        f"L(k+1), flown     {next_lag_m:.1f} m\n"
        f"closest, flown    {found.apart_m(forecast, 0.0):.1f} m\n"
    )
