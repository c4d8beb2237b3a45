"""Waypoints that an L1-guided autopilot (ArduPlane) flies a planned path with.

On a leg, ArduPlane's lateral guidance demands K V^2 / L1 sin(Nu), K = 4 damping^2 and
L1 = damping period V / pi, where Nu is the sum of the angle to the leg and of asin(off / L1), off
the distance from the leg (S. Park et al., AIAA-2004-4900, as in AP_L1_Control). Legs that simply
join points of an arc are so flown wide: in a steady turn of curvature k by L1^2 k / (K share),
where ``share`` is the turn rate achieved at a bank, over that of a coordinated turn: 28 m for
R = 100 m at the default period of 15 s, which makes a corner some 100 m longer.

The waypoints therefore stand on a *guide*: the path moved towards the inside of its turns by an
offset o that obeys

    L1 do/ds + o = L1^2 k(s + lead) / (K share),

which is the same law solved for the leg instead of the bank, for small angles: where a turn
begins the guide turns in at once, and settles on the smaller circle over some L1. ``lead`` is what
is flown while the roll lags.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sar_estimator.common.pose import Pose
from sar_planner.guidance.path_waypoints import EDGE_M
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.paths.flight_path import Arc, FlightPath, FloatArray

CALM = AirEnvelope()
SLOWEST_SHARE = 0.3
STEP_M = 5.0
STRAIGHT_M = 0.5
FIRST_M = 1.0
LARGEST_OFFSET = 0.4
AHEAD_M = 10.0


@dataclass(frozen=True, slots=True)
class L1Tuning:
    """An autopilot's lateral guidance: NAVL1_PERIOD [s], NAVL1_DAMPING, and the airframe's answer.

    ``turn_share``: turn rate over that of a coordinated turn at the same bank. ``roll_lag_s``: from
    a demand to the bank.
    """

    period_s: float
    damping: float = 0.75
    turn_share: float = 0.8
    roll_lag_s: float = 0.35

    def l1_m(self, ground_speed_mps: float) -> float:
        """Return the L1 distance [m]."""
        return self.damping * self.period_s * ground_speed_mps / math.pi

    def offset_m(self, curvature: float, ground_speed_mps: float) -> float:
        """Return the guide's offset [m] in a steady turn of a curvature [1/m]."""
        gain = 4.0 * self.damping**2 * self.turn_share
        return self.l1_m(ground_speed_mps) ** 2 * curvature / gain

    def longest_period_s(self, radius_m: float, ground_speed_mps: float) -> float:
        """Return the period with which a turn of ``radius_m`` can still be led.

        The guide's circle is then 0.6 R: on much smaller ones the UAV turns away before a waypoint.
        """
        circle_s = 2.0 * math.pi * radius_m / ground_speed_mps
        return circle_s * math.sqrt(LARGEST_OFFSET * self.turn_share)


