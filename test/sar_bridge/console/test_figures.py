"""Large figures: always the same names, grey when they are old."""

import math
from dataclasses import replace

import pytest

from sar_bridge.console.figures import figures, wind_text
from sar_bridge.console.snapshot import Snapshot


def by_name(snapshot):
    return {figure.name: figure for figure in figures(snapshot)}


def test_they_are_told_with_units(well):
    found = {name: figure.text for name, figure in by_name(well).items()}
    assert found["apart"] == "250 m"
    assert found["UAV higher by"] == "120 m"
    assert found["lag L"] == "10 m"
    assert found["lag at corners"] == "L(1) 600  L(2) 3"
    assert found["airspeed"] == "21.0 m/s  -9 +9"
    assert found["battery"] == "24.1 V"
    assert found["rule"] == "leg"
    assert not any(figure.is_stale for figure in figures(well))


def test_what_a_corners_list_is_sure_to_keep_is_shown_while_it_is_told(well, with_node):
    assert by_name(well)["least apart, sure"].text == "–"
    at_corner = with_node(well, "planner", tube_m="187.4", tube_s="12.6")
    assert by_name(at_corner)["least apart, sure"].text == "187 m for 13 s"


def test_names_never_change(well):
    assert list(by_name(Snapshot())) == list(by_name(well))
    assert all(figure.is_stale for figure in figures(Snapshot()))


@pytest.mark.parametrize(
    ("change", "stale"),
    [
        ({"helicopter_age_s": 2.1}, {"apart", "UAV higher by"}),
        ({"uav_age_s": 2.1}, {"apart", "UAV higher by", "ground speed"}),
    ],
)
def test_what_is_older_than_two_seconds_is_grey(well, change, stale):
    found = by_name(replace(well, **change))
    assert {name for name, figure in found.items() if figure.is_stale} == stale


def test_a_silent_node_greys_what_it_tells(well, with_node):
    found = by_name(with_node(well, "bridge", age_s=4.0))
    stale = {name for name, figure in found.items() if figure.is_stale}
    assert stale == {"UAV mode", "airspeed", "wind", "battery"}


@pytest.mark.parametrize(
    ("wind", "text"),
    [
        (None, "–"),
        ((0.1, 0.2), "calm"),
        ((0.0, -5.0), "000° 5 m/s"),
        ((-5.0, 0.0), "090° 5 m/s"),
        ((3.0, 4.0), f"{math.degrees(math.atan2(-3, -4)) % 360:03.0f}° 5 m/s"),
    ],
)
def test_wind_is_told_by_where_it_comes_from(wind, text):
    assert wind_text(wind) == text


def test_the_helicopters_leg_is_shown_where_the_planner_tells_it(well, with_node):
    texts = {one.name: one.text for one in figures(with_node(well, "planner", pattern_leg=3))}
    assert texts["helicopter"] == "cruise, leg 3"
    assert {one.name: one.text for one in figures(well)}["helicopter"] == "cruise"
