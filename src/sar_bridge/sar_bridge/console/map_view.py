"""The moving map as SVG: tracks, swaths, what was left out, pattern, plans, rings. Pure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
import shapely
import shapely.ops
from shapely.geometry.base import BaseGeometry

from sar_bridge.console.snapshot import STALE_S, Snapshot, slot_words
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import FloatArray

CORNERS = 24
LINES = 6
MINUTES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0)
RING_SHARES = (0.25, 0.5, 0.75)
SIMPLER_PX, SIMPLER_M = 1.5, 5.0
SIGMAS = 2.0
NAUTICAL_MILE_M = 1852.0
SIDES = {"right": 1, "left": -1}
AIRCRAFT = "M0,-13 L8,10 L0,5 L-8,10 Z"


@dataclass(frozen=True, slots=True)
class View:
    """What part of the map is shown: ``reach_m`` [m] from the middle to the nearer edge.

    ``up_rad``: the direction, counter-clockwise from east, that is up: 90 degrees for north-up.
    """

    width_px: int = 900
    height_px: int = 640
    centre_m: tuple[float, float] = (0.0, 0.0)
    reach_m: float = 2000.0
    up_rad: float = 0.5 * math.pi

    @property
    def scale(self) -> float:
        """Pixels to a metre."""
        return 0.5 * min(self.width_px, self.height_px) / self.reach_m

    def to_px(self, points: FloatArray) -> FloatArray:
        """Return where points of the map, shape (n, 2) [m], are in the picture [px]."""
        turn = 0.5 * math.pi - self.up_rad
        across, along = (
            np.array((math.cos(turn), -math.sin(turn))),
            np.array((math.sin(turn), math.cos(turn))),
        )
        off = (points - np.array(self.centre_m)) * self.scale
        middle = np.array((0.5 * self.width_px, 0.5 * self.height_px))
        return middle + np.column_stack((off @ across, -(off @ along)))

    def to_map(self, x_px: float, y_px: float) -> tuple[float, float]:
        """Return which place of the map [m] is at a place of the picture."""
        turn = 0.5 * math.pi - self.up_rad
        x = (x_px - 0.5 * self.width_px) / self.scale
        y = (0.5 * self.height_px - y_px) / self.scale
        return (
            self.centre_m[0] + x * math.cos(turn) + y * math.sin(turn),
            self.centre_m[1] - x * math.sin(turn) + y * math.cos(turn),
        )


def place_touched(view: View, x_px: object, y_px: object) -> tuple[float, float] | None:
    """Return the place [m] at a place of the picture, as a browser tells it; None for none."""
    places = []
    for value, size_px in ((x_px, view.width_px), (y_px, view.height_px)):
        if isinstance(value, bool) or not isinstance(value, int | float):
            return None
        if not 0.0 <= value <= size_px:
            return None
        places.append(float(value))
    return view.to_map(*places)


@dataclass(frozen=True, slots=True)
class Search:
    """What each aircraft searches: ``swath_m`` wide, ``spacing_m`` apart.

    ``turn_side``: 1 where the UAV is to the right, inside a pattern of right turns; -1 left.
    """

    swath_m: float = 250.0
    spacing_m: float = 250.0
    turn_side: int = 1

    def place_m(self, slot: str) -> float:
        """Return how far right of the helicopter a slot is [m], as a planner names it; or inside.

        ``outside``, ``left 2``: two tracks to the left.
        """
        side, tracks = slot_words(slot)
        other = -self.turn_side if side == "outside" else self.turn_side
        return SIDES.get(side, other) * tracks * self.spacing_m


def left_out(
    tracks: Sequence[FloatArray], search: Search, slots: Sequence[str] = ()
) -> BaseGeometry:
    """Return what all should have seen beside the helicopter's track, and did not.

    ``tracks``: the helicopter's, and the UAVs', whose ``slots`` are as their planners name them.

    A strip from the outer edge of the helicopter's swath to that of a UAV in its place; the last
    stretch, where the UAV is still to come, is not counted.
    """
    helicopter, *uavs = tracks
    named = zip(uavs, slots or [""] * len(uavs), strict=True)
    led = [(uav, slot) for uav, slot in named if len(uav) >= 2]
    if len(helicopter) < 2 or not led:
        return shapely.Polygon()
    half = 0.5 * search.swath_m
    track = _simpler(helicopter, SIMPLER_M)
    done_m = max(track.length - 2.0 * search.spacing_m, 1.0)
    flown = shapely.ops.substring(track, 0.0, done_m)
    asked = flown.buffer(half, cap_style="flat")
    for place_m in {search.place_m(slot) for _, slot in led}:
        reach_m = place_m + math.copysign(half, place_m)
        asked = asked.union(flown.buffer(-reach_m, single_sided=True))
    looked = (helicopter, *(uav for uav, _ in led))
    seen = shapely.union_all([_simpler(one, SIMPLER_M).buffer(half) for one in looked])
    return asked.buffer(0.0).difference(seen).buffer(-5.0)


def picture(
    snapshot: Snapshot,
    view: View,
    search: Search,
    gaps: BaseGeometry | None,
    under: str = "",
    others: Sequence[Snapshot] = (),
) -> str:
    """Return the map as the inside of an SVG element.

    ``under``: what lies below it all. ``others``: of the UAVs that are not chosen.
    """
    parts = [under]
    if snapshot.datum is not None:
        parts += _graticule(snapshot.datum, view)
    parts += _areas(gaps, view)
    uavs = [*((one, "uav other") for one in others), (snapshot, "uav")]
    tracks = [("helicopter", snapshot.tracks[0]), *((name, one.tracks[1]) for one, name in uavs)]
    for name, track in tracks:
        width = search.swath_m * view.scale
        parts.append(_line(track, view, f"swath {name}", f'stroke-width="{width:.0f}"'))
    for name, track in tracks:
        parts.append(_line(track, view, f"track {name}"))
    parts.append(_pattern(snapshot, view))
    for one, _ in uavs:
        parts += _plan(one, view)
    parts += _stop(snapshot, view)
    parts += _marks([one for one, _ in uavs], view)
    parts += _helicopter(snapshot, view)
    for one, name in uavs:
        parts += _uav(one, view, name)
    return "".join(parts)


def _line(points: FloatArray, view: View, kind: str, more: str = "") -> str:
    if len(points) < 2:
        return ""
    pixels = view.to_px(points)
    simple = shapely.get_coordinates(_simpler(pixels, SIMPLER_PX))
    return f'<polyline class="{kind}" points="{_pairs(simple)}" {more}/>'


def _simpler(points: FloatArray, tolerance: float) -> BaseGeometry:
    """Return a line of fewer points, none of the others farther from it."""
    return shapely.LineString(points).simplify(tolerance, preserve_topology=False)


def _pairs(pixels: FloatArray) -> str:
    return " ".join(f"{x:.0f},{y:.0f}" for x, y in pixels)


def _areas(gaps: BaseGeometry | None, view: View) -> list[str]:
    if gaps is None or gaps.is_empty:
        return []
    polygons = [one for one in shapely.get_parts(gaps) if one.geom_type == "Polygon"]
    return [
        f'<polygon class="gap" points="{_pairs(view.to_px(outline))}"/>'
        for outline in (shapely.get_coordinates(one.exterior) for one in polygons)
    ]


def _graticule(datum: Datum, view: View) -> list[str]:
    """Return parallels and meridians at whole parts of a minute, labelled."""
    reach = view.reach_m * math.hypot(view.width_px, view.height_px) / view.height_px
    x, y = view.centre_m
    south, west, _ = datum.to_geodetic(x - reach, y - reach)
    north, east, _ = datum.to_geodetic(x + reach, y + reach)
    found: list[str] = []
    for low, high, is_latitude in ((south, north, True), (west, east, False)):
        span = 60.0 * (high - low)
        step = next((one for one in MINUTES if span / one <= LINES), MINUTES[-1]) / 60.0
        for n in range(math.ceil(low / step), math.floor(high / step) + 1):
            value = n * step
            ends = (
                ((value, west), (value, east)) if is_latitude else ((south, value), (north, value))
            )
            line = np.array([datum.to_local(*end, datum.altitude_m)[:2] for end in ends])
            (x1, y1), (x2, y2) = view.to_px(line)
            found.append(
                f'<line class="grid" x1="{x1:.0f}" y1="{y1:.0f}" x2="{x2:.0f}" y2="{y2:.0f}"/>'
            )
            place = _label_place(view, (x1, y1), (x2, y2))
            if place is not None:
                text = degrees_text(value, "NS" if is_latitude else "EW")
                found.append(_text("gridlabel", *place, text))
    return found


def _label_place(
    view: View, one: Sequence[float], other: Sequence[float]
) -> tuple[float, float] | None:
    """Return where a line enters the picture, where it does."""
    box = shapely.box(4, 14, view.width_px - 70, view.height_px - 6)
    inside = shapely.LineString((one, other)).intersection(box)
    if inside.is_empty or inside.geom_type != "LineString":
        return None
    x, y = inside.coords[0]
    return float(x), float(y)


def degrees_text(value: float, letters: str) -> str:
    """Return a latitude or longitude [deg] as degrees and decimal minutes: 37°48.50'N."""
    degrees, minutes = divmod(abs(value) * 60.0, 60.0)
    if round(minutes, 2) >= 60.0:
        degrees, minutes = degrees + 1.0, 0.0
    return f"{degrees:.0f}°{minutes:05.2f}'{letters[0 if value >= 0.0 else 1]}"


