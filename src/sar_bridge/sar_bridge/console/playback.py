"""The page of a flight that was recorded: any time of it, or as it went on."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable
from typing import Any

from sar_bridge.console.fleet import Fleet, uavs_in
from sar_bridge.console.map_view import Search
from sar_bridge.console.snapshot import Snapshot

Told = tuple[float, str, Any]
"""When something was told [s], its topic with its UAV's namespace, and the value."""


class PlaybackDesk:
    """Feeds the consoles of a bag's UAVs with what a bag has, up to the time that is shown.

    Raises ``ValueError`` for a flight in which nothing was told.
    """

    actions: tuple[str, ...] = ("play", "pause")

    def __init__(
        self,
        told: Iterable[Told],
        search: Search,
        clock: Callable[[], float],
        *,
        speed: float = 10.0,
    ) -> None:
        """Show the beginning; ``speed``: times real time, which ``clock`` tells [s]."""
        self._told = sorted(told, key=lambda one: one[0])
        if not self._told:
            raise ValueError("nothing to show: no topic of a flight")
        self._times = [one[0] for one in self._told]
        self.search = search
        self._clock, self._speed = clock, speed
        self._fleet = Fleet(uavs_in({one[1] for one in self._told}), is_playback=True)
        self._fed = 0
        self._shown_s = self._times[0]
        self._playing_since: tuple[float, float] | None = None

    def snapshots(self) -> dict[str, Snapshot]:
        """Return what was known at the time that is shown, by UAV."""
        if self._playing_since is not None:
            begun_s, from_s = self._playing_since
            self._feed(from_s + self._speed * (self._clock() - begun_s))
        return self._fleet.snapshots(self._shown_s)

    def free_gb(self) -> float:
        """Return no space: nothing is recorded."""
        return 0.0

    def ask(self, action: str, uav: str = "") -> None:  # noqa: ARG002
        """Go on from the time that is shown, or stand there."""
        playing = action == "play"
        self._playing_since = (self._clock(), self._shown_s) if playing else None

    def acknowledge(self) -> None:
        """Take the banner for known."""
        self._fleet.acknowledge(self._shown_s)

    def mark(self, x_m: float, y_m: float) -> None:
        """Mark nothing: it is over."""

    def give_slot(self, side: str, tracks: int, uav: str) -> None:
        """Change nothing: it is over."""

    def span_s(self) -> tuple[float, float] | None:
        """Return when the flight begins and ends [s]."""
        return self._times[0], self._times[-1]

    def seek(self, time_s: float) -> None:
        """Show another time [s], and stand there."""
        self._playing_since = None
        if time_s < self._shown_s:
            self._fleet.set_clock_back()
            self._fed = 0
        self._feed(time_s)

    def _feed(self, time_s: float) -> None:
        self._shown_s = min(time_s, self._times[-1])
        until = bisect_right(self._times, self._shown_s)
        for at_s, topic, value in self._told[self._fed : until]:
            self._fleet.handle(topic, value, at_s)
        self._fed = max(until, self._fed)
