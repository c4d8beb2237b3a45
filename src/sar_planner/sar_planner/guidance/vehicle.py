"""The UAV as its autopilot's parameters describe it: what it can fly, what it must be warned of."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from sar_estimator.common.constants import G_MPS2
from sar_planner.guidance.l1_waypoints import L1Tuning
from sar_planner.guidance.steady_wind import SteadyWind
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters


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

    @property
    def airspeeds_mps(self) -> tuple[float, float]:
        """The slowest and the fastest indicated airspeed that the autopilot flies."""
        return self.values.get("AIRSPEED_MIN", 0.0), self.values.get("AIRSPEED_MAX", math.inf)

    def air(
        self,
        wind_mps: tuple[float, float],
        airspeed_ratio: float = 1.0,
        steady: SteadyWind | None = None,
    ) -> AirEnvelope:
        """Return its true airspeeds, in a wind; ``airspeed_ratio``: true over indicated."""
        slowest, fastest = self.airspeeds_mps
        return AirEnvelope(airspeed_ratio * slowest, airspeed_ratio * fastest, wind_mps, steady)

    def indicated_mps(self, true_mps: float, airspeed_ratio: float) -> float:
        """Return what the autopilot is to be told for a true airspeed: it refuses other values."""
        slowest, fastest = self.airspeeds_mps
        return min(max(true_mps / airspeed_ratio, slowest), fastest)

    def refusal(
        self, corner: CornerParameters, mission: MissionParameters, air: AirEnvelope
    ) -> str:
        """Return why this UAV cannot fly the mission: parameter, value, expectation.

        ``air``: its airspeeds as they are now (``air``).
        """
        v, r = corner.speed_mps, corner.turn_radius_m
        if air.slowest_mps > v:
            return self._out_of_envelope("AIRSPEED_MIN", air.slowest_mps, "at most", v)
        if air.fastest_mps < v:
            return self._out_of_envelope("AIRSPEED_MAX", air.fastest_mps, "at least", v)
        # Ground speed is held at V by airspeed, as slow as that may become.
        top = max(v * (1.0 + mission.speed_trim), air.slowest_mps + math.hypot(*air.wind_mps))
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
        tuning, fastest = self.tuning(mission), v * (1.0 + mission.corner_speed_up)
        if tuning is not None and tuning.period_s > (
            longest := tuning.longest_period_s(r, fastest)
        ):
            return (
                f"autopilot's NAVL1_PERIOD = {tuning.period_s:g}: expected at most {longest:.1f} s "
                f"for R = {r:g} m at {fastest:g} m/s"
            )
        return ""

    def _out_of_envelope(self, name: str, true_mps: float, expected: str, v_mps: float) -> str:
        here = true_mps / self.values[name]
        indicated = f" ({v_mps / here:.1f} indicated)" if abs(here - 1.0) > 5e-3 else ""
        told = f"autopilot's {name} = {self.values[name]:g}"
        return f"{told}: expected {expected} V = {v_mps:g} m/s{indicated}"

    def warning(self) -> str:
        """Return what the operator must know before he relies on this autopilot."""
        for name in ("FS_GCS_ENABL", "FS_LONG_ACTN"):
            # With FS_LONG_ACTN = 0 the failsafe goes on with AUTO: ArduPlane's default.
            if self.values.get(name, 1.0) == 0.0:
                return f"autopilot's {name} = 0: it will not act when this laptop falls silent"
        return ""