def _text(kind: str, x: float, y: float, text: str) -> str:
    return f'<text class="{kind}" x="{x:.0f}" y="{y:.0f}">{escape(text)}</text>'


def _circle(centre: tuple[float, float], radius_m: float, view: View, kind: str) -> str:
    ((x, y),) = view.to_px(np.array([centre]))
    return f'<circle class="{kind}" cx="{x:.0f}" cy="{y:.0f}" r="{radius_m * view.scale:.0f}"/>'


def _pattern(snapshot: Snapshot, view: View) -> str:
    """Return what is expected still to be flown of the pattern, from the helicopter on."""
    if snapshot.helicopter is None or len(snapshot.pattern) == 0:
        return ""
    motion = snapshot.helicopter.motion
    return _line(np.vstack(((motion.x_m, motion.y_m), snapshot.pattern)), view, "pattern")


def _plan(snapshot: Snapshot, view: View) -> list[str]:
    """Return the list being flown; an escape looks otherwise."""
    waypoints = snapshot.waypoints
    if waypoints is None or len(waypoints.points) == 0 or snapshot.uav is None:
        return []
    uav = snapshot.uav.motion
    points = np.vstack(((uav.x_m, uav.y_m), waypoints.points))
    kind = "escape" if snapshot.monitor.escaping else "plan"
    found = [_line(points, view, kind)]
    for x, y in view.to_px(waypoints.points):
        if 0 <= x <= view.width_px and 0 <= y <= view.height_px:
            found.append(f'<circle class="{kind}dot" cx="{x:.0f}" cy="{y:.0f}" r="3"/>')
    return found