@dataclass(frozen=True)
class Guide:
    """A guide along a path: offsets to the left [m], shape (n,), at stations [m], shape (n,)."""

    path: FlightPath
    stations_m: FloatArray
    offsets_m: FloatArray
    lead_m: float

    def offset_at(self, station_m: float) -> float:
        """Return the offset to the left [m] at a distance along the path."""
        return float(np.interp(station_m, self.stations_m, self.offsets_m))

    def place_at(self, station_m: float) -> Pose:
        """Return where the guide is abeam of a distance along the path [m], and the course."""
        return self.path.pose_at(station_m).offset(0.0, self.offset_at(station_m))

    def waypoints(self, spacing_m: float, *, from_m: float = 0.0) -> FloatArray:
        """Return waypoints, shape (n, 2) [m], no further apart than ``spacing_m`` where it bends.

        Points no further from the start than ``from_m`` [m] are left out.
        """
        ends, headings = _joints(self.path)
        marks = [0.0, *(end - self.lead_m for end in ends[1:-1] if end > self.lead_m), ends[-1]]
        bent = self.stations_m[np.abs(self.offsets_m) > STRAIGHT_M]
        chosen: list[float] = []
        for begin, end in pairwise(marks):
            inside = bent[(bent > begin - STEP_M) & (bent < end)]
            until = min(float(inside[-1]) + STEP_M, end) if inside.size else begin
            count = math.ceil((until - begin) / spacing_m - 1e-9)
            chosen += [begin + (until - begin) * (i + 1) / count for i in range(count)]
            if until < end:
                chosen.append(end)
        stations = np.array([at for at in chosen if at > max(from_m + EDGE_M, FIRST_M)])
        if len(stations) == 0:
            stations = np.array([self.path.length_m])
        offsets = np.interp(stations, self.stations_m, self.offsets_m)
        courses = np.interp(stations, ends, headings)
        left = np.column_stack((-np.sin(courses), np.cos(courses)))
        points: FloatArray = self.path.points(stations) + offsets[:, None] * left
        return points[self._in_order(points, from_m)]

    def _in_order(self, points: FloatArray, from_m: float) -> list[int]:
        """Return which waypoints, shape (n, 2), a UAV on the path never has to turn back for.

        A leg ends when the line across it through its target is passed. Where the guide bends to
        the outside of the next leg, that one's line may lie behind by then: its target is left out.
        """
        begin = self.place_at(from_m)
        last_x, last_y = begin.x_m, begin.y_m
        stations = np.arange(from_m, self.path.length_m + STEP_M, STEP_M)
        way = self.path.points(stations).tolist()
        kept: list[int] = []
        at = 0
        for i, (x, y) in enumerate(points.tolist()):
            leg_x, leg_y = x - last_x, y - last_y
            least = AHEAD_M * max(math.hypot(leg_x, leg_y), 1e-6)
            ahead = (x - way[at][0]) * leg_x + (y - way[at][1]) * leg_y
            if ahead < least and i + 1 < len(points):
                continue
            kept.append(i)
            while ahead > 0.0 and at + 1 < len(way):
                at += 1
                ahead = (x - way[at][0]) * leg_x + (y - way[at][1]) * leg_y
            last_x, last_y = x, y
        return kept


def _joints(path: FlightPath) -> tuple[FloatArray, FloatArray]:
    """Return distances [m] and headings [rad] where a path's segments join, shape (n + 1,).

    The headings run on beyond half a turn: between joints they change linearly.
    """
    lengths = [segment.length_m for segment in path.segments]
    turns = [part.turn_rad if isinstance(part, Arc) else 0.0 for part in path.segments]
    ends = np.concatenate(([0.0], np.cumsum(lengths)))
    return ends, path.start.heading_rad + np.concatenate(([0.0], np.cumsum(turns)))


def make_guide(
    path: FlightPath,
    tuning: L1Tuning,
    ground_speed_mps: float,
    *,
    air: AirEnvelope = CALM,
    offset_m: float | None = None,
) -> Guide:
    """Return the guide of a path flown at a ground speed, or what of it the wind leaves.

    ``offset_m``: the guide's offset at the start, where the UAV is on one already; by default that
    of a steady flight on the path's first segment.
    """
    ends, headings = _joints(path)
    lead_m = tuning.roll_lag_s * ground_speed_mps
    count = max(1, math.ceil(path.length_m / STEP_M))
    stations = np.linspace(0.0, path.length_m, count + 1)
    speeds = air.ground_speeds_mps(np.interp(stations, ends, headings), ground_speed_mps)
    speeds = np.maximum(speeds, SLOWEST_SHARE * ground_speed_mps)
    lengths = np.maximum(np.diff(ends), 1e-9)
    curvatures = np.append(np.diff(headings) / lengths, 0.0)
    segments = np.searchsorted(ends[1:], stations + lead_m, side="right")
    steady = (tuning.offset_m(1.0, 1.0) * speeds**2 * curvatures[segments]).tolist()
    kept = np.exp(-stations[1] / (tuning.l1_m(1.0) * speeds)).tolist()
    value = steady[0] if offset_m is None else offset_m
    offsets = []
    for target, share in zip(steady, kept, strict=True):
        offsets.append(value)
        value = target + (value - target) * share
    return Guide(path, stations, np.array(offsets), lead_m)
