"""What the planner shows in RViz and Foxglove: tracks, list, the pattern ahead, the active rule."""

from __future__ import annotations

import math
from typing import Any

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from sar_estimator.common.conversions import FRAME, to_stamp
from sar_estimator.common.states import FloatArray, Motion

TRACK_M = 20.0
STRETCH = 50
KEPT_STRETCHES = 40
COLOURS = {
    "helicopter": (0.85, 0.35, 0.0, 1.0),
    "uav": (0.0, 0.35, 0.7, 1.0),
    "plan": (0.0, 0.6, 0.5, 1.0),
    "pattern": (0.6, 0.6, 0.6, 0.7),
    "rule": (1.0, 1.0, 1.0, 1.0),
}
WIDTH_M, PATTERN_WIDTH_M = 4.0, 1.5


class TrackMarker:
    """A track as stretches, each a marker of its own: what has been flown is not sent again.

    The newest stretch is sent as it grows; a stretch that is full, once more and then never; after
    ``KEPT_STRETCHES`` the oldest one's number is used again.
    """

    def __init__(self, name: str) -> None:
        """Begin without a point."""
        self._name = name
        self._points: list[Point] = []
        self._number = 0
        self._told = 0

    def add(self, motion: Motion | None) -> None:
        """Append a position once it is ``TRACK_M`` on."""
        if motion is None:
            return
        points = self._points
        if points and math.hypot(motion.x_m - points[-1].x, motion.y_m - points[-1].y) < TRACK_M:
            return
        if len(points) > STRETCH:
            self._points = points = points[-1:]
            self._number = (self._number + 1) % KEPT_STRETCHES
            self._told = 0
        points.append(Point(x=motion.x_m, y=motion.y_m))

    def news(self, time_s: float) -> list[Marker]:
        """Return the newest stretch where it has grown since it was told."""
        if len(self._points) == self._told:
            return []
        self._told = len(self._points)
        return [_marker(self._number, self._name, Marker.LINE_STRIP, time_s, points=self._points)]


class Markers:
    """Everything that is shown."""

    def __init__(self) -> None:
        """Show nothing yet."""
        self._tracks = {name: TrackMarker(name) for name in ("helicopter", "uav")}
        self._lines: dict[str, Any] = {}

    def message(
        self,
        time_s: float,
        *,
        helicopter: Motion | None,
        uav: Motion | None,
        plan: FloatArray | None,
        pattern: FloatArray,
        text: str,
    ) -> MarkerArray:
        """Return what has changed: tracks that grew, lines that are new, the rule.

        ``plan``: the list, ``pattern``: the corners ahead, each of shape (n, 2) [m].
        """
        markers: list[Marker] = []
        for name, motion in (("helicopter", helicopter), ("uav", uav)):
            self._tracks[name].add(motion)
            markers += self._tracks[name].news(time_s)
        for name, line in (("plan", plan), ("pattern", pattern)):
            if line is not self._lines.get(name):
                self._lines[name] = line
                points = [Point(x=x, y=y) for x, y in (() if line is None else line.tolist())]
                markers.append(_marker(0, name, Marker.LINE_STRIP, time_s, points=points))
        rule = _marker(0, "rule", Marker.TEXT_VIEW_FACING, time_s, points=[])
        rule.scale.z = 40.0
        rule.text = text
        if uav is not None:
            rule.pose.position.x, rule.pose.position.y = uav.x_m, uav.y_m
        return MarkerArray(markers=[*markers, rule])


def _marker(number: int, name: str, kind: int, time_s: float, *, points: list[Point]) -> Marker:
    marker = Marker(ns=name, id=number, type=kind, action=Marker.ADD, points=points)
    marker.header.frame_id = FRAME
    marker.header.stamp = to_stamp(time_s)
    marker.pose.orientation.w = 1.0
    marker.scale.x = PATTERN_WIDTH_M if name == "pattern" else WIDTH_M
    r, g, b, a = COLOURS[name]
    marker.color = ColorRGBA(r=r, g=g, b=b, a=a)
    return marker
