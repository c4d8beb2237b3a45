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

from sar_estimator.plane import Pose, wrap_angle

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Straight:
    """A straight of ``length_m`` [m], not negative."""

    length_m: float

    def pose_after(self, start: Pose, distance_m: float) -> Pose:
        """Return the pose ``distance_m`` [m] along this segment begun at ``start``."""
        return start.offset(distance_m)

    def points(self, start: Pose, distances_m: FloatArray) -> FloatArray:
        """Return positions, shape (n, 2), at ``distances_m`` [m] from ``start``."""
        c, s = math.cos(start.heading_rad), math.sin(start.heading_rad)
        return np.column_stack((start.x_m + c * distances_m, start.y_m + s * distances_m))


@dataclass(frozen=True, slots=True)
class Arc:
    """An arc of ``radius_m`` [m] through ``turn_rad`` [rad]: positive turns left."""

    radius_m: float
    turn_rad: float

    @property
    def length_m(self) -> float:
        """Length [m]."""
        return self.radius_m * abs(self.turn_rad)

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


Segment = Straight | Arc


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
    def _starts_m(self) -> FloatArray:
        lengths = [0.0, *(segment.length_m for segment in self.segments)]
        return np.cumsum(np.asarray(lengths, dtype=np.float64))

    @property
    def end(self) -> Pose:
        """The pose at the end."""
        return self.joints[-1]

    def points(self, distances_m: FloatArray | Sequence[float]) -> FloatArray:
        """Return positions, shape (n, 2) [m], at path distances; beyond the end: straight on."""
        distances = np.asarray(distances_m, dtype=np.float64)
        out = np.empty((distances.size, 2))
        index = np.searchsorted(self._starts_m, distances, side="right") - 1
        for i, segment in enumerate(self.segments):
            chosen = index == i
            if chosen.any():
                out[chosen] = segment.points(self.joints[i], distances[chosen] - self._starts_m[i])
        beyond = index >= len(self.segments)
        if beyond.any():
            over = distances[beyond] - self._starts_m[-1]
            out[beyond] = Straight(0.0).points(self.end, over)
        before = index < 0
        if before.any():
            out[before] = Straight(0.0).points(self.start, distances[before])
        return out

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

    def path_to_map(self, path: FlightPath) -> FlightPath:
        """Return a path of the corner's frame in the map (arcs mirrored for left turns)."""
        segments = tuple(
            Arc(part.radius_m, self.turn_side * part.turn_rad) if isinstance(part, Arc) else part
            for part in path.segments
        )
        return FlightPath(self.pose_to_map(path.start), segments)
