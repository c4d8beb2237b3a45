"""The UAV as its autopilot's parameters describe it: what it can fly, what it must be warned of."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from sar_planner.air import AirEnvelope
from sar_planner.guide import L1Tuning
from sar_planner.mission_parameters import MissionParameters
from sar_planner.parameters import CornerParameters

G_MPS2 = 9.80665


@dataclass(frozen=True, slots=True)
class Vehicle:
    """An autopilot's parameters by ArduPlane's names; none for one that tells nothing."""

    values: Mapping[str, float]

    def tuning(self, mission: MissionParameters) -> L1Tuning | None:
        """Return the lateral guidance, None where it is not L1's."""
        period = self.values.get("NAVL1_PERIOD")
        if period is None:
            return None
        damping = self.values.get("NAVL1_DAMPING", 0.75)
        return L1Tuning(period, damping, mission.turn_share, mission.roll_lag_s)

    def air(self, wind_mps: tuple[float, float]) -> AirEnvelope:
        """Return its airspeeds, in a wind."""
        slowest = self.values.get("AIRSPEED_MIN", 0.0)
        return AirEnvelope(slowest, self.values.get("AIRSPEED_MAX", math.inf), wind_mps)

    def refusal(
        self, corner: CornerParameters, mission: MissionParameters, wind_mps: tuple[float, float]
    ) -> str:
        """Return why this UAV cannot fly the mission: parameter, value, expectation."""
        v, r = corner.speed_mps, corner.turn_radius_m
        slowest = self.values.get("AIRSPEED_MIN", 0.0)
        fastest = self.values.get("AIRSPEED_MAX", math.inf)
        if slowest > v:
            return f"autopilot's AIRSPEED_MIN = {slowest:g}: expected at most V = {v:g} m/s"
        if fastest < v:
            return f"autopilot's AIRSPEED_MAX = {fastest:g}: expected at least V = {v:g} m/s"
        # Ground speed is held at V by airspeed, as slow as that may become.
        top = max(v * (1.0 + mission.speed_trim), slowest + math.hypot(*wind_mps))
        limit_deg = self.values.get("ROLL_LIMIT_DEG", 90.0)
        needed_deg = math.degrees(math.atan(top**2 / (G_MPS2 * r)))
        if needed_deg > limit_deg:
            return (
                f"autopilot's ROLL_LIMIT_DEG = {limit_deg:g}: expected at least "
                f"{needed_deg:.0f} for R = {r:g} m at {top:.1f} m/s over ground"
            )
        widest = self.values.get("WP_MAX_RADIUS", 0.0)
        if widest > 0.0:
            return (
                f"autopilot's WP_MAX_RADIUS = {widest:g}: expected 0; with it the UAV turns back "
                "for waypoints that it passes beside"
            )
        tuning, hurried = self.tuning(mission), v * (1.0 + mission.corner_hurry)
        if tuning is not None and tuning.period_s > (
            longest := tuning.longest_period_s(r, hurried)
        ):
            return (
                f"autopilot's NAVL1_PERIOD = {tuning.period_s:g}: expected at most {longest:.1f} s "
                f"for R = {r:g} m at {hurried:g} m/s"
            )
        return ""

    def warning(self) -> str:
        """Return what the operator must know before he relies on this autopilot."""
        for name in ("FS_GCS_ENABL", "FS_LONG_ACTN"):
            # With FS_LONG_ACTN = 0 the failsafe goes on with AUTO: ArduPlane's default.
            if self.values.get(name, 1.0) == 0.0:
                return f"autopilot's {name} = 0: it will not act when this laptop falls silent"
        return ""
