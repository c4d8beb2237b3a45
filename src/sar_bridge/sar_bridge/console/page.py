"""The operator's page, by NiceGUI: a shell around what is decided elsewhere."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from html import escape
from typing import Protocol

from nicegui import events, ui

from sar_bridge.console.alarm import Alarm
from sar_bridge.console.banner import NAMES, SHAPES, Banner, banner, worst
from sar_bridge.console.checklist import BY_HAND, checklist
from sar_bridge.console.figures import Figure, figures
from sar_bridge.console.lights import lights
from sar_bridge.console.map_panel import MapPanel, button
from sar_bridge.console.map_view import Search, trend
from sar_bridge.console.rows import Row, row
from sar_bridge.console.slot_panel import SlotPanel
from sar_bridge.console.snapshot import Snapshot
from sar_bridge.console.style import CSS, SCRIPT
from sar_bridge.console.tiles import Tiles
from sar_bridge.services import SERVICES, SLOT

UPDATE_S = 0.5
HOLD_S = 1.0
PALETTES = ("day", "night", "red")
Ticked = events.ValueChangeEventArguments[bool | None]


class Desk(Protocol):
    """What the page is of: a live graph, or a bag.

    ``actions``: what can be asked for, by name; ``search``: what is searched.
    """

    search: Search
    actions: tuple[str, ...]

    def snapshots(self) -> Mapping[str, Snapshot]:
        """Return what is known now, by UAV: always the same ones; one alone may have no name."""
        ...

    def free_gb(self) -> float:
        """Return the space on the recorder's disk [GB]."""
        ...

    def ask(self, action: str, uav: str) -> None:
        """Ask for something of a UAV; what is answered is in a later snapshot."""
        ...

    def acknowledge(self) -> None:
        """Take the banner for known."""
        ...

    def mark(self, x_m: float, y_m: float) -> None:
        """Mark a place of the map [m]."""
        ...

    def give_slot(self, side: str, tracks: int, uav: str) -> None:
        """Ask for another slot for a UAV; what is answered is in a later snapshot."""
        ...

    def span_s(self) -> tuple[float, float] | None:
        """Return when what can be shown begins and ends [s]; None where only now can be."""
        ...

    def seek(self, time_s: float) -> None:
        """Show another time [s]."""
        ...


