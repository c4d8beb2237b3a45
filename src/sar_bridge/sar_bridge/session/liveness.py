"""Which of the nodes that lead a UAV are still heard of."""

from __future__ import annotations

from collections.abc import Iterable


class Liveness:
    """Nodes by name, and when each was heard last. Times are of a monotonic clock [s].

    A node that was never heard is not missed: it may not have been started yet, and nothing is led
    without it.
    """

    def __init__(self, names: Iterable[str], timeout_s: float) -> None:
        """Watch ``names``; one is silent when it was not heard for ``timeout_s``."""
        self._timeout_s = timeout_s
        self._heard: dict[str, float | None] = dict.fromkeys(names)

    def hear(self, name: str, now_s: float) -> None:
        """Take note that a node is alive; others than the watched ones do not matter."""
        if name in self._heard:
            self._heard[name] = now_s

    def silent(self, now_s: float) -> str:
        """Return the first node that is silent, empty when none is."""
        for name, heard in self._heard.items():
            if heard is not None and now_s - heard > self._timeout_s:
                return name
        return ""
