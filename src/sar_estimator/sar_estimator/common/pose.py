"""Poses in the local east-north plane.

Lengths in metres, angles in radians, counter-clockwise positive, headings measured from the x axis
(REP-103: x east, y north).
"""

from __future__ import annotations

import math
from typing import NamedTuple


def blown_mps(speed_mps: float, from_deg: float) -> tuple[float, float]:
    """Return where a wind blows to, x (east) and y (north) [m/s], from its compass direction."""
    towards = math.radians(270.0 - from_deg)
    return speed_mps * math.cos(towards), speed_mps * math.sin(towards)


def wrap_angle(angle_rad: float) -> float:
    """Return ``angle_rad`` wrapped into (-pi, pi]."""
    wrapped = math.remainder(angle_rad, 2.0 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


class Pose(NamedTuple):
    """A position [m] and a heading [rad] in the plane."""

    x_m: float
    y_m: float
    heading_rad: float

    def along(self, x_m: float, y_m: float) -> float:
        """Signed distance [m] of a point ahead of this pose, along its heading."""
        dx, dy = x_m - self.x_m, y_m - self.y_m
        return dx * math.cos(self.heading_rad) + dy * math.sin(self.heading_rad)

    def across(self, x_m: float, y_m: float) -> float:
        """Signed distance [m] of a point to the left of this pose's line."""
        dx, dy = x_m - self.x_m, y_m - self.y_m
        return -dx * math.sin(self.heading_rad) + dy * math.cos(self.heading_rad)

    def offset(self, forward_m: float, left_m: float = 0.0) -> Pose:
        """Return the pose moved forward and to the left, heading unchanged."""
        c, s = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return Pose(
            self.x_m + forward_m * c - left_m * s,
            self.y_m + forward_m * s + left_m * c,
            self.heading_rad,
        )
