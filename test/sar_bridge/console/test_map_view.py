"""The map: places and pixels, what was left out, and everything that is drawn."""

import math
import re
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.console.map_view import (
    Search,
    View,
    centre_of,
    degrees_text,
    left_out,
    picture,
    trend,
)
from sar_bridge.console.snapshot import Snapshot
from sar_estimator.common.reports import MonitorReport

PLACES = st.floats(-1e5, 1e5)


def drawn(snapshot, view=None, gaps=None):
    view = view or View(centre_m=centre_of(snapshot))
    text = picture(snapshot, view, Search(), gaps)
    return ET.fromstring(f"<svg>{text}</svg>")


def kinds(root):
    return {item.get("class") for item in root.iter() if item.get("class")}


@given(x=PLACES, y=PLACES, up=st.floats(-7.0, 7.0), reach=st.floats(100.0, 1e5))
def test_a_pixel_leads_back_to_its_place(x, y, up, reach):
    view = View(centre_m=(12.0, -7.0), reach_m=reach, up_rad=up)
    ((px, py),) = view.to_px(np.array([[x, y]]))
    assert view.to_map(px, py) == pytest.approx((x, y), abs=1e-6 * max(abs(x), abs(y), reach))


def test_north_or_the_track_is_up():
    north = View().to_px(np.array([[0.0, 1000.0]]))[0]
    assert north == pytest.approx((450.0, 160.0))
    east_up = View(up_rad=0.0).to_px(np.array([[1000.0, 0.0]]))[0]
    assert east_up == pytest.approx((450.0, 160.0))


def test_everything_is_drawn(well, corner):
    snapshot = replace(well, corner=corner)
    root = drawn(snapshot)
    assert {"swath helicopter", "swath uav", "track helicopter", "track uav"} <= kinds(root)
    assert {
        "pattern",
        "plan",
        "plandot",
        "doubt",
        "stop",
        "ring",
        "least",
        "grid",
        "gridlabel",
        "mark",
    } <= kinds(root)
    labels = [item.text for item in root.iter("text")]
    assert "H" in labels
    assert "UAV" in labels
    assert any(text.startswith("122°4") for text in labels)


def test_an_escape_looks_otherwise(well):
    root = drawn(replace(well, monitor=MonitorReport("escape")))
    assert "escape" in kinds(root)
    assert "plan" not in kinds(root)


def test_an_aircraft_whose_position_is_old_is_pale(well):
    assert {"helicopter", "uav"} <= kinds(drawn(well))
    assert "uav old" in kinds(drawn(replace(well, uav_age_s=2.5)))
    assert "helicopter old" in kinds(drawn(replace(well, helicopter_age_s=2.5)))


def test_nothing_known_is_an_empty_map():
    assert len(drawn(Snapshot())) == 0


def test_where_both_were_nothing_is_left_out(well):
    helicopter, uav = well.tracks
    assert left_out(well.tracks, Search()).area < 1000.0
    gone = uav[(uav[:, 0] < 1000.0) | (uav[:, 0] > 1600.0)]
    aside = np.vstack((gone[gone[:, 0] < 1000.0], [[1300.0, -900.0]], gone[gone[:, 0] > 1600.0]))
    gaps = left_out((helicopter, aside), Search())
    assert gaps.area > 50_000.0
    assert gaps.bounds[1] > -380.0
    assert gaps.bounds[3] < -100.0
    assert "gap" in kinds(drawn(well, gaps=gaps))


def test_on_the_other_side_the_strip_is_there(well):
    helicopter, uav = well.tracks
    left = uav + np.array([0.0, 500.0])
    assert left_out((helicopter, left), Search(turn_side=-1)).area < 1000.0
    assert left_out((helicopter, left), Search(turn_side=1)).area > 100_000.0


def test_the_strips_of_all_slots_are_looked_for(well):
    helicopter, right = well.tracks
    left = right + np.array([0.0, 500.0])
    both = (helicopter, right, left)
    assert left_out(both, Search(), ("right", "left")).area < 1000.0
    assert left_out(both, Search(), ("inside", "outside")).area < 1000.0
    assert left_out(both, Search(), ("right", "left 2")).area > 100_000.0
    assert left_out((helicopter, right, left[:1]), Search(), ("right", "left")).area < 1000.0


@pytest.mark.parametrize(
    ("slot", "place_m"),
    [
        ("", -250.0),
        ("inside", -250.0),
        ("outside", 250.0),
        ("right", 250.0),
        ("left 2", -500.0),
        ("outside 3", 750.0),
        ("left x", -250.0),
    ],
)
def test_a_slot_is_where_its_planner_says(slot, place_m):
    assert Search(turn_side=-1).place_m(slot) == place_m


def test_all_uavs_are_drawn_by_name(well):
    one, two = replace(well, callsign="uav1"), replace(well, callsign="<2>")
    text = picture(one, View(centre_m=centre_of(one)), Search(), None, others=[two])
    root = ET.fromstring(f"<svg>{text}</svg>")
    assert {"track uav", "track uav other", "uav", "uav other"} <= kinds(root)
    labels = [item.text for item in root.iter("text")]
    assert {"H", "uav1", "<2>"} <= set(labels)
    assert labels.count("1") == 1  # what both were told is marked once
    assert len([item for item in root.iter() if item.get("class") == "plan"]) == 2


def test_a_long_flight_stays_a_short_text(well):
    turns = np.linspace(0.0, 60.0, 20_000)
    square = np.column_stack((3000.0 * np.sign(np.sin(turns)), 3000.0 * np.sign(np.cos(turns))))
    text = picture(replace(well, tracks=(square, square)), View(), Search(), None)
    assert len(text) < 60_000
    assert not re.search("nan|inf", text)


@pytest.mark.parametrize(
    ("value", "letters", "text"),
    [
        (37.8, "NS", "37°48.00'N"),
        (-122.5083333333, "EW", "122°30.50'W"),
        (-0.01, "NS", "0°00.60'S"),
        (11.99999999, "NS", "12°00.00'N"),
    ],
)
def test_degrees_and_minutes(value, letters, text):
    assert degrees_text(value, letters) == text


def test_the_trend_has_the_least_separation_as_a_line(well):
    root = ET.fromstring(trend(well.trend, 200.0))
    (line,) = root.findall("line")
    points = root.find("polyline").get("points").split()
    assert float(line.get("y1")) > float(points[0].split(",")[1])
    assert trend(np.empty((0, 2)), 200.0) == ""


def test_the_middle_is_between_the_aircraft(well):
    assert centre_of(well) == pytest.approx((2995.0, -125.0))
    assert centre_of(replace(well, uav=None)) == pytest.approx((3000.0, 0.0))
    assert centre_of(Snapshot()) == (0.0, 0.0)
    assert math.isfinite(View().scale)


def test_the_pattern_leads_on_from_the_helicopter(well):
    view = View(centre_m=centre_of(well))
    (line,) = [one for one in drawn(well, view).iter() if one.get("class") == "pattern"]
    points = [tuple(map(float, pair.split(","))) for pair in line.get("points").split()]
    wanted = view.to_px(np.vstack(((3000.0, 0.0), well.pattern)))
    assert points[0] == pytest.approx(wanted[0], abs=0.5)
    assert points[-1] == pytest.approx(wanted[-1], abs=0.5)
    for less in (replace(well, pattern=well.pattern[:0]), replace(well, helicopter=None)):
        assert "pattern" not in kinds(drawn(less))
