"""The console of a UAV as a component: what is told in; snapshots for the page out."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sar_bridge.console.banner import banner
from sar_bridge.console.snapshot import Snapshot, Told
from sar_estimator.common import topics
from sar_estimator.common.component import Component, Outputs
from sar_estimator.common.reports import (
    CornerRecord,
    Health,
    HelicopterReport,
    UavReport,
)
from sar_estimator.common.states import FloatArray, Motion

TRACK_M = 20.0
MOST_POINTS = 20_000
TREND_S = 60.0
ANSWERS = 5


@dataclass
class _Track:
    """Where an aircraft has been, a point every ``TRACK_M`` [m]."""

    points: deque[tuple[float, float]] = field(default_factory=lambda: deque(maxlen=MOST_POINTS))

    def add(self, motion: Motion) -> None:
        place = motion.x_m, motion.y_m
        if not self.points or math.dist(place, self.points[-1]) >= TRACK_M:
            self.points.append(place)

    def array(self, motion: Motion | None) -> FloatArray:
        now = [] if motion is None else [(motion.x_m, motion.y_m)]
        return np.array([*self.points, *now], dtype=np.float64).reshape(-1, 2)


class ConsoleComponent(Component):
    """Keeps what is told of a UAV.

    Ages are by the clock of ``now_s`` [s], which need not be the graph's.
    """

    name = "console"
    outputs = (topics.DIAGNOSTICS, topics.TARGET)
    period_s = 1.0

    def __init__(self, uav: str = "", *, is_playback: bool = False) -> None:
        """Have heard nothing; ``uav``: its namespace, empty for none."""
        super().__init__()
        self.uav = uav
        self._is_playback = is_playback
        self._clear()
        self.inputs = {topic: self._keeper(topic) for topic in KEPT} | {
            topics.HELICOPTER_ODOMETRY: self._on_helicopter,
            topics.UAV_ODOMETRY: self._on_uav,
            topics.CORNER_PLAN: self._on_corner,
            topics.DIAGNOSTICS: self._on_diagnostics,
        }

    def _clear(self) -> None:
        self._newest: dict[str, Any] = {}
        self._heard_s: dict[str, float] = {}
        self._nodes: dict[str, tuple[Health, float]] = {}
        self._tracks = (_Track(), _Track())
        self._trend: deque[tuple[float, float]] = deque()
        self._lags: dict[int, float] = {}
        self._quiet = ""
        self._answers: deque[str] = deque(maxlen=ANSWERS)

    def _keeper(self, topic: str) -> Any:
        def keep(value: Any, now_s: float) -> Outputs:
            self._newest[topic], self._heard_s[topic] = value, now_s
            return []

        return keep

    # What is told ------------------------------------------------------------------------------

    def _on_helicopter(self, report: HelicopterReport, now_s: float) -> Outputs:
        self._keeper(topics.HELICOPTER_ODOMETRY)(report, now_s)
        self._tracks[0].add(report.motion)
        return []

    def _on_uav(self, report: UavReport, now_s: float) -> Outputs:
        self._keeper(topics.UAV_ODOMETRY)(report, now_s)
        self._tracks[1].add(report.motion)
        helicopter = self._newest.get(topics.HELICOPTER_ODOMETRY)
        if helicopter is not None:
            apart = math.hypot(
                helicopter.motion.x_m - report.motion.x_m, helicopter.motion.y_m - report.motion.y_m
            )
            self._trend.append((now_s, apart))
            while self._trend and now_s - self._trend[0][0] > TREND_S:
                self._trend.popleft()
        return []

    def _on_corner(self, record: CornerRecord, _now_s: float) -> Outputs:
        self._lags[record.k] = record.lag_m
        return []

    def _on_diagnostics(self, healths: tuple[Health, ...], now_s: float) -> Outputs:
        for health in healths:
            if health.name != self.name:
                self._nodes[health.name] = health, now_s
        return []

    def set_clock_back(self) -> None:
        """Forget everything: another flight begins, or a bag is played from elsewhere."""
        self._clear()

    # What the operator does --------------------------------------------------------------------

    def acknowledge(self, now_s: float) -> None:
        """Take the banner of now for known: it makes no sound until it is another."""
        self._quiet = banner(self.snapshot(now_s)).key

    def answered(self, text: str) -> None:
        """Take what a service answered, word for word."""
        self._answers.append(text)

    # What is shown -----------------------------------------------------------------------------

    def snapshot(self, now_s: float) -> Snapshot:
        """Return all that is known."""
        newest = self._newest
        helicopter = newest.get(topics.HELICOPTER_ODOMETRY)
        uav = newest.get(topics.UAV_ODOMETRY)
        told = {name: newest[topic] for topic, name in KEPT.items() if name and topic in newest}
        return Snapshot(
            callsign=self.uav,
            now_s=now_s,
            helicopter=helicopter,
            helicopter_age_s=self._age_s(topics.HELICOPTER_ODOMETRY, now_s),
            uav=uav,
            uav_age_s=self._age_s(topics.UAV_ODOMETRY, now_s),
            lags_m=tuple(sorted(self._lags.items())),
            nodes={
                name: Told(health, now_s - at_s) for name, (health, at_s) in self._nodes.items()
            },
            tracks=(
                self._tracks[0].array(None if helicopter is None else helicopter.motion),
                self._tracks[1].array(None if uav is None else uav.motion),
            ),
            trend=np.array(
                [(now_s - at_s, apart) for at_s, apart in self._trend], dtype=np.float64
            ).reshape(-1, 2),
            quiet=self._quiet,
            answers=tuple(self._answers),
            is_playback=self._is_playback,
            **told,
        )

    def _age_s(self, topic: str, now_s: float) -> float:
        return now_s - self._heard_s.get(topic, -math.inf)


KEPT = {
    topics.DATUM: "datum",
    topics.PHASE: "phase",
    topics.LEG: "leg",
    topics.PREDICTION: "corner",
    topics.CLEARED: "waypoints",
    topics.UPLOADED: "uploaded",
    topics.MODE: "rule",
    topics.LAG: "lag_m",
    topics.UAV_STATE: "status",
    topics.MONITOR: "monitor",
    topics.WIND: "wind_mps",
    topics.AUTOPILOT: "parameters",
    topics.MARKS: "marks",
    topics.PATTERN: "pattern",
}
"""What is kept as it is told, by topic: the field of the snapshot."""
