"""Geographic positions to and from the local east-north-up frame ``map``, by pymap3d (WGS 84)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import pymap3d
from pydantic import ConfigDict

from sar_estimator.common.checked import CHECKED
from sar_estimator.common.states import FloatArray


@dataclass(frozen=True)
class Datum:
    """The origin of the map frame.

    Raises ``ValueError`` for a latitude or longitude [deg] out of range or not finite.
    """

    __pydantic_config__: ClassVar[ConfigDict] = CHECKED

    latitude_deg: float
    longitude_deg: float
    altitude_m: float = 0.0

    def __post_init__(self) -> None:
        """Check the ranges."""
        if not valid_position(self.latitude_deg, self.longitude_deg):
            raise ValueError(
                f"datum {self.latitude_deg}, {self.longitude_deg}: "
                "expected latitude in -90...90 and longitude in -180...180 degrees"
            )
        if not math.isfinite(self.altitude_m):
            raise ValueError(f"datum altitude_m {self.altitude_m}: expected a finite number")

    def to_local(
        self, latitude_deg: float, longitude_deg: float, altitude_m: float | None = None
    ) -> tuple[float, float, float]:
        """Return east, north, up [m]; without an altitude the datum's is taken."""
        altitude = self.altitude_m if altitude_m is None else altitude_m
        x, y, z = pymap3d.geodetic2ecef(latitude_deg, longitude_deg, altitude)
        (xe, ye, ze), (xn, yn, zn), (xu, yu, zu), (x0, y0, z0) = self._frame
        x, y, z = float(x) - x0, float(y) - y0, float(z) - z0
        return xe * x + ye * y + ze * z, xn * x + yn * y + zn * z, xu * x + yu * y + zu * z

    @cached_property
    def _frame(self) -> tuple[tuple[float, ...], ...]:
        """East, north and up in the frame of the Earth, each of length 1, and the origin [m]."""
        here = self.latitude_deg, self.longitude_deg
        axes = [pymap3d.enu2uvw(*axis, *here) for axis in np.eye(3).tolist()]
        origin = pymap3d.geodetic2ecef(*here, self.altitude_m)
        return tuple(tuple(float(part) for part in vector) for vector in (*axes, origin))

    def to_geodetic(self, x_m: float, y_m: float, z_m: float = 0.0) -> tuple[float, float, float]:
        """Return latitude [deg], longitude [deg], altitude [m] of a map position."""
        latitude, longitude, altitude = pymap3d.enu2geodetic(
            x_m, y_m, z_m, self.latitude_deg, self.longitude_deg, self.altitude_m
        )
        return float(latitude), float(longitude), float(altitude)

    def all_to_geodetic(self, points: FloatArray) -> FloatArray:
        """Return latitudes, longitudes [deg], altitudes [m], shape (n, 3), of places (n, 2) [m]."""
        found = pymap3d.enu2geodetic(
            points[:, 0], points[:, 1], 0.0, self.latitude_deg, self.longitude_deg, self.altitude_m
        )
        return np.column_stack(found)


def valid_position(latitude_deg: float, longitude_deg: float) -> bool:
    """Whether latitude and longitude [deg] are finite and in range."""
    return abs(latitude_deg) <= 90.0 and abs(longitude_deg) <= 180.0
