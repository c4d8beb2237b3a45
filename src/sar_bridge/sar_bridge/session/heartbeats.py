"""The ground station's heartbeats to the autopilot, and when they are withheld."""

from __future__ import annotations

from sar_bridge.mavlink.commands import ground_heartbeat
from sar_bridge.session.list_transfer import Messages
from sar_estimator.common.component import Notice

HEARTBEAT_PERIOD_S = 1.0


class Heartbeats:
    """Sent once a second. Times are of a monotonic clock [s].

    ``silent``: the node that leads the UAV or watches over it and is not heard any more: while it
    is named and a list is flown there are none, so that the autopilot's own failsafe acts.
    """

    def __init__(self) -> None:
        """Send the first at once."""
        self.silent = ""
        self._sent_s = float("-inf")
        self._was_withheld = False

    def withheld(self, *, leading: bool) -> str:
        """Return why none are sent, empty when they are; ``leading``: a list is flown."""
        if not (leading and self.silent):
            return ""
        return f"no heartbeats to the autopilot: node {self.silent} is silent"

    def due(self, now_s: float, *, leading: bool) -> Messages:
        """Return one when it is due."""
        if now_s - self._sent_s < HEARTBEAT_PERIOD_S or self.withheld(leading=leading):
            return []
        self._sent_s = now_s
        return [ground_heartbeat()]

    def news(self, *, leading: bool) -> Notice | None:
        """Return that they stop, or go on, for the log: cut off, the graph cannot hear of it."""
        why, before = self.withheld(leading=leading), self._was_withheld
        self._was_withheld = bool(why)
        if self._was_withheld == before:
            return None
        return Notice("error", why) if why else Notice("info", "heartbeats to the autopilot go on")
