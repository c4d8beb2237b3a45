"""The wind triangle: the airspeed that a ground speed takes, and what an envelope makes good."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sar_planner.guidance.steady_wind import SteadyWind
from sar_planner.paths.flight_path import FloatArray

NEARLY_MPS = 0.2
LEAST_TRIM = 0.02


@dataclass(frozen=True)
class AirEnvelope:
    """The UAV's airspeeds [m/s], and the wind it flies in, blowing towards ``wind_mps`` (x, y).

    Airspeeds are true ones. ``steady``: the wind over minutes, where it is known.
    """

    slowest_mps: float = 0.0
    fastest_mps: float = math.inf
    wind_mps: tuple[float, float] = (0.0, 0.0)
    steady: SteadyWind | None = None

    @cached_property
    def over_minutes(self) -> AirEnvelope:
        """The same airspeeds in the wind over minutes, where that is known."""
        steady = self.steady
        if steady is None:
            return self
        return AirEnvelope(self.slowest_mps, self.fastest_mps, steady.mean_mps, steady)

    @property
    def gusts_mps(self) -> float:
        """The standard deviation of gusts along an axis, 0 where it is not known."""
        return 0.0 if self.steady is None else self.steady.gusts_mps

    def airspeed_mps(self, course_rad: float, ground_speed_mps: float) -> float:
        """Return the airspeed [m/s] that a ground speed on a course takes, within the envelope."""
        needed = self._needed_mps(course_rad, ground_speed_mps)
        return min(max(needed, self.slowest_mps), self.fastest_mps)

    def speeds_mps(self, speed_mps: float, trim: float, faster: float = 0.0) -> tuple[float, float]:
        """Return the slowest and the fastest ground speed that paths are planned with.

        ``trim``, a share, below and above ``speed_mps``, as far as both can be made good on any
        course; always some ``LEAST_TRIM``. ``faster``: above it, where that is more.
        """
        wind, least = math.hypot(*self.wind_mps), min(trim, LEAST_TRIM)
        slowest = max(speed_mps * (1.0 - trim), self.slowest_mps + wind)
        fastest = min(speed_mps * (1.0 + max(trim, faster)), self.fastest_mps - wind)
        return min(slowest, speed_mps * (1.0 - least)), max(fastest, speed_mps * (1.0 + least))

    def on_course_mps(self, course_rad: float) -> tuple[float, float]:
        """Return the slowest and the fastest ground speed on a course [m/s].

        With the nose ahead; 0 where the wind carries the UAV off sideways, or backwards.
        """
        ux, uy = math.cos(course_rad), math.sin(course_rad)
        wind_x, wind_y = self.wind_mps
        along, across = wind_x * ux + wind_y * uy, wind_y * ux - wind_x * uy
        if abs(across) >= self.fastest_mps:
            return 0.0, 0.0
        slowest = along + math.sqrt(max(self.slowest_mps**2 - across**2, 0.0))
        fastest = along + math.sqrt(max(self.fastest_mps**2 - across**2, 0.0))
        return max(slowest, 0.0), max(fastest, 0.0)

    @property
    def kept_mps(self) -> tuple[float, float]:
        """The helicopter's speeds beside which a place is kept on all courses, in gusts, too [m/s].

        The first is more than the second where there is none.
        """
        spare = math.hypot(*self.over_minutes.wind_mps) + self.gusts_mps
        return self.slowest_mps + spare, self.fastest_mps - spare

    def _needed_mps(self, course_rad: float, ground_speed_mps: float) -> float:
        vx = ground_speed_mps * math.cos(course_rad) - self.wind_mps[0]
        vy = ground_speed_mps * math.sin(course_rad) - self.wind_mps[1]
        return math.hypot(vx, vy)

    def out_of_reach(self, course_rad: float, ground_speed_mps: float) -> str:
        """Return why a ground speed cannot be flown on a course, empty where it can."""
        needed = self._needed_mps(course_rad, ground_speed_mps)
        if self.slowest_mps - NEARLY_MPS <= needed <= self.fastest_mps + NEARLY_MPS:
            return ""
        return (
            f"wind {math.hypot(*self.wind_mps):.1f} m/s: {ground_speed_mps:.1f} m/s over ground "
            f"takes an airspeed of {needed:.1f} m/s, expected {self.slowest_mps:g} to "
            f"{self.fastest_mps:g}"
        )

    def ground_speeds_mps(self, courses_rad: FloatArray, wanted_mps: float) -> FloatArray:
        """Return the ground speeds made good on courses, shape (n,), of one that is wanted.

        What is wanted where the envelope allows it, else what its nearest airspeed gives; 0 where
        the wind carries the UAV off sideways.
        """
        ux, uy = np.cos(courses_rad), np.sin(courses_rad)
        along = self.wind_mps[0] * ux + self.wind_mps[1] * uy
        across = self.wind_mps[1] * ux - self.wind_mps[0] * uy
        needed = np.hypot(wanted_mps - along, across)
        airspeed = np.clip(needed, self.slowest_mps, self.fastest_mps)
        ahead = np.sqrt(np.maximum(airspeed**2 - across**2, 0.0))
        reached_mps = np.where(np.abs(across) < airspeed, np.maximum(along + ahead, 0.0), 0.0)
        return np.where(airspeed == needed, wanted_mps, reached_mps)
