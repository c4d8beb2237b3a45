"""How much of the claimed area was seen (shapely)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry

FloatArray = NDArray[np.float64]

ARC_SEGMENTS = 32
PIECE_POINTS = 500
SQUARE_STEP_M = 10.0
LEAST_CROSSING = 0.05
LEAST_LEG_M = 1e-3


@dataclass(frozen=True)
class Coverage:
    """Areas [m^2]: claimed, seen of it, seen by two aircraft or more; and the gaps as a geometry.

    ``alone_m2``: what of it the helicopter alone saw. ``possible_m2``: of what is claimed, what
    UAVs in their ideal places would have left seen beside the helicopter as it really flew;
    ``reached_m2``: what was seen of that.
    """

    alone_m2: float
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
        """Area seen by two aircraft or more / claimed area [%]."""
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


class IdealSlot(NamedTuple):
    """A UAV's ideal place: how far beside the helicopter on each leg [m], right positive."""

    across_m: Sequence[float]


def ideal_tracks(corners_xy: FloatArray, slots: Sequence[IdealSlot]) -> tuple[FloatArray, ...]:
    """Return the ideal formation's tracks with sharp corners, each of shape (n, 2) [m].

    ``corners_xy``: the helicopter's start, corners and end; two or more different ones. The
    helicopter's track is the first, then that of every slot: its corners are where its legs' lines
    cross. (A library's offset curve falls apart here: in an expanding square the UAV's strips of
    two rounds lie side by side.) Points that are the same count once.
    """
    line = np.asarray(corners_xy, dtype=np.float64)
    lengths = np.hypot(*np.diff(line, axis=0).T)
    long = lengths >= LEAST_LEG_M
    if not long.all():
        kept = [IdealSlot(np.asarray(one.across_m)[long].tolist()) for one in slots]
        return ideal_tracks(line[np.concatenate(([True], long))], kept)
    return line, *(_beside(line, lengths, slot) for slot in slots)


def _beside(line: FloatArray, lengths: FloatArray, slot: IdealSlot) -> FloatArray:
    """Return a slot's track beside a helicopter's line, shape (n, 2) [m].

    Where the lines of two legs, beside them by a and b along unit normals m and n, cross:
    x m = a, x n = b, so x = ((a - b c) m + (b - a c) n) / (1 - c^2), c = m n; from
    the one to the other where the legs are nearly parallel.
    """
    ways = np.diff(line, axis=0) / lengths[:, None]
    normals = np.column_stack((ways[:, 1], -ways[:, 0]))
    across = np.asarray(slot.across_m, dtype=np.float64)
    beside = across[:, None] * normals
    uav = [line[0] + beside[0]]
    for i, point in enumerate(line[1:-1]):
        (m, n), (a, b) = normals[i : i + 2], across[i : i + 2]
        c = float(m @ n)
        if 1.0 - c**2 > LEAST_CROSSING:
            uav.append(point + ((a - b * c) * m + (b - a * c) * n) / (1.0 - c**2))
        else:
            uav += [point + beside[i], point + beside[i + 1]]
    uav.append(line[-1] + beside[-1])
    return np.array(uav)


def measure(
    helicopter_xy: FloatArray,
    uavs_xy: Sequence[FloatArray],
    ideal: tuple[FloatArray, ...],
    *,
    radius_m: float,
    footprint: str,
) -> Coverage:
    """Compare what all aircraft saw with what the ideal formation sweeps."""
    swept = [swath(xy, radius_m, footprint=footprint) for xy in ideal]
    claimed = shapely.union_all(swept)
    first = seen = swath(helicopter_xy, radius_m, footprint=footprint)
    twice = shapely.Polygon()
    for uav_xy in uavs_xy:
        one = swath(uav_xy, radius_m, footprint=footprint)
        twice = twice.union(seen.intersection(one))
        seen = seen.union(one)
    seen = seen.intersection(claimed)
    possible = shapely.union_all([first, *swept[1:]]).intersection(claimed)
    return Coverage(
        alone_m2=first.intersection(claimed).area,
        claimed_m2=claimed.area,
        covered_m2=seen.area,
        overlap_m2=twice.intersection(claimed).area,
        possible_m2=possible.area,
        reached_m2=seen.intersection(possible).area,
        gaps=claimed.difference(seen),
        claimed=claimed,
    )
