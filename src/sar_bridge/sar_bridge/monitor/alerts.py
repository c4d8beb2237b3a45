"""How near a conflict is, as it is told: at once when it gets less, after a while when more."""

from __future__ import annotations

import enum
import math

from sar_bridge.monitor.parameters import MonitorParameters


class Alert(enum.StrEnum):
    """How near a conflict is, in the order of severity."""

    NONE = "none"
    CAUTION = "caution"
    WARNING = "warning"
    ESCAPE = "escape"


ALERTS = tuple(Alert)


class Alerts:
    """``alert``: the state of the list being flown. ``counts``: how often each began."""

    def __init__(self, parameters: MonitorParameters) -> None:
        """Tell of nothing."""
        self.alert = Alert.NONE
        self.counts: dict[Alert | str, int] = dict.fromkeys((*Alert, "passed", "refused"), 0)
        self._after_s = parameters.alert_after_s
        self._thresholds = parameters.thresholds()
        self._near_since_s = math.inf

    def set(self, alert: Alert) -> None:
        """Tell of it at once."""
        if alert is not self.alert:
            self.counts[alert] += 1
        self.alert = alert

    def watch(self, distance_m: float, now_s: float) -> None:
        """Take the closest approach in prediction [m], while nobody is sent away."""
        alert = Alert.NONE
        if distance_m < self._thresholds["caution_separation_m"]:
            near = distance_m < self._thresholds["warning_separation_m"]
            alert = Alert.WARNING if near else Alert.CAUTION
        if ALERTS.index(alert) <= ALERTS.index(self.alert):
            self._near_since_s = math.inf
            self.set(alert)
            return
        self._near_since_s = min(self._near_since_s, now_s)
        if now_s - self._near_since_s >= self._after_s:
            self.set(alert)
