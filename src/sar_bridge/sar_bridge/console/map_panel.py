"""The page's map, by NiceGUI: zoom, which way is up, and places that are touched."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from nicegui import events, ui
from shapely.geometry.base import BaseGeometry

from sar_bridge.console.map_view import (
    Search,
    View,
    centre_of,
    degrees_text,
    left_out,
    picture,
    place_touched,
)
from sar_bridge.console.snapshot import Snapshot
from sar_bridge.console.tiles import Tiles
from sar_estimator.common.geodesy import Datum

REACHES_M = (500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0)
GAPS_S = 5.0
NORTH_RAD = 0.5 * math.pi


def button(text: str, on_click: Callable[[], object] | None = None) -> ui.button:
    """Return a button of the page's looks."""
    return ui.button(text, on_click=on_click, color=None).props("flat")


class MapPanel:
    """``mark``: what a confirmed touch does with a place [m]; None where nothing can be marked.

    ``tiles``: what lies under the map, None for nothing.
    """

    def __init__(
        self, search: Search, mark: Callable[[float, float], None] | None, tiles: Tiles | None
    ) -> None:
        """Build it where the page is being built."""
        self._search, self._mark, self._tiles = search, mark, tiles
        self._view, self._reach, self._track_up = View(), 2, False
        self._snapshot, self._others = Snapshot(), tuple[Snapshot, ...]()
        self._place = 0.0, 0.0
        self._gaps: BaseGeometry | None = None
        self._gaps_s = -math.inf
        size = (self._view.width_px, self._view.height_px)
        self._map = ui.interactive_image(size=size, on_mouse=self._touch, sanitize=False)
        with ui.dialog() as self._marking, ui.card():
            self._place_text = ui.label()
            button("mark here", self._mark_here)
            button("cancel", self._marking.close)

    def build_tools(self) -> None:
        """Build its buttons."""
        button("+", lambda: self._zoom(-1))
        button("-", lambda: self._zoom(1))
        self._up = button("north up", self._turn)

    def _zoom(self, steps: int) -> None:
        self._reach = min(max(self._reach + steps, 0), len(REACHES_M) - 1)
        self.update(self._snapshot, self._others)

    def _turn(self) -> None:
        self._track_up = not self._track_up
        self._up.set_text("track up" if self._track_up else "north up")
        self.update(self._snapshot, self._others)

    def _touch(self, event: events.MouseEventArguments) -> None:
        datum: Datum | None = self._snapshot.datum
        if self._mark is None or datum is None:
            return
        place = place_touched(self._view, event.image_x, event.image_y)
        if place is None:
            return
        self._place = place
        latitude, longitude, _ = datum.to_geodetic(*self._place)
        text = f"{degrees_text(latitude, 'NS')} {degrees_text(longitude, 'EW')}"
        self._place_text.set_text(text)
        self._marking.open()

    def _mark_here(self) -> None:
        assert self._mark is not None
        self._mark(*self._place)
        self._marking.close()

    def update(self, snapshot: Snapshot, others: Sequence[Snapshot] = ()) -> None:
        """Show what is known; what was left out is worked out now and then.

        ``others``: of the UAVs that are not chosen.
        """
        self._snapshot, self._others, now = snapshot, tuple(others), time.monotonic()
        if now - self._gaps_s > GAPS_S or snapshot.is_playback:
            tracks = (*snapshot.tracks, *(one.tracks[1] for one in others))
            slots = [one.slot for one in (snapshot, *others)]
            self._gaps, self._gaps_s = left_out(tracks, self._search, slots), now
        turned = self._track_up and snapshot.leg is not None
        self._view = replace(
            self._view,
            centre_m=centre_of(snapshot),
            reach_m=REACHES_M[self._reach],
            up_rad=snapshot.leg.foot.heading_rad if turned and snapshot.leg else NORTH_RAD,
        )
        under, datum = "", snapshot.datum
        if self._tiles is not None and datum is not None:
            under = self._tiles.picture(self._view, datum)
        self._map.set_content(
            picture(snapshot, self._view, self._search, self._gaps, under, others)
        )
