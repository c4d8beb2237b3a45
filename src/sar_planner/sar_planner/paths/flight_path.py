"""Plane geometry of flyable paths: straights and arcs of circle, walked exactly.

All lengths in metres, all angles in radians, counter-clockwise positive, headings measured from
the x axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose, wrap_angle

FloatArray = NDArray[np.float64]
TINY_RAD = 1e-12


@dataclass(frozen=True, slots=True)
class Straight:
    """A straight of ``length_m`` [m], not negative."""

    length_m: float

    def pose_after(self, start: Pose, distance_m: float) -> Pose:
        """Return the pose ``distance_m`` [m] along this segment begun at ``start``."""
        return start.offset(distance_m)

    def part(self, length_m: float) -> Straight:
        """Return the first ``length_m`` [m] of this straight."""
        return Straight(length_m)

    def nearest_m(self, start: Pose, x_m: float, y_m: float) -> float:
        """Return the distance along this segment at which it is nearest to a point [m]."""
        return min(max(start.along(x_m, y_m), 0.0), self.length_m)


@dataclass(frozen=True, slots=True)
class Arc:
    """An arc of ``radius_m`` [m] through ``turn_rad`` [rad]: positive turns left."""

    radius_m: float
    turn_rad: float

    @property
    def length_m(self) -> float:
        """Length [m]."""
        return self.radius_m * abs(self.turn_rad)

    @property
    def curvature(self) -> float:
        """One over the radius, positive to the left [1/m]."""
        return math.copysign(1.0 / self.radius_m, self.turn_rad)

    def centre(self, start: Pose) -> tuple[float, float]:
        """Return the centre of the circle [m] for an arc begun at ``start``."""
        left = math.copysign(self.radius_m, self.turn_rad)
        return (
            start.x_m - left * math.sin(start.heading_rad),
            start.y_m + left * math.cos(start.heading_rad),
        )

    def pose_after(self, start: Pose, distance_m: float) -> Pose:
        """Return the pose ``distance_m`` [m] along this segment begun at ``start``."""
        heading = start.heading_rad + math.copysign(distance_m / self.radius_m, self.turn_rad)
        left = math.copysign(self.radius_m, self.turn_rad)
        cx, cy = self.centre(start)
        return Pose(cx + left * math.sin(heading), cy - left * math.cos(heading), heading)

    def points(self, start: Pose, distances_m: FloatArray) -> FloatArray:
        """Return positions, shape (n, 2), at ``distances_m`` [m] from ``start``."""
        sign = math.copysign(1.0, self.turn_rad)
        headings = start.heading_rad + sign * distances_m / self.radius_m
        left = sign * self.radius_m
        cx, cy = self.centre(start)
        return np.column_stack((cx + left * np.sin(headings), cy - left * np.cos(headings)))

    def part(self, length_m: float) -> Arc:
        """Return the first ``length_m`` [m] of this arc."""
        return Arc(self.radius_m, math.copysign(length_m / self.radius_m, self.turn_rad))

    def nearest_m(self, start: Pose, x_m: float, y_m: float) -> float:
        """Return the distance along this segment at which it is nearest to a point [m]."""
        cx, cy = self.centre(start)
        begun = math.atan2(start.y_m - cy, start.x_m - cx)
        sign = math.copysign(1.0, self.turn_rad)
        swept = (sign * (math.atan2(y_m - cy, x_m - cx) - begun)) % (2.0 * math.pi)
        if swept <= abs(self.turn_rad):
            return swept * self.radius_m
        # Beyond the arc: which of its ends is nearer by angle.
        beyond = swept - abs(self.turn_rad)
        return self.length_m if beyond < 2.0 * math.pi - swept else 0.0


Segment = Straight | Arc


def places_after(
    x_m: FloatArray,
    y_m: FloatArray,
    heading_rad: FloatArray,
    curvature: FloatArray,
    distance_m: FloatArray,
) -> FloatArray:
    """Return positions, shape (..., 2) [m], after arcs of these curvatures, 0 for straights.

    Every argument has the shape (...): where each arc begins, and how far along it.
    """
    half_turn = 0.5 * curvature * distance_m
    course = heading_rad + half_turn
    half_turn[half_turn == 0.0] = TINY_RAD
    chord = distance_m * np.sin(half_turn) / half_turn
    out = np.empty((*distance_m.shape, 2))
    out[..., 0] = x_m + chord * np.cos(course)
    out[..., 1] = y_m + chord * np.sin(course)
    return out


@dataclass(frozen=True)
class FlightPath:
    """Segments flown one after another from ``start``.

    Raises ``ValueError`` when a straight is shorter than -1 mm (shorter than zero by rounding is
    dropped, as are arcs of no angle).
    """

    start: Pose
    segments: tuple[Segment, ...]

    @staticmethod
    def of(start: Pose, segments: Iterable[Segment]) -> FlightPath:
        """Build a path, dropping empty segments."""
        kept: list[Segment] = []
        for segment in segments:
            if isinstance(segment, Straight) and segment.length_m < -1e-3:
                raise ValueError(f"straight of {segment.length_m:.3f} m: expected 0 or more")
            if segment.length_m > 1e-9:
                kept.append(segment)
        return FlightPath(start, tuple(kept))

    @cached_property
    def length_m(self) -> float:
        """Total length [m]."""
        return math.fsum(segment.length_m for segment in self.segments)

    @cached_property
    def joints(self) -> tuple[Pose, ...]:
        """The poses where segments begin, and the end: ``len(segments) + 1`` of them."""
        poses = [self.start]
        for segment in self.segments:
            poses.append(segment.pose_after(poses[-1], segment.length_m))
        return tuple(poses)

    @cached_property
    def _starts_m(self) -> list[float]:
        starts = [0.0]
        for segment in self.segments:
            starts.append(starts[-1] + segment.length_m)
        return starts

    @cached_property
    def _parts(self) -> FloatArray:
        """``parts`` behind a straight that leads to the path, shape (5, n + 2)."""
        before = (*self.start, 0.0, 0.0)
        return np.column_stack((before, self.parts))

    @cached_property
    def parts(self) -> FloatArray:
        """x, y, heading, curvature and path distance where each part begins, shape (5, n + 1).

        The last part is the straight behind the path.
        """
        bends = [part.curvature if isinstance(part, Arc) else 0.0 for part in self.segments]
        rows = [
            (*pose, bend, begun)
            for pose, bend, begun in zip(self.joints, (*bends, 0.0), self._starts_m, strict=True)
        ]
        return np.array(rows, dtype=np.float64).T.copy()

    @cached_property
    def widest_m(self) -> float:
        """The largest radius of its turns [m], 0 where it has none."""
        return max((part.radius_m for part in self.segments if isinstance(part, Arc)), default=0.0)

    @cached_property
    def in_map(self) -> dict[CornerFrame, FlightPath]:
        """The same path in the map, by the frames it is taken to be of; kept by ``path_to_map``."""
        return {}

    @property
    def end(self) -> Pose:
        """The pose at the end."""
        return self.joints[-1]

    def points(self, distances_m: FloatArray | Sequence[float]) -> FloatArray:
        """Return positions, shape (n, 2) [m], at path distances; beyond the end: straight on."""
        distances = np.asarray(distances_m, dtype=np.float64)
        part = np.searchsorted(self._starts_m, distances, side="right")
        x, y, heading, curvature, begun = self._parts[:, part]
        return places_after(x, y, heading, curvature, distances - begun)

    def pose_at(self, distance_m: float) -> Pose:
        """Return the pose at a path distance [m]; beyond the ends straight on."""
        for begun, start, segment in zip(self._starts_m, self.joints, self.segments, strict=False):
            if distance_m < begun + segment.length_m:
                if distance_m < begun:
                    break
                return segment.pose_after(start, distance_m - begun)
        if distance_m < 0.0 or not self.segments:
            return self.start.offset(distance_m)
        return self.end.offset(distance_m - self.length_m)

    def cut(self, from_m: float, to_m: float = math.inf) -> FlightPath:
        """Return the part between two path distances [m], each within the path."""
        start = self.pose_at(from_m)
        kept: list[Segment] = []
        for begun, segment in zip(self._starts_m, self.segments, strict=False):
            low = max(from_m - begun, 0.0)
            high = min(to_m - begun, segment.length_m)
            if high > low:
                kept.append(segment.part(high - low))
        return FlightPath.of(start, kept)

    def then(self, other: FlightPath) -> FlightPath:
        """Return this path followed by the segments of another that begins where this one ends.

        Straights and arcs that go on in the same way become one.
        """
        merged: list[Segment] = []
        for segment in (*self.segments, *other.segments):
            last = merged[-1] if merged else None
            if isinstance(segment, Straight) and isinstance(last, Straight):
                merged[-1] = Straight(last.length_m + segment.length_m)
            elif (
                isinstance(segment, Arc)
                and isinstance(last, Arc)
                and segment.radius_m == last.radius_m
                and segment.turn_rad * last.turn_rad > 0.0
            ):
                merged[-1] = Arc(last.radius_m, last.turn_rad + segment.turn_rad)
            else:
                merged.append(segment)
        return FlightPath(self.start, tuple(merged))

    def nearest_m(self, x_m: float, y_m: float, low_m: float, high_m: float) -> float:
        """Return the path distance nearest to a point [m], between ``low_m`` and ``high_m``."""
        best, nearest = min(max(0.0, low_m), self.length_m), math.inf
        for begun, start, segment in zip(self._starts_m, self.joints, self.segments, strict=False):
            if begun > high_m or begun + segment.length_m < low_m:
                continue
            at = begun + segment.nearest_m(start, x_m, y_m)
            at = min(max(at, low_m, begun), high_m, begun + segment.length_m)
            there = segment.pose_after(start, at - begun)
            gap = math.hypot(there.x_m - x_m, there.y_m - y_m)
            if gap < nearest:
                best, nearest = at, gap
        over = self.end.along(x_m, y_m)
        if over > 0.0 and self.length_m <= high_m:
            beyond = min(over, high_m - self.length_m)
            there = self.end.offset(beyond)
            if math.hypot(there.x_m - x_m, there.y_m - y_m) < nearest:
                best = self.length_m + beyond
        return best

    def sample(self, spacing_m: float) -> FloatArray:
        """Return points, shape (n, 2) [m], no further apart than ``spacing_m``, ends included."""
        count = max(1, math.ceil(self.length_m / spacing_m))
        return self.points(np.linspace(0.0, self.length_m, count + 1))


@dataclass(frozen=True, slots=True)
class CornerFrame:
    """The frame of one corner: origin at the corner, x along the old leg, inside on y < 0.

    ``turn_side`` is +1 for a right turn (the frame is then a plain rotation) and -1 for a left
    turn (the frame is mirrored, so that the right-turn mathematics serves both).
    """

    origin: Pose
    turn_side: int

    def __post_init__(self) -> None:
        """Check the side."""
        if self.turn_side not in (1, -1):
            raise ValueError(f"turn_side {self.turn_side}: expected 1 (right) or -1 (left)")

    def to_frame(self, pose: Pose) -> Pose:
        """Return a map pose in the corner's frame."""
        return Pose(
            self.origin.along(pose.x_m, pose.y_m),
            self.turn_side * self.origin.across(pose.x_m, pose.y_m),
            wrap_angle(self.turn_side * (pose.heading_rad - self.origin.heading_rad)),
        )

    def pose_to_map(self, pose: Pose) -> Pose:
        """Return a pose of the corner's frame in the map."""
        moved = self.origin.offset(pose.x_m, self.turn_side * pose.y_m)
        heading = self.origin.heading_rad + self.turn_side * pose.heading_rad
        return Pose(moved.x_m, moved.y_m, wrap_angle(heading))

    def points_to_map(self, points: FloatArray) -> FloatArray:
        """Return points, shape (n, 2), of the corner's frame in the map."""
        c, s = math.cos(self.origin.heading_rad), math.sin(self.origin.heading_rad)
        x, y = points[:, 0], self.turn_side * points[:, 1]
        return np.column_stack((self.origin.x_m + x * c - y * s, self.origin.y_m + x * s + y * c))

    def path_from_map(self, path: FlightPath) -> FlightPath:
        """Return a path of the map in this frame (arcs mirrored for left turns)."""
        return FlightPath(self.to_frame(path.start), self._sided(path))

    def path_to_map(self, path: FlightPath) -> FlightPath:
        """Return a path of the corner's frame in the map (arcs mirrored for left turns).

        The same one again and again: where its parts lie is worked out once.
        """
        known = path.in_map.get(self)
        if known is None:
            known = FlightPath(self.pose_to_map(path.start), self._sided(path))
            path.in_map[self] = known
        return known

    def _sided(self, path: FlightPath) -> tuple[Segment, ...]:
        return tuple(
            Arc(part.radius_m, self.turn_side * part.turn_rad) if isinstance(part, Arc) else part
            for part in path.segments
        )
