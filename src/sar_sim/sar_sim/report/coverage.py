"""How much of the claimed area was seen (shapely)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry

FloatArray = NDArray[np.float64]

ARC_SEGMENTS = 32
PIECE_POINTS = 500
SQUARE_STEP_M = 10.0
LEAST_MITRE = 0.2
LEAST_LEG_M = 1e-3


@dataclass(frozen=True)
class Coverage:
    """Areas [m^2]: claimed, seen of it, seen by both aircraft; and the gaps as a geometry.

    ``possible_m2``: of what is claimed, what a UAV in its ideal place would have left seen beside
    the helicopter as it really flew; ``reached_m2``: what was seen of that.
    """

    claimed_m2: float
    covered_m2: float
    overlap_m2: float
    possible_m2: float
    reached_m2: float
    gaps: BaseGeometry
    claimed: BaseGeometry

    @property
    def percent(self) -> float:
        """Covered area / claimed area [%]."""
        return 100.0 * self.covered_m2 / self.claimed_m2

    @property
    def reached_percent(self) -> float:
        """Covered share of what the helicopter's own track allows [%]."""
        return 100.0 * self.reached_m2 / self.possible_m2

    @property
    def overlap_percent(self) -> float:
        """Area seen by both aircraft / claimed area [%]."""
        return 100.0 * self.overlap_m2 / self.claimed_m2


def swath(xy_m: FloatArray, radius_m: float, *, footprint: str = "disc") -> BaseGeometry:
    """Return what is seen along a track, shape (n, 2) [m].

    A disc of ``radius_m``, or a square of that half-width turned into the direction of flight.
    """
    if len(xy_m) < 2:
        raise ValueError(f"track of {len(xy_m)} points: expected two or more")
    if footprint == "disc":
        return shapely.union_all(_discs(xy_m, radius_m))
    return shapely.union_all(_squares(xy_m, radius_m))


def _discs(xy_m: FloatArray, radius_m: float) -> Any:
    """Return what a disc sweeps along every piece of a track.

    In pieces, as the time for one that crosses itself again and again grows with its square.
    """
    begins = range(0, len(xy_m) - 1, PIECE_POINTS)
    lines = [LineString(xy_m[begin : begin + PIECE_POINTS + 1]) for begin in begins]
    return shapely.buffer(shapely.simplify(lines, 0.05), radius_m, quad_segs=ARC_SEGMENTS)


def _squares(xy_m: FloatArray, half_m: float) -> list[Polygon]:
    """Return the hulls of the squares at the ends of every piece of a track."""
    steps = np.hypot(*np.diff(xy_m, axis=0).T)
    along = np.concatenate(([0.0], np.cumsum(steps)))
    count = max(2, math.ceil(along[-1] / SQUARE_STEP_M) + 1)
    at = np.linspace(0.0, along[-1], count)
    points = np.column_stack([np.interp(at, along, xy_m[:, axis]) for axis in (0, 1)])
    hulls = []
    for a, b in pairwise(points):
        length = float(np.hypot(*(b - a)))
        if length < 1e-6:
            continue
        ahead = (b - a) / length * half_m
        left = np.array((-ahead[1], ahead[0]))
        hulls.append(
            Polygon([a - ahead + left, a - ahead - left, b + ahead - left, b + ahead + left])
        )
    return hulls


def ideal_tracks(
    corners_xy: FloatArray, *, spacing_m: float, sides: Sequence[int]
) -> tuple[FloatArray, FloatArray]:
    """Return the ideal formation's tracks with sharp corners, each of shape (n, 2) [m].

    ``corners_xy``: the helicopter's start, corners and end. The UAV flies ``spacing_m`` to a side
    of each leg, ``sides``: 1 right, -1 left; its corners are where its legs' lines cross, or, where
    it changes sides, it flies from leg to leg. (A library's offset curve falls apart here: in an
    expanding square the UAV's strips of two rounds lie side by side.) Points that are the
    same count once; two or more are needed.
    """
    line, legs = np.asarray(corners_xy, dtype=np.float64), np.asarray(sides, dtype=np.float64)
    ways = np.diff(line, axis=0)
    lengths = np.hypot(ways[:, 0], ways[:, 1])
    if lengths.min(initial=math.inf) < LEAST_LEG_M:
        long = lengths >= LEAST_LEG_M
        kept = line[np.concatenate(([True], long))]
        return ideal_tracks(kept, spacing_m=spacing_m, sides=legs[long].tolist())
    ways /= lengths[:, None]
    beside = legs[:, None] * np.column_stack((ways[:, 1], -ways[:, 0]))
    uav = [line[0] + spacing_m * beside[0]]
    for point, before, after, changes in zip(
        line[1:-1], beside[:-1], beside[1:], legs[1:] != legs[:-1], strict=True
    ):
        if changes:
            uav += [point + spacing_m * before, point + spacing_m * after]
        else:
            straightness = max(1.0 + float(before @ after), LEAST_MITRE)
            uav.append(point + spacing_m * (before + after) / straightness)
    uav.append(line[-1] + spacing_m * beside[-1])
    return line, np.array(uav)


def measure(
    helicopter_xy: FloatArray,
    uav_xy: FloatArray,
    ideal: tuple[FloatArray, ...],
    *,
    radius_m: float,
    footprint: str,
) -> Coverage:
    """Compare what both aircraft saw with what the ideal formation sweeps."""
    swept = [swath(xy, radius_m, footprint=footprint) for xy in ideal]
    claimed = shapely.union_all(swept)
    first = swath(helicopter_xy, radius_m, footprint=footprint)
    second = swath(uav_xy, radius_m, footprint=footprint)
    seen = first.union(second).intersection(claimed)
    possible = shapely.union_all([first, *swept[1:]]).intersection(claimed)
    return Coverage(
        claimed_m2=claimed.area,
        covered_m2=seen.area,
        overlap_m2=first.intersection(second).intersection(claimed).area,
        possible_m2=possible.area,
        reached_m2=seen.intersection(possible).area,
        gaps=claimed.difference(seen),
        claimed=claimed,
    )
