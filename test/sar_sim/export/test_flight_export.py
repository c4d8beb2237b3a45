"""Exports, read back by libraries that nobody here wrote."""

import asyncio
import json
import math
import subprocess
import threading
import time
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import gpxpy
import mavsdk
import numpy as np
import pytest
import shapely
from lxml import etree
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.link import Link
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import Mark
from sar_sim.export.flight_export import (
    FlightExport,
    TrackPoints,
    to_geojson,
    to_gpx,
    to_kml,
    to_plan,
)
from sar_sim.launch.launch_cli import free_port

DATUM = Datum(37.8, -122.8)
BEGUN_S = datetime(2026, 11, 28, 12, tzinfo=UTC).timestamp()
pytestmark = pytest.mark.timeout(90)
KML = "{http://www.opengis.net/kml/2.2}"


@pytest.fixture
def flight():
    times = BEGUN_S + np.arange(0.0, 100.0)
    helicopter = np.column_stack((20.0 * np.arange(100), np.zeros(100), np.full(100, 30.0)))
    uav = helicopter + np.array([0.0, -250.0, 120.0])
    return FlightExport(
        "run",
        DATUM,
        {"helicopter": TrackPoints(times, helicopter), "uav": TrackPoints(times, uav)},
        (Mark(1, BEGUN_S + 40.0, 700.0, 300.0),),
        np.array([[2100.0, -250.0], [3000.0, -250.0], [4000.0, -300.0]]),
        250.0,
        150.0,
    )


def here(latitude, longitude, x_m, y_m):
    east, north, _ = DATUM.to_local(latitude, longitude, 0.0)
    return math.hypot(east - x_m, north - y_m)


def test_gpxpy_reads_tracks_marks_and_the_list(flight):
    found = gpxpy.parse(to_gpx(flight))
    assert [track.name for track in found.tracks] == ["helicopter", "uav"]
    points = found.tracks[1].segments[0].points
    assert len(points) == 100
    assert here(points[50].latitude, points[50].longitude, 1000.0, -250.0) < 0.1
    assert points[50].elevation == pytest.approx(150.0, abs=0.3)
    assert points[50].time.timestamp() == pytest.approx(BEGUN_S + 50.0)
    assert found.waypoints[0].name == "mark 1"
    assert here(found.waypoints[0].latitude, found.waypoints[0].longitude, 700.0, 300.0) < 0.1
    assert len(found.routes[0].points) == 3


def test_an_xml_parser_reads_the_kml(flight):
    root = etree.fromstring(to_kml(flight).encode())
    names = [item.text for item in root.iter(f"{KML}name")]
    assert {"helicopter", "uav", "helicopter swath", "uav swath", "mark 1", "list"} <= set(names)
    line = next(root.iter(f"{KML}LineString")).find(f"{KML}coordinates").text.split()
    longitude, latitude, altitude = map(float, line[50].split(","))
    assert here(latitude, longitude, 1000.0, 0.0) < 0.1
    assert altitude == pytest.approx(30.0, abs=0.3)


def test_shapely_reads_the_geojson(flight):
    features = json.loads(to_geojson(flight))["features"]
    kinds = [feature["properties"]["kind"] for feature in features]
    assert sorted(kinds) == ["list", "mark", "swath", "swath", "track", "track"]
    shapes = [shapely.geometry.shape(feature["geometry"]) for feature in features]
    assert all(shape.is_valid for shape in shapes)
    swath = shapes[kinds.index("swath")]
    x, y = swath.centroid.x, swath.centroid.y
    assert here(y, x, 990.0, 0.0) < 5.0


def test_the_plan_has_the_shape_that_qgroundcontrol_reads(flight):
    plan = json.loads(to_plan(flight))
    assert (plan["fileType"], plan["version"]) == ("Plan", 1)
    assert {"geoFence", "rallyPoints", "mission"} <= plan.keys()
    mission = plan["mission"]
    assert (mission["firmwareType"], mission["vehicleType"]) == (3, 1)
    items = mission["items"]
    assert [item["command"] for item in items] == [16, 16, 16, 17]
    assert [item["doJumpId"] for item in items] == [1, 2, 3, 4]
    assert all(len(item["params"]) == 7 for item in items)
    assert here(*items[1]["params"][4:6], 3000.0, -250.0) < 0.1
    assert items[1]["params"][6] == 150.0


def test_mavsdk_imports_the_plan(flight, tmp_path):
    file = tmp_path / "flight.plan"
    file.write_text(to_plan(flight), encoding="utf-8")
    port, own = free_port(), free_port()
    program = Path(mavsdk.__file__).parent / "bin" / "mavsdk_server"
    server = subprocess.Popen(
        [str(program), "-p", str(own), f"udpin://127.0.0.1:{port}"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    beat = mavlink.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3)
    link = Link(f"udpout:127.0.0.1:{port}", system=1, component=1)
    running = threading.Event()
    running.set()

    def speak():
        while running.is_set():
            link.send([beat])
            time.sleep(0.1)

    async def read():
        system = mavsdk.System(mavsdk_server_address="127.0.0.1", port=own)
        await asyncio.wait_for(system.connect(), 30.0)
        return await asyncio.wait_for(
            system.mission_raw.import_qgroundcontrol_mission(str(file)), 30.0
        )

    speaker = threading.Thread(target=speak)
    speaker.start()
    try:
        found = asyncio.run(read())
    finally:
        running.clear()
        speaker.join()
        server.kill()
        server.wait()
        link.close()
    commands = [item.command for item in found.mission_items]
    assert commands[-4:] == [16, 16, 16, 17]
    second = found.mission_items[-3]
    assert here(second.x * 1e-7, second.y * 1e-7, 3000.0, -250.0) < 0.1
    assert second.z == 150.0


def test_without_a_list_there_is_no_plan(flight):
    with pytest.raises(ValueError, match="no waypoint list was flown"):
        to_plan(replace(flight, waypoints=np.empty((0, 2))))