class Page:
    """One browser's page; its timer brings it up to date."""

    def __init__(self, desk: Desk, tiles: Tiles | None) -> None:
        """Build it; ``tiles``: what lies under the map."""
        self._desk, self._tiles = desk, tiles
        self._alarms, self._sounds = {uav: Alarm() for uav in desk.snapshots()}, False
        self._chosen = next(iter(self._alarms))
        self._rows: dict[str, tuple[ui.element, dict[str, ui.label]]] = {}
        self._asking: dict[str, ui.button] = {}
        self._look = PALETTES[0]
        self._held_s: dict[str, float] = {}
        ui.add_css(CSS)
        ui.add_head_html(SCRIPT)
        several = len(self._alarms) > 1
        with ui.element("div").classes("desk several" if several else "desk"):
            self._build_banner()
            if several:
                self._build_rows()
            self._build_map()
            self._build_side()
            self._build_buttons()
        self._build_checklist()
        self._slot = SlotPanel(desk.give_slot)
        self._choose(self._chosen)
        ui.timer(UPDATE_S, self.update)

    # Built once --------------------------------------------------------------------------------

    def _build_banner(self) -> None:
        with ui.element("div").classes("banner idle") as self._banner:
            self._shape = ui.label().classes("shape")
            self._state = ui.label().classes("state")
            self._reason = ui.label().classes("reason")
            self._action = ui.label().classes("action")

    def _build_rows(self) -> None:
        """Build a row for each UAV; its name chooses it."""
        with ui.element("div").classes("uavs panel"):
            for uav, snapshot in self._desk.snapshots().items():
                shown = row(snapshot, banner(snapshot))
                with ui.element("div").classes("uavrow") as element:
                    button(shown.name, self._chooser(uav))
                    cells = {one.name: self._build_cell(one) for one in shown.cells}
                self._rows[uav] = element, cells

    @staticmethod
    def _build_cell(figure: Figure) -> ui.label:
        with ui.element("div").classes(f"cell {figure.name.split()[-1]}"):
            ui.label(figure.name).classes("name")
            return ui.label(figure.text).classes("value")

    def _build_map(self) -> None:
        mark = self._desk.mark if "mark" in self._desk.actions else None
        with ui.element("div").classes("map"):
            self._map = MapPanel(self._desk.search, mark, self._tiles)
            with ui.element("div").classes("tools"):
                self._map.build_tools()
                self._palette = button("day", self._next_palette)

    def _build_side(self) -> None:
        with ui.element("div").classes("side"):
            with ui.element("div").classes("panel figures") as self._figures:
                self._shown: dict[str, tuple[ui.element, ui.label]] = {}
                for figure in figures(Snapshot()):
                    self._build_figure(figure)
            with ui.element("div").classes("panel"):
                self._trend = ui.html("", sanitize=False)
            with ui.element("div").classes("panel"):
                self._lights = ui.html("", sanitize=False)
            with ui.element("div").classes("panel answers"):
                self._clock = ui.label()
                self._pulse = ui.label().classes("pulse").style("display: none")
                self._answers = ui.label()

    def _build_figure(self, figure: Figure) -> None:
        more = " wide" if figure.is_wide else ""
        more += " small" if figure.is_small else ""
        with ui.element("div").classes(f"figure{more}") as element:
            ui.label(figure.name).classes("name")
            value = ui.label(figure.text).classes("value")
        self._shown[figure.name] = element, value

    def _build_buttons(self) -> None:
        with ui.element("div").classes("buttons"):
            if self._desk.span_s() is None:
                button("checklist", self._open_checklist)
            for action in self._desk.actions:
                if action == "disengage":
                    self._build_held(action)
                else:
                    self._asking[action] = button(action, self._asker(action))
            span = self._desk.span_s()
            if span is None:
                self._asking[SLOT] = button(SLOT, self._open_slot)
            button("acknowledge", self._acknowledge)
            if span is not None:
                begin, end = span
                self._slider = ui.slider(min=begin, max=end, value=begin, step=1.0)
                self._slider.on("change", lambda event: self._seek(event.args))

    def _build_held(self, action: str) -> None:
        held = self._asking[action] = button(action).classes("hold")

        def down() -> None:
            self._held_s[action] = time.monotonic()

        def up() -> None:
            held_s = time.monotonic() - self._held_s.pop(action, math.inf)
            if held_s >= HOLD_S:
                self._desk.ask(action, self._chosen)

        held.on("pointerdown", down, [])
        held.on("pointerup", up, [])
        held.on("pointerleave", lambda: self._held_s.pop(action, None), [])

    def _asker(self, action: str) -> Callable[[], None]:
        return lambda: self._desk.ask(action, self._chosen)

    def _build_checklist(self) -> None:
        with ui.dialog() as self._dialog, ui.card():
            self._before = ui.label().classes("text-h6")
            self._checks = ui.html("", sanitize=False).classes("checks")
            for text in BY_HAND:
                ui.checkbox(text)
            ui.checkbox("Sound heard (click arms it)", on_change=self._arm)
            button("close", self._dialog.close)

    # What the browser's user does --------------------------------------------------------------

    def _chooser(self, uav: str) -> Callable[[], None]:
        return lambda: self._choose(uav)

    def _choose(self, uav: str) -> None:
        """Have figures, lights, checklist and buttons be a UAV's; what is being held ends."""
        self._chosen = uav
        self._held_s.clear()
        name = uav or ("UAV" if self._rows else "")
        for action, asking in self._asking.items():
            whose = f" {name}" if name and action in (*SERVICES, SLOT) else ""
            hold = " (hold 1 s)" if action == "disengage" else ""
            asking.set_text(action.replace("_", " ") + whose + hold)
        self._before.set_text(f"Before engaging {name}".rstrip())
        self.update()

    def _open_checklist(self) -> None:
        self._dialog.open()

    def _open_slot(self) -> None:
        self._slot.open(self._desk.snapshots()[self._chosen])

    def _acknowledge(self) -> None:
        self._desk.acknowledge()
        self.update()

    def _next_palette(self) -> None:
        self._look = PALETTES[(PALETTES.index(self._look) + 1) % len(PALETTES)]
        self._palette.set_text(self._look)
        ui.run_javascript(
            f"document.body.classList.remove('night', 'red');"
            f"document.body.classList.add('{self._look}')"
        )

    def _arm(self, event: Ticked) -> None:
        self._sounds = bool(event.value)
        if self._sounds:
            ui.run_javascript("armSound()")

    def _seek(self, time_s: float) -> None:
        self._desk.seek(time_s)
        self.update()

    # Brought up to date ------------------------------------------------------------------------

    def update(self) -> None:
        """Show what is known now."""
        snapshots, free_gb = self._desk.snapshots(), self._desk.free_gb()
        banners = {uav: banner(one) for uav, one in snapshots.items()}
        self._update_banner(worst(banners.values()))
        self._sound(banners)
        for uav in self._rows:
            self._update_row(uav, row(snapshots[uav], banners[uav]))
        snapshot = snapshots[self._chosen]
        self._map.update(snapshot, [one for one in snapshots.values() if one is not snapshot])
        for figure in figures(snapshot):
            element, value = self._shown[figure.name]
            value.set_text(figure.text)
            element.classes(**({"add": "stale"} if figure.is_stale else {"remove": "stale"}))
        self._trend.set_content(trend(snapshot.trend, snapshot.least_separation_m))
        self._lights.set_content(
            "".join(
                f'<div class="light"><span class="dot {NAMES[one.urgency]}">{SHAPES[one.urgency]}'
                f'</span><span class="what">{one.name}</span><span class="text">'
                f"{escape(one.text)}</span></div>"
                for one in lights(snapshot, free_gb)
            )
        )
        self._update_checks(snapshot, free_gb)
        shown = time.time()
        self._pulse.set_text(f"{shown:.1f}")
        if snapshot.is_playback:
            shown = snapshot.now_s
            self._slider.set_value(shown)
        at = datetime.fromtimestamp(shown, UTC)
        self._clock.set_text(at.strftime("%H:%M:%S.%f")[:10] + " UTC")
        self._answers.set_text(" · ".join(snapshot.answers[-2:]))

    def _update_banner(self, shown: Banner) -> None:
        self._banner.classes(remove=" ".join(NAMES.values()), add=NAMES[shown.urgency])
        self._shape.set_text(SHAPES[shown.urgency])
        known = " (acknowledged)" if shown.acknowledged else ""
        self._state.set_text(shown.title + known)
        self._reason.set_text(shown.reason)
        self._action.set_text(shown.action)

    def _sound(self, banners: Mapping[str, Banner]) -> None:
        """Sound for any UAV; the highest tone where several are due."""
        if not self._sounds:
            return
        now = time.monotonic()
        due = [alarm.due(banners[uav], now) for uav, alarm in self._alarms.items()]
        tones = [tone for tone in due if tone is not None]
        if tones:
            hertz, seconds = max(tones)
            ui.run_javascript(f"beep({hertz}, {seconds})")

    def _update_row(self, uav: str, shown: Row) -> None:
        element, cells = self._rows[uav]
        kind = NAMES[shown.urgency] + (" chosen" if uav == self._chosen else "")
        element.classes(remove=" ".join((*NAMES.values(), "chosen")), add=kind)
        for cell in shown.cells:
            cells[cell.name].set_text(cell.text)
            cells[cell.name].classes(**({"add": "stale"} if cell.is_stale else {"remove": "stale"}))

    def _update_checks(self, snapshot: Snapshot, free_gb: float) -> None:
        rows = []
        for item in checklist(snapshot, free_gb):
            name = "normal" if item.done else "caution"
            sign = "✔" if item.done else "✘"
            rows.append(
                f'<div class="check"><span class="dot {name}">{sign}</span>'
                f'<span>{item.text}</span><span class="why">{escape(item.why)}</span></div>'
            )
        self._checks.set_content("".join(rows))
