"""Map tiles: where they are, how large, and which are there."""

import math
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.console.map_view import View
from sar_bridge.console.tiles import (
    MOST_TILES,
    TILE_PX,
    Tiles,
    level_for,
    levels_of,
    placed,
    tiles_in,
    to_degrees,
    to_tile,
)
from sar_estimator.common.geodesy import Datum

DATUM = Datum(37.8, -122.8)


@given(st.floats(-85.0, 85.0), st.floats(-179.9, 179.9), st.integers(0, 19))
def test_a_tile_leads_back_to_its_place(latitude, longitude, level):
    there = to_degrees(*to_tile(latitude, longitude, level), level)
    assert there == pytest.approx((latitude, longitude), abs=1e-9)


def test_known_tiles():
    """As the OpenStreetMap wiki has it (Slippy map tilenames)."""
    x, y = to_tile(51.51202, 0.02435, 17)
    assert (int(x), int(y)) == (65544, 43582)
    assert to_degrees(0.0, 0.0, 0) == pytest.approx((85.0511, -180.0), abs=1e-4)


@pytest.mark.parametrize("reach_m", [500.0, 2000.0, 16000.0])
def test_the_level_is_the_one_whose_pixels_are_the_views(reach_m):
    view = View(reach_m=reach_m)
    level = level_for(view, 37.8, range(20))
    corners = [DATUM.to_local(*to_degrees(x, y, level))[:2] for x, y in ((0, 0), (1, 0))]
    ours = to_tile(37.8, -122.8, level)
    corners = [
        DATUM.to_local(*to_degrees(int(ours[0]) + x, int(ours[1]), level))[:2] for x in (0, 1)
    ]
    shown_px = math.dist(*corners) * view.scale
    assert TILE_PX / 1.5 < shown_px < TILE_PX * 1.5
    assert level_for(view, 37.8, [3]) == 3
    assert level_for(view, 37.8, []) is None


@given(st.floats(-7.0, 7.0), st.floats(-5e3, 5e3), st.floats(-5e3, 5e3))
def test_every_place_of_the_view_is_on_a_tile_and_where_the_tile_has_it(up, x_m, y_m):
    view = View(centre_m=(x_m, y_m), up_rad=up)
    level = level_for(view, 37.8, range(20))
    tiles = tiles_in(view, DATUM, level)
    for x_px, y_px in ((0.0, 0.0), (450.0, 320.0), (899.0, 639.0)):
        latitude, longitude, _ = DATUM.to_geodetic(*view.to_map(x_px, y_px))
        x, y = to_tile(latitude, longitude, level)
        assert (int(x), int(y)) in tiles
        text = placed(view, DATUM, level, int(x), int(y))
        a, b, c, d, e, f = map(float, text.removeprefix("matrix(").removesuffix(")").split())
        inside = TILE_PX * np.array((x - int(x), y - int(y)))
        at = np.array(((a, c), (b, d))) @ inside + (e, f)
        assert at == pytest.approx((x_px, y_px), abs=0.5)


def test_too_many_tiles_are_none():
    assert tiles_in(View(reach_m=16000.0), DATUM, 19) == []
    assert 0 < len(tiles_in(View(), DATUM, 14)) <= MOST_TILES


@pytest.fixture
def folder(tmp_path):
    view = View()
    level = level_for(view, 37.8, range(20))
    for i, (x, y) in enumerate(tiles_in(view, DATUM, level)[:3]):
        column = tmp_path / str(level) / str(x)
        column.mkdir(parents=True, exist_ok=True)
        (column / f"{y}{('.png', '.jpg', '.webp')[i]}").write_bytes(b"")
    (tmp_path / "attribution.txt").write_text("NOAA <charts>\n", encoding="utf-8")
    return tmp_path


def test_those_that_are_there_are_drawn_with_who_made_them(folder):
    root = ET.fromstring(f"<svg>{Tiles(folder).picture(View(), DATUM)}</svg>")
    images = [item.get("href") for item in root.iter("image")]
    assert [one.rpartition(".")[2] for one in images] == ["png", "jpg", "webp"]
    assert all(one.startswith("/tiles/") for one in images)
    assert root.find("text").text == "NOAA <charts>"
    nowhere = Datum(-33.0, 151.0)
    assert Tiles(folder).picture(View(), nowhere) == ""


def test_a_folder_without_tiles_is_refused(tmp_path):
    for wrong in (tmp_path, tmp_path / "missing"):
        with pytest.raises(ValueError, match=r"expected a folder with map tiles, Z/X/Y.png"):
            levels_of(wrong)
