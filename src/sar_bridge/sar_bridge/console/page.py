"""The operator's page, by NiceGUI: a shell around what is decided elsewhere."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Protocol

from nicegui import events, ui
from shapely.geometry.base import BaseGeometry

from sar_bridge.console.banner import NAMES, SHAPES, Banner, Urgency, banner
from sar_bridge.console.checklist import BY_HAND, checklist
from sar_bridge.console.figures import Figure, figures
from sar_bridge.console.lights import lights
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
from sar_bridge.console.style import CSS, SCRIPT

UPDATE_S = 0.5
GAPS_S = 5.0
HOLD_S = 1.0
REACHES_M = (500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0)
PALETTES = ("day", "night", "red")
BEEPS = {Urgency.CAUTION: (520, 0.25), Urgency.WARNING: (880, 0.35)}
WARNING_AGAIN_S = 2.0
Ticked = events.ValueChangeEventArguments[bool | None]


class Desk(Protocol):
    """What the page is of: a live graph, or a bag.

    ``actions``: what can be asked for, by name; ``search``: what is searched.
    """

    search: Search
    actions: tuple[str, ...]

    def snapshot(self) -> Snapshot:
        """Return what is known now."""
        ...

    def free_gb(self) -> float:
        """Return the space on the recorder's disk [GB]."""
        ...

    def ask(self, action: str) -> None:
        """Ask for something; what is answered is in a later snapshot."""
        ...

    def acknowledge(self) -> None:
        """Take the banner for known."""
        ...

    def mark(self, x_m: float, y_m: float) -> None:
        """Mark a place of the map [m]."""
        ...

    def span_s(self) -> tuple[float, float] | None:
        """Return when what can be shown begins and ends [s]; None where only now can be."""
        ...

    def seek(self, time_s: float) -> None:
        """Show another time [s]."""
        ...


@dataclass
class _Looks:
    """How one browser looks at it."""

    reach: int = 2
    track_up: bool = False
    palette: str = "day"
    sound: bool = False


