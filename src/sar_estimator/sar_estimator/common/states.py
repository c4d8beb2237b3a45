"""What the estimator knows of an aircraft, as plain values in the map frame (x east, y north)."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose

FloatArray = NDArray[np.float64]


class Phase(enum.StrEnum):
    """What the helicopter is doing."""

    CRUISE = "cruise"
    DECELERATING = "decelerating"
    STOPPED = "stopped"
    ACCELERATING = "accelerating"
    LOST = "lost"


class Motion(NamedTuple):
    """Position [m], velocity [m/s] and acceleration [m/s^2] of an aircraft at ``time_s``."""

    time_s: float
    x_m: float
    y_m: float
    vx_mps: float
    vy_mps: float
    ax_mps2: float = 0.0
    ay_mps2: float = 0.0

    @property
    def speed_mps(self) -> float:
        """Ground speed [m/s]."""
        return math.hypot(self.vx_mps, self.vy_mps)

    @property
    def course_rad(self) -> float:
        """Direction of motion over ground [rad]; 0 when at rest."""
        return math.atan2(self.vy_mps, self.vx_mps)

    @property
    def pose(self) -> Pose:
        """Position and course."""
        return Pose(self.x_m, self.y_m, self.course_rad)

    def stamped(self, time_s: float) -> Motion:
        """Return the same motion at another time [s]: that of another clock."""
        return Motion(
            time_s, self.x_m, self.y_m, self.vx_mps, self.vy_mps, self.ax_mps2, self.ay_mps2
        )

    def after(self, time_s: float) -> Motion:
        """Return the motion so much later [s], at the same velocity."""
        return self._replace(
            time_s=self.time_s + time_s,
            x_m=self.x_m + time_s * self.vx_mps,
            y_m=self.y_m + time_s * self.vy_mps,
        )

    def is_finite(self) -> bool:
        """Whether no component is NaN or infinite."""
        return math.isfinite(self.time_s + self.x_m + self.y_m + self.vx_mps + self.vy_mps)


@dataclass(frozen=True, slots=True)
class MotionEstimate:
    """A motion and its covariance, shape (6, 6), in the order x, vx, ax, y, vy, ay.

    ``altitude_m``: above mean sea level, NaN where it is not known.
    """

    motion: Motion
    covariance: FloatArray
    altitude_m: float = math.nan

    @property
    def sigmas(self) -> tuple[float, float]:
        """Standard deviations of position [m] and velocity [m/s], along the worse axis."""
        x, vx, _, y, vy, _ = self.covariance.diagonal().tolist()
        return math.sqrt(max(x, y, 0.0)), math.sqrt(max(vx, vy, 0.0))


@dataclass(frozen=True, slots=True)
class LegEstimate:
    """The straight leg being flown: the helicopter's foot on it, its heading and cruise speed."""

    time_s: float
    foot: Pose
    speed_mps: float
    position_sigma_m: float
    heading_sigma_rad: float
    speed_sigma_mps: float


@dataclass(frozen=True, slots=True)
class CornerEstimate:
    """Where, when and how the helicopter will have stopped for a corner.

    ``stop`` carries the incoming heading. ``covariance`` is that of the stop point, shape (2, 2),
    in the map frame [m^2].
    """

    time_s: float
    stop: Pose
    stop_time_s: float
    speed_mps: float
    accel_mps2: float
    covariance: FloatArray
    heading_sigma_rad: float
    stop_time_sigma_s: float

    @property
    def stopping_distance_m(self) -> float:
        """S = V^2 / 2a [m]."""
        return self.speed_mps**2 / (2.0 * self.accel_mps2)

    def changed_m(self, other: CornerEstimate) -> float:
        """Return by how much another estimate differs: in place, or in time at cruise [m]."""
        moved = math.hypot(other.stop.x_m - self.stop.x_m, other.stop.y_m - self.stop.y_m)
        return max(moved, abs(other.stop_time_s - self.stop_time_s) * self.speed_mps)

    @property
    def onset_time_s(self) -> float:
        """When the deceleration began [s]."""
        return self.stop_time_s - self.speed_mps / self.accel_mps2


def list_id_at(time_s: float, last_id: int = 0) -> int:
    """Return the identity of a list made at a time [s], another one than that of the last list."""
    return max(round(time_s * 1e9), last_id + 1)
