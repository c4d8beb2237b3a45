"""The page of a flight that is going on."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable

from sar_bridge.console.map_view import Search
from sar_bridge.console.snapshot import Snapshot
from sar_bridge.services import SERVICES

ACTIONS = tuple(SERVICES)


class LiveDesk:
    """Shows a component that a node feeds, and asks that node's services.

    ``ask``: of the node; what is answered comes to the component.
    """

    actions: tuple[str, ...] = ACTIONS

    def __init__(
        self,
        snapshots: Callable[[], dict[str, Snapshot]],
        ask: Callable[[str, str], None],
        acknowledge: Callable[[], None],
        mark: Callable[[float, float], None],
        give_slot: Callable[[str, int, str], None],
        search: Search,
        folder: str,
    ) -> None:
        """Show what ``snapshots`` gives, by UAV; ``folder``: on the recorder's disk."""
        self._snapshots, self._ask, self._acknowledge = snapshots, ask, acknowledge
        self._mark, self._give_slot = mark, give_slot
        self.search = search
        self._folder = folder
        self._free: tuple[float, float] = (0.0, -1e9)

    def snapshots(self) -> dict[str, Snapshot]:
        """Return what is known now, by UAV."""
        return self._snapshots()

    def free_gb(self) -> float:
        """Return the space on the recorder's disk [GB], looked at now and then."""
        now = time.monotonic()
        if now - self._free[1] > 5.0:
            self._free = shutil.disk_usage(self._folder).free / 1e9, now
        return self._free[0]

    def ask(self, action: str, uav: str) -> None:
        """Ask for something of a UAV."""
        self._ask(action, uav)

    def acknowledge(self) -> None:
        """Take the banner for known."""
        self._acknowledge()

    def mark(self, x_m: float, y_m: float) -> None:
        """Mark a place of the map [m]."""
        self._mark(x_m, y_m)

    def give_slot(self, side: str, tracks: int, uav: str) -> None:
        """Ask for another slot for a UAV."""
        self._give_slot(side, tracks, uav)

    def span_s(self) -> tuple[float, float] | None:
        """Only now can be shown."""
        return None

    def seek(self, time_s: float) -> None:
        """Only now can be shown."""
