"""Flight paths as lists of waypoints for an autopilot."""

from __future__ import annotations

import math

import numpy as np

from sar_planner.paths.flight_path import Arc, FlightPath, FloatArray

# A lead-in often ends just where the list begins: which side of it must not hang on rounding.
EDGE_M = 1e-3


def arc_offsets(arc: Arc, spacing_m: float) -> tuple[int, float]:
    """Return how many chords an arc is cut into and the radius [m] its waypoints stand on.

    A polygon with its corners on the circle is flown inside it. With chords of angle D, corners at
    radius R / (1 - D^2 / 12) put the polygon's mean radius, and so a smooth flight along it, on R.
    """
    chords = max(1, math.ceil(arc.length_m / spacing_m - 1e-9))
    chord_rad = abs(arc.turn_rad) / chords
    return chords, arc.radius_m / (1.0 - chord_rad**2 / 12.0)


def path_waypoints(path: FlightPath, spacing_m: float, *, from_m: float = 0.0) -> FloatArray:
    """Return waypoints, shape (n, 2) [m], along a path.

    The ends of every segment, and points on its arcs no further apart than ``spacing_m`` (0: only
    the ends, as in the paper). Points no further from the start than ``from_m`` [m] are left out.
    """
    after_m = from_m + EDGE_M
    kept: list[FloatArray] = []
    begun = 0.0
    for start, end, segment in zip(path.joints, path.joints[1:], path.segments, strict=False):
        if isinstance(segment, Arc) and spacing_m > 0.0:
            chords, radius = arc_offsets(segment, spacing_m)
            angles = np.arange(1, chords) / chords * segment.length_m
            centre = np.array(segment.centre(start))
            inner = centre + (segment.points(start, angles) - centre) * radius / segment.radius_m
            kept += [point for point, at in zip(inner, angles, strict=True) if begun + at > after_m]
        begun += segment.length_m
        if begun > after_m:
            kept.append(np.array((end.x_m, end.y_m)))
    return np.array(kept).reshape(-1, 2)


def thinned(points: FloatArray, gap_m: float) -> FloatArray:
    """Return a list, shape (n, 2), without points closer than ``gap_m`` to the one kept before.

    An autopilot that has just passed a point takes a target close behind it for one to turn back
    to. The last point stays.
    """
    first, *others = points.tolist()
    kept = [first]
    for point in others:
        if math.dist(point, kept[-1]) >= gap_m:
            kept.append(point)
        elif point is others[-1]:
            kept[-1] = point
    return np.array(kept)