class Page:
    """One browser's page; its timer brings it up to date."""

    def __init__(self, desk: Desk) -> None:
        """Build it."""
        self._desk = desk
        self._looks = _Looks()
        self._view = View()
        self._place = 0.0, 0.0
        self._gaps: BaseGeometry | None = None
        self._gaps_s = -math.inf
        self._beeped: tuple[str, float] = ("", -math.inf)
        self._held_s: dict[str, float] = {}
        self._by_hand: dict[str, bool] = dict.fromkeys(BY_HAND, False)
        ui.add_css(CSS)
        ui.add_head_html(SCRIPT)
        with ui.element("div").classes("desk"):
            self._build_banner()
            self._build_map()
            self._build_side()
            self._build_buttons()
        self._build_checklist()
        self._build_marking()
        self.update()
        ui.timer(UPDATE_S, self.update)

    # Built once --------------------------------------------------------------------------------

    def _build_banner(self) -> None:
        with ui.element("div").classes("banner idle") as self._banner:
            self._shape = ui.label().classes("shape")
            self._state = ui.label().classes("state")
            self._reason = ui.label().classes("reason")
            self._action = ui.label().classes("action")

    def _build_map(self) -> None:
        view = self._view
        with ui.element("div").classes("map"):
            self._map = ui.interactive_image(
                size=(view.width_px, view.height_px), on_mouse=self._touch, sanitize=False
            )
            with ui.element("div").classes("tools"):
                _button("+", lambda: self._zoom(-1))
                _button("-", lambda: self._zoom(1))
                self._up = _button("north up", self._turn_map)
                self._palette = _button("day", self._next_palette)

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
                _button("checklist", self._open_checklist)
            for action in self._desk.actions:
                if action == "disengage":
                    self._build_held(action)
                else:
                    text = action.replace("_", " ")
                    _button(text, self._asker(action))
            _button("acknowledge", self._acknowledge)
            span = self._desk.span_s()
            if span is not None:
                begin, end = span
                self._slider = ui.slider(min=begin, max=end, value=begin, step=1.0)
                self._slider.on("change", lambda event: self._seek(event.args))

    def _build_held(self, action: str) -> None:
        button = _button(f"{action} (hold 1 s)").classes("hold")

        def down() -> None:
            self._held_s[action] = time.monotonic()

        def up() -> None:
            held_s = time.monotonic() - self._held_s.pop(action, math.inf)
            if held_s >= HOLD_S:
                self._desk.ask(action)

        button.on("pointerdown", down, [])
        button.on("pointerup", up, [])
        button.on("pointerleave", lambda: self._held_s.pop(action, None), [])

    def _asker(self, action: str) -> Callable[[], None]:
        return lambda: self._desk.ask(action)

    def _build_checklist(self) -> None:
        with ui.dialog() as self._dialog, ui.card():
            ui.label("Before engaging").classes("text-h6")
            self._checks = ui.html("", sanitize=False).classes("checks")
            for text in BY_HAND:
                ui.checkbox(text, on_change=self._ticker(text))
            ui.checkbox("Sound heard (click arms it)", on_change=self._arm)
            _button("close", self._dialog.close)

    def _build_marking(self) -> None:
        """Build what asks whether a place that was touched is to be marked."""
        with ui.dialog() as self._marking, ui.card():
            self._place_text = ui.label()
            _button("mark here", self._mark_here)
            _button("cancel", self._marking.close)

    def _touch(self, event: events.MouseEventArguments) -> None:
        if "mark" in self._desk.actions:
            self._place = self._view.to_map(event.image_x, event.image_y)
            datum = self._desk.snapshot().datum
            if datum is None:
                return
            latitude, longitude, _ = datum.to_geodetic(*self._place)
            text = f"{degrees_text(latitude, 'NS')} {degrees_text(longitude, 'EW')}"
            self._place_text.set_text(text)
            self._marking.open()

    def _mark_here(self) -> None:
        self._desk.mark(*self._place)
        self._marking.close()

    def _ticker(self, text: str) -> Callable[[Ticked], None]:
        def tick(event: Ticked) -> None:
            self._by_hand[text] = bool(event.value)

        return tick

    # What the browser's user does --------------------------------------------------------------

    def _open_checklist(self) -> None:
        self._dialog.open()

    def _acknowledge(self) -> None:
        self._desk.acknowledge()
        self.update()

    def _zoom(self, steps: int) -> None:
        self._looks.reach = min(max(self._looks.reach + steps, 0), len(REACHES_M) - 1)
        self.update()

    def _turn_map(self) -> None:
        self._looks.track_up = not self._looks.track_up
        self._up.set_text("track up" if self._looks.track_up else "north up")
        self.update()

    def _next_palette(self) -> None:
        looks = self._looks
        looks.palette = PALETTES[(PALETTES.index(looks.palette) + 1) % len(PALETTES)]
        self._palette.set_text(looks.palette)
        ui.run_javascript(
            f"document.body.classList.remove('night', 'red');"
            f"document.body.classList.add('{looks.palette}')"
        )

    def _arm(self, event: Ticked) -> None:
        self._looks.sound = bool(event.value)
        if self._looks.sound:
            ui.run_javascript("armSound()")

    def _seek(self, time_s: float) -> None:
        self._desk.seek(time_s)
        self.update()

    # Brought up to date ------------------------------------------------------------------------

    def update(self) -> None:
        """Show what is known now."""
        snapshot, free_gb = self._desk.snapshot(), self._desk.free_gb()
        self._update_banner(banner(snapshot))
        self._update_map(snapshot)
        for figure in figures(snapshot):
            element, value = self._shown[figure.name]
            value.set_text(figure.text)
            element.classes(**({"add": "stale"} if figure.is_stale else {"remove": "stale"}))
        self._trend.set_content(trend(snapshot.trend, snapshot.least_separation_m))
        self._lights.set_content(
            "".join(
                f'<div class="light"><span class="dot {NAMES[one.urgency]}">{SHAPES[one.urgency]}'
                f'</span><span class="what">{one.name}</span><span class="text">'
                f"{_plain(one.text)}</span></div>"
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
        self._state.set_text(shown.state + known)
        self._reason.set_text(shown.reason)
        self._action.set_text(shown.action)
        key, beeped_s = self._beeped
        now = time.monotonic()
        again = shown.urgency is Urgency.WARNING and now - beeped_s >= WARNING_AGAIN_S
        if shown.sounds and self._looks.sound and (shown.key != key or again):
            self._beeped = shown.key, now
            hertz, seconds = BEEPS[shown.urgency]
            ui.run_javascript(f"beep({hertz}, {seconds})")
        elif not shown.sounds:
            self._beeped = "", -math.inf

    def _update_map(self, snapshot: Snapshot) -> None:
        now = time.monotonic()
        if now - self._gaps_s > GAPS_S or snapshot.is_playback:
            self._gaps, self._gaps_s = left_out(snapshot.tracks, self._desk.search), now
        up = 0.5 * math.pi
        if self._looks.track_up and snapshot.leg is not None:
            up = snapshot.leg.foot.heading_rad
        self._view = replace(
            self._view,
            centre_m=centre_of(snapshot),
            reach_m=REACHES_M[self._looks.reach],
            up_rad=up,
        )
        self._map.set_content(picture(snapshot, self._view, self._desk.search, self._gaps))

    def _update_checks(self, snapshot: Snapshot, free_gb: float) -> None:
        rows = []
        for item in checklist(snapshot, free_gb):
            name = "normal" if item.done else "caution"
            sign = "✔" if item.done else "✘"
            rows.append(
                f'<div class="check"><span class="dot {name}">{sign}</span>'
                f'<span>{item.text}</span><span class="why">{_plain(item.why)}</span></div>'
            )
        self._checks.set_content("".join(rows))


def _button(text: str, on_click: Callable[[], object] | None = None) -> ui.button:
    return ui.button(text, on_click=on_click, color=None).props("flat")


def _plain(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
