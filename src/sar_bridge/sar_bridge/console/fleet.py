"""The consoles of all UAVs as one component: each hears its own namespace and what all share."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sar_bridge.console.banner import banner, worst
from sar_bridge.console.component import ConsoleComponent
from sar_bridge.console.snapshot import OWN, Snapshot
from sar_estimator.common import topics
from sar_estimator.common.component import Component, Handler, Outputs
from sar_estimator.common.wires import WIRES

TELLING = WIRES.keys() - topics.COMMON - {topics.DIAGNOSTICS}
"""The topics that tell which UAVs there are."""


def uavs_in(names: Iterable[str]) -> tuple[str, ...]:
    """Return the namespaces of the UAVs that a recording's topics are of, sorted; "" for none."""
    found = {topics.uav_of(name) for name in names if topics.plain(name) in TELLING}
    return tuple(sorted(found)) or ("",)


class Fleet(Component):
    """A console for each UAV, by namespace, empty for a UAV without one."""

    name = ConsoleComponent.name
    outputs = ConsoleComponent.outputs

    def __init__(self, uavs: tuple[str, ...] = ("",), *, is_playback: bool = False) -> None:
        """Have heard nothing of any of them."""
        super().__init__()
        self._consoles = {uav: ConsoleComponent(uav, is_playback=is_playback) for uav in uavs}
        heard: dict[str, list[Handler]] = {}
        for uav, console in self._consoles.items():
            for topic, handler in console.inputs.items():
                heard.setdefault(topics.of_uav(topic, uav), []).append(handler)
            if uav:
                heard.setdefault(topics.DIAGNOSTICS, []).append(_of_shared_nodes(console))
        self.inputs = {name: _to_all(handlers) for name, handlers in heard.items()}

    def set_clock_back(self) -> None:
        """Forget everything."""
        for console in self._consoles.values():
            console.set_clock_back()

    def acknowledge(self, now_s: float) -> None:
        """Take the banner of now for known, for every UAV that it is of."""
        shown = {uav: banner(one) for uav, one in self.snapshots(now_s).items()}
        key = worst(shown.values()).key
        for uav, console in self._consoles.items():
            if shown[uav].key == key:
                console.acknowledge(now_s)

    def answered(self, text: str) -> None:
        """Take what a service answered, word for word: shown whichever UAV is chosen."""
        for console in self._consoles.values():
            console.answered(text)

    def snapshots(self, now_s: float) -> dict[str, Snapshot]:
        """Return all that is known, by UAV."""
        return {uav: console.snapshot(now_s) for uav, console in self._consoles.items()}


def _to_all(handlers: list[Handler]) -> Handler:
    def handle(value: Any, now_s: float) -> Outputs:
        return [one for handler in handlers for one in handler(value, now_s)]

    return handle


def _of_shared_nodes(console: ConsoleComponent) -> Handler:
    """Return what hands on how the nodes are that all UAVs share."""

    def handle(healths: Any, now_s: float) -> Outputs:
        shared = tuple(one for one in healths if one.name not in OWN)
        return console.handle(topics.DIAGNOSTICS, shared, now_s)

    return handle
