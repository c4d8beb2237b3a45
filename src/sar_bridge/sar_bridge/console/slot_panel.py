"""The page's dialog, by NiceGUI, by which a UAV is given another slot."""

from __future__ import annotations

from collections.abc import Callable

from nicegui import ui

from sar_bridge.console.figures import NONE
from sar_bridge.console.map_panel import button
from sar_bridge.console.snapshot import Snapshot, slot_words
from sar_bridge.services import SIDES, TRACKS


class SlotPanel:
    """Shows a UAV's slot, lets another one be chosen, and asks for it once that is confirmed.

    ``give``: what asks, with side, tracks and the UAV's name.
    """

    def __init__(self, give: Callable[[str, int, str], None]) -> None:
        """Build it where the page is being built."""
        self._give = give
        self._uav = ""
        with ui.dialog() as self._dialog, ui.card().classes("slot"):
            self._title = ui.label().classes("text-h6")
            self._now = ui.label()
            self._side = self._choice("side", SIDES)
            self._tracks = self._choice("tracks away", TRACKS)
            with ui.row():
                self._take = button("take", self._confirm)
                button("cancel", self._dialog.close)

    def _choice(self, what: str, options: tuple[str, ...] | tuple[int, ...]) -> ui.toggle:
        ui.label(what)
        toggle = ui.toggle(list(options), value=options[0], on_change=self._name)
        return toggle.props("no-caps toggle-color=none toggle-text-color=none")  # of the palette

    def open(self, snapshot: Snapshot) -> None:
        """Show it for a UAV, with the slot that it has."""
        self._uav = snapshot.callsign
        self._title.set_text(f"Another slot for {self._uav or 'the UAV'}")
        self._now.set_text(f"now: {snapshot.slot or NONE}")
        side, tracks = slot_words(snapshot.slot)
        self._side.set_value(side if side in SIDES else SIDES[0])
        self._tracks.set_value(tracks if tracks in TRACKS else TRACKS[0])
        self._name()
        self._dialog.open()

    def _name(self) -> None:
        """Have the button say what it asks for."""
        self._take.set_text(f"take {self._side.value} {self._tracks.value}")

    def _confirm(self) -> None:
        self._give(str(self._side.value), int(self._tracks.value or 1), self._uav)
        self._dialog.close()