def _stop(snapshot: Snapshot, view: View) -> list[str]:
    """Return where the helicopter is expected to stop, with its 95 % ellipse."""
    corner, leg = snapshot.corner, snapshot.leg
    if corner is None or (leg is not None and leg.time_s > corner.stop_time_s):
        return []
    values, vectors = np.linalg.eigh(corner.covariance)
    angles = np.linspace(0.0, 2.0 * math.pi, CORNERS, endpoint=False)
    unit = np.column_stack((np.cos(angles), np.sin(angles)))
    axes = SIGMAS * np.sqrt(np.maximum(values, 0.0))
    ellipse = (unit * axes) @ vectors.T + (corner.stop.x_m, corner.stop.y_m)
    ((x, y),) = view.to_px(np.array([(corner.stop.x_m, corner.stop.y_m)]))
    return [
        f'<polygon class="doubt" points="{_pairs(view.to_px(ellipse))}"/>',
        f'<path class="stop" d="M{x - 6:.0f},{y - 6:.0f} l12,12 m0,-12 l-12,12"/>',
    ]


def _marks(snapshots: Sequence[Snapshot], view: View) -> list[str]:
    """Return what was marked: rings with their numbers, once what several planners were told."""
    found: list[str] = []
    marks = [mark for one in snapshots for mark in one.marks]
    for mark in {(mark.number, round(mark.x_m), round(mark.y_m)): mark for mark in marks}.values():
        ((x, y),) = view.to_px(np.array([(mark.x_m, mark.y_m)]))
        found.append(f'<path class="mark" d="M{x - 9:.0f},{y:.0f} h18 m-9,-9 v18"/>')
        found.append(f'<circle class="mark" cx="{x:.0f}" cy="{y:.0f}" r="9"/>')
        found.append(_text("marklabel", x + 13, y - 6, str(mark.number)))
    return found


