"""A flight as other tools read it: tracks, swaths, marks and the list flown last. Pure."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import gpxpy.gpx
import numpy as np
import shapely
import simplekml
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import MissionItem, waypoint_items
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import Mark
from sar_estimator.common.states import FloatArray

COLOURS = {"helicopter": "ff003ac0", "uav": "ff9e5000"}
"""Of KML: alpha, blue, green, red."""
SIMPLER_M = 2.0
ARDUPILOT, FIXED_WING = 3, 1


@dataclass(frozen=True)
class TrackPoints:
    """Where an aircraft was at ``times_s`` since 1970, shape (n,).

    ``places_m``: x and y in the map, and altitude above mean sea level, shape (n, 3).
    """

    times_s: FloatArray
    places_m: FloatArray


@dataclass(frozen=True)
class FlightExport:
    """What is exported; ``waypoints``, shape (n, 2) [m]: of the list flown last.

    ``tracks``: by aircraft. ``swath_m``: what each sees, in width. ``altitude_m``: of waypoints,
    above home.
    """

    name: str
    datum: Datum
    tracks: dict[str, TrackPoints]
    marks: tuple[Mark, ...]
    waypoints: FloatArray
    swath_m: float
    altitude_m: float


def _geodetic(datum: Datum, places_m: FloatArray) -> FloatArray:
    """Return latitudes, longitudes [deg] and altitudes [m] of places, shape (n, 3)."""
    found = datum.all_to_geodetic(places_m[:, :2])
    return np.column_stack((found[:, :2], places_m[:, 2]))


def swath_of(flight: FlightExport, name: str) -> list[FloatArray]:
    """Return the outlines of what an aircraft saw, each of shape (n, 3): longitude, latitude, 0."""
    track = flight.tracks[name].places_m[:, :2]
    if len(track) < 2:
        return []
    seen = shapely.LineString(track).simplify(SIMPLER_M).buffer(0.5 * flight.swath_m)
    outlines = []
    for part in shapely.get_parts(seen):
        ring = shapely.get_coordinates(part.exterior)
        flat = _geodetic(flight.datum, np.column_stack((ring, np.zeros(len(ring)))))
        outlines.append(np.column_stack((flat[:, 1], flat[:, 0], np.zeros(len(ring)))))
    return outlines


def to_gpx(flight: FlightExport) -> str:
    """Return tracks, marks as waypoints, and the list as a route, as GPX 1.1 (gpxpy)."""
    gpx = gpxpy.gpx.GPX()
    gpx.name = flight.name
    for name, track in flight.tracks.items():
        segment = gpxpy.gpx.GPXTrackSegment()
        places = _geodetic(flight.datum, track.places_m).tolist()
        for (latitude, longitude, altitude), time_s in zip(
            places, track.times_s.tolist(), strict=True
        ):
            at = datetime.fromtimestamp(time_s, UTC)
            segment.points.append(gpxpy.gpx.GPXTrackPoint(latitude, longitude, altitude, at))
        gpx.tracks.append(gpxpy.gpx.GPXTrack(name))
        gpx.tracks[-1].segments.append(segment)
    for mark in flight.marks:
        latitude, longitude, _ = flight.datum.to_geodetic(mark.x_m, mark.y_m)
        at = datetime.fromtimestamp(mark.time_s, UTC)
        point = gpxpy.gpx.GPXWaypoint(latitude, longitude, time=at, name=f"mark {mark.number}")
        gpx.waypoints.append(point)
    if len(flight.waypoints):
        gpx.routes.append(gpxpy.gpx.GPXRoute("list"))
        for latitude, longitude, _ in flight.datum.all_to_geodetic(flight.waypoints).tolist():
            gpx.routes[-1].points.append(gpxpy.gpx.GPXRoutePoint(latitude, longitude))
    return str(gpx.to_xml())


def to_kml(flight: FlightExport) -> str:
    """Return tracks, swaths, marks and the list as KML 2.2 (simplekml)."""
    kml = simplekml.Kml(name=flight.name)
    for name, track in flight.tracks.items():
        places = _geodetic(flight.datum, track.places_m)
        line = kml.newlinestring(name=name, coords=places[:, [1, 0, 2]].tolist())
        line.altitudemode = simplekml.AltitudeMode.absolute
        line.style.linestyle.color, line.style.linestyle.width = COLOURS[name], 2
        for outline in swath_of(flight, name):
            area = kml.newpolygon(name=f"{name} swath", outerboundaryis=outline.tolist())
            area.style.polystyle.color = "40" + COLOURS[name][2:]
    for mark in flight.marks:
        latitude, longitude, _ = flight.datum.to_geodetic(mark.x_m, mark.y_m)
        kml.newpoint(name=f"mark {mark.number}", coords=[(longitude, latitude)])
    if len(flight.waypoints):
        places = flight.datum.all_to_geodetic(flight.waypoints)
        kml.newlinestring(name="list", coords=places[:, [1, 0]].tolist())
    return str(kml.kml())


def to_geojson(flight: FlightExport) -> str:
    """Return tracks, swaths, marks and the list as GeoJSON (RFC 7946)."""
    features = []
    for name, track in flight.tracks.items():
        places = _geodetic(flight.datum, track.places_m)
        line = {"type": "LineString", "coordinates": places[:, [1, 0, 2]].tolist()}
        features.append(_feature(line, name=name, kind="track", times_s=track.times_s.tolist()))
        features += [
            _feature(
                {"type": "Polygon", "coordinates": [outline[:, :2].tolist()]},
                name=name,
                kind="swath",
            )
            for outline in swath_of(flight, name)
        ]
    for mark in flight.marks:
        latitude, longitude, _ = flight.datum.to_geodetic(mark.x_m, mark.y_m)
        point = {"type": "Point", "coordinates": [longitude, latitude]}
        features.append(_feature(point, name=f"mark {mark.number}", kind="mark"))
    if len(flight.waypoints):
        places = flight.datum.all_to_geodetic(flight.waypoints)
        line = {"type": "LineString", "coordinates": places[:, [1, 0]].tolist()}
        features.append(_feature(line, name="list", kind="list"))
    return json.dumps({"type": "FeatureCollection", "features": features}) + "\n"


def _feature(geometry: dict[str, Any], **properties: object) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def to_plan(flight: FlightExport) -> str:
    """Return the list as a plan that QGroundControl opens.

    https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html. Raises
    ``ValueError`` where no list was flown.
    """
    if not len(flight.waypoints):
        raise ValueError("no waypoint list was flown: nothing to plan")
    items = waypoint_items(flight.waypoints, flight.datum, flight.altitude_m)[1:]
    latitude, longitude, altitude = flight.datum.to_geodetic(0.0, 0.0)
    document = {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "QGroundControl",
        "geoFence": {"circles": [], "polygons": [], "version": 2},
        "rallyPoints": {"points": [], "version": 2},
        "mission": {
            "version": 2,
            "firmwareType": ARDUPILOT,
            "vehicleType": FIXED_WING,
            "cruiseSpeed": 20,
            "hoverSpeed": 5,
            "globalPlanAltitudeMode": 1,
            "plannedHomePosition": [latitude, longitude, altitude],
            "items": [_simple(number, item) for number, item in enumerate(items, start=1)],
        },
    }
    return json.dumps(document, indent=2) + "\n"


def _simple(number: int, item: MissionItem) -> dict[str, Any]:
    params: list[float | None] = [*item.params]
    if item.command == mavlink.MAV_CMD_NAV_WAYPOINT:
        params[3] = None
    place = [item.latitude_e7 * 1e-7, item.longitude_e7 * 1e-7, item.altitude_m]
    return {
        "type": "SimpleItem",
        "autoContinue": True,
        "command": item.command,
        "doJumpId": number,
        "frame": mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
        "params": [*params, *place],
        "Altitude": item.altitude_m,
        "AltitudeMode": 1,
        "AMSLAltAboveTerrain": None,
    }


FORMATS: dict[str, Callable[[FlightExport], str]] = {
    "gpx": to_gpx,
    "kml": to_kml,
    "geojson": to_geojson,
    "plan": to_plan,
}
