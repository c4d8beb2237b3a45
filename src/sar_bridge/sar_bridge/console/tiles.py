"""Map tiles from a local folder: DIR/Z/X/Y.png, as web maps have them (XYZ, Web Mercator)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache
from html import escape
from pathlib import Path

import numpy as np

from sar_bridge.console.map_view import View
from sar_estimator.common.geodesy import Datum

URL = "/tiles"
TILE_PX = 256
SEAM_PX = 0.5
"""By how much a tile is drawn larger, lest gaps show between turned ones."""
EQUATOR_M = 40_075_016.686
MOST_TILES = 80
FARTHEST_DEG = 85.05
KINDS = (".png", ".jpg", ".jpeg", ".webp")
ATTRIBUTION = "attribution.txt"
MOST_KEPT = 4096


def to_tile(latitude_deg: float, longitude_deg: float, level: int) -> tuple[float, float]:
    """Return a place in tiles of a level, from the north-west: Web Mercator (EPSG:3857)."""
    latitude = math.radians(min(max(latitude_deg, -FARTHEST_DEG), FARTHEST_DEG))
    count = 2.0**level
    y = 0.5 * (1.0 - math.asinh(math.tan(latitude)) / math.pi)
    return count * (longitude_deg + 180.0) / 360.0, count * y


def to_degrees(x: float, y: float, level: int) -> tuple[float, float]:
    """Return latitude and longitude [deg] of a place in tiles of a level."""
    count = 2.0**level
    latitude = math.atan(math.sinh(math.pi * (1.0 - 2.0 * y / count)))
    return math.degrees(latitude), 360.0 * x / count - 180.0


def level_for(view: View, latitude_deg: float, levels: Iterable[int]) -> int | None:
    """Return the level whose pixels are most like the view's; None where there is none."""
    parallel_m = EQUATOR_M * math.cos(math.radians(latitude_deg))
    wanted = math.log2(max(parallel_m * view.scale / TILE_PX, 1.0))
    return min(levels, key=lambda level: (abs(level - wanted), level), default=None)


def tiles_in(view: View, datum: Datum, level: int) -> list[tuple[int, int]]:
    """Return the tiles of a level that a view shows, x and y; none where they are too many."""
    corners = [(x, y) for x in (0.0, view.width_px) for y in (0.0, view.height_px)]
    places = [datum.to_geodetic(*view.to_map(x, y)) for x, y in corners]
    found = np.array([to_tile(latitude, longitude, level) for latitude, longitude, _ in places])
    (west, north), (east, south) = (
        np.floor(found.min(axis=0)).astype(int).tolist(),
        np.floor(found.max(axis=0)).astype(int).tolist(),
    )
    if (east - west + 1) * (south - north + 1) > MOST_TILES:
        return []
    count = 2**level
    rows = range(max(north, 0), min(south, count - 1) + 1)
    return [(x % count, y) for y in rows for x in range(west, east + 1)]


def placed(view: View, datum: Datum, level: int, x: int, y: int) -> str:
    """Return the SVG transform that puts a tile to its place in a view."""
    corners = [to_degrees(*corner, level) for corner in ((x, y), (x + 1, y), (x, y + 1))]
    local = np.array([datum.to_local(*corner)[:2] for corner in corners])
    origin, right, down = view.to_px(local)
    a, b = ((right - origin) / TILE_PX).tolist()
    c, d = ((down - origin) / TILE_PX).tolist()
    e, f = origin.tolist()
    return f"matrix({a:.5f} {b:.5f} {c:.5f} {d:.5f} {e:.2f} {f:.2f})"


def levels_of(folder: Path) -> list[int]:
    """Return the levels that a folder of tiles has. Raises ``ValueError`` for one without."""
    names = [one.name for one in folder.iterdir()] if folder.is_dir() else []
    levels = sorted(int(name) for name in names if name.isdecimal())
    if not levels:
        raise ValueError(f"tiles {folder}: expected a folder with map tiles, Z/X/Y.png")
    return levels


class Tiles:
    """The tiles of a folder. Raises ``ValueError`` for one that is none.

    ``folder``: where they are. ``attribution``: who made them, from attribution.txt beside them.
    """

    def __init__(self, folder: Path) -> None:
        """See which levels there are."""
        self.folder, self._levels = folder, levels_of(folder)
        text = folder / ATTRIBUTION
        self.attribution = text.read_text(encoding="utf-8").strip() if text.is_file() else ""
        self._find = lru_cache(MOST_KEPT)(self._look)

    def _look(self, level: int, x: int, y: int) -> str:
        """Return where the page finds a tile, empty where there is none."""
        for kind in KINDS:
            if (self.folder / str(level) / str(x) / f"{y}{kind}").is_file():
                return f"{URL}/{level}/{x}/{y}{kind}"
        return ""

    def picture(self, view: View, datum: Datum) -> str:
        """Return what lies under the map as the inside of an SVG element."""
        level = level_for(view, datum.latitude_deg, self._levels)
        if level is None:
            return ""
        size = TILE_PX + SEAM_PX
        parts = []
        for x, y in tiles_in(view, datum, level):
            address = self._find(level, x, y)
            if address:
                parts.append(
                    f'<image class="tile" href="{address}" width="{size}" height="{size}" '
                    f'decoding="sync" transform="{placed(view, datum, level, x, y)}"/>'
                )
        if parts and self.attribution:
            parts.append(
                f'<text class="attribution" x="{view.width_px - 8}" y="{view.height_px - 8}" '
                f'text-anchor="end">{escape(self.attribution)}</text>'
            )
        return "".join(parts)