def _helicopter(snapshot: Snapshot, view: View) -> list[str]:
    """Return the helicopter, and rings about it: the least separation among them."""
    found: list[str] = []
    if snapshot.helicopter is not None:
        motion = snapshot.helicopter.motion
        place = motion.x_m, motion.y_m
        for share in RING_SHARES:
            radius = _round(share * view.reach_m)
            found.append(_circle(place, radius, view, "ring"))
            ((x, y),) = view.to_px(np.array([place]))
            found.append(_text("ringlabel", x + 4, y - radius * view.scale - 3, _distance(radius)))
        if snapshot.least_separation_m > 0.0:
            found.append(_circle(place, snapshot.least_separation_m, view, "least"))
        old = snapshot.helicopter_age_s > STALE_S
        found.append(_symbol(motion.pose, view, "helicopter", "H", old=old))
    return found


def _uav(snapshot: Snapshot, view: View, kind: str) -> list[str]:
    if snapshot.uav is None:
        return []
    uav = snapshot.uav
    pose = Pose(uav.motion.x_m, uav.motion.y_m, uav.yaw_rad)
    old = snapshot.uav_age_s > STALE_S
    return [_symbol(pose, view, kind, snapshot.callsign or "UAV", old=old)]


def _round(distance_m: float) -> float:
    """Return a round distance near another."""
    power = 10.0 ** math.floor(math.log10(distance_m))
    return min((1.0, 2.0, 2.5, 5.0, 10.0), key=lambda one: abs(one * power - distance_m)) * power


def _distance(distance_m: float) -> str:
    """Return a distance in metres, and beyond a kilometre in nautical miles too."""
    if distance_m < 1000.0:
        return f"{distance_m:.0f} m"
    return f"{distance_m / 1000.0:g} km / {distance_m / NAUTICAL_MILE_M:.1f} NM"


def _symbol(pose: Pose, view: View, kind: str, label: str, *, old: bool) -> str:
    ((x, y),) = view.to_px(np.array([(pose.x_m, pose.y_m)]))
    turn = math.degrees(view.up_rad - pose.heading_rad)
    return (
        f'<g class="{kind}{" old" if old else ""}" transform="translate({x:.0f},{y:.0f})">'
        f'<path d="{AIRCRAFT}" transform="rotate({turn:.0f})"/>'
        f'<text class="callsign" x="14" y="4">{escape(label)}</text></g>'
    )


def trend(times_m: FloatArray, least_m: float, width_px: int = 220, height_px: int = 60) -> str:
    """Return the separation of the last minute as a small SVG: times before now, metres."""
    if len(times_m) < 2:
        return ""
    span_s = 60.0
    most = max(float(times_m[:, 1].max()), least_m) * 1.1
    x = width_px * (1.0 - times_m[:, 0] / span_s)
    y = height_px * (1.0 - times_m[:, 1] / most)
    level = height_px * (1.0 - least_m / most)
    return (
        f'<svg viewBox="0 0 {width_px} {height_px}" class="trend" preserveAspectRatio="none">'
        f'<line class="leastline" x1="0" x2="{width_px}" y1="{level:.0f}" y2="{level:.0f}"/>'
        f'<polyline class="trendline" points="{_pairs(np.column_stack((x, y)))}"/></svg>'
    )


def centre_of(snapshot: Snapshot) -> tuple[float, float]:
    """Return the place that the map is centred on: between the aircraft, or where one is."""
    places = [
        (one.motion.x_m, one.motion.y_m)
        for one in (snapshot.helicopter, snapshot.uav)
        if one is not None
    ]
    if not places:
        return 0.0, 0.0
    x, y = np.mean(places, axis=0)
    return float(x), float(y)
