"""What the page shows at a time, as plain values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import (
    Health,
    HelicopterReport,
    Mark,
    MonitorReport,
    UavReport,
    UavStatus,
    Uploaded,
    WaypointList,
)
from sar_estimator.common.states import CornerEstimate, FloatArray, LegEstimate, Phase

STALE_S = 2.0
NODE_STALE_S = 3.0
"""Nodes tell how they are once a second, some 1.2 s apart at most."""
LEADING = ("estimator", "planner", "monitor", "bridge")
"""The nodes without which the UAV is not led."""
OWN = frozenset(LEADING[1:])
"""Those of them that each UAV has for itself."""
EMPTY: FloatArray = np.empty((0, 2))


def slot_words(slot: str) -> tuple[str, int]:
    """Return a slot's side and tracks, as a planner names it: ``left``, ``right 2``."""
    side, _, tracks = slot.partition(" ")
    return side, int(tracks) if tracks.isdecimal() else 1


@dataclass(frozen=True)
class Told:
    """How a node was when it told so, and how long ago that is [s]."""

    health: Health
    age_s: float

    @property
    def is_stale(self) -> bool:
        """Whether it has said nothing for too long."""
        return self.age_s > NODE_STALE_S

    def value(self, name: str) -> str:
        """Return a figure as it was told, empty where it was not."""
        return str(self.health.values.get(name, ""))


@dataclass(frozen=True)
class Snapshot:
    """All that is known of a UAV at ``now_s`` [s], and how old the aircraft's positions are [s].

    ``callsign``: of the UAV, empty where there is one alone. ``tracks``: helicopter's and UAV's,
    each of shape (n, 2) [m]. ``trend``: times before now, and horizontal separations, shape (n, 2)
    [s, m]. ``pattern``: the corners that are still expected, the end of the leg being flown first,
    shape (n, 2) [m]. ``quiet``: the banner's text that was acknowledged. ``answers``: what was
    asked for last, and what was answered.
    """

    callsign: str = ""
    now_s: float = 0.0
    datum: Datum | None = None
    helicopter: HelicopterReport | None = None
    helicopter_age_s: float = math.inf
    uav: UavReport | None = None
    uav_age_s: float = math.inf
    phase: Phase | None = None
    leg: LegEstimate | None = None
    corner: CornerEstimate | None = None
    waypoints: WaypointList | None = None
    uploaded: Uploaded | None = None
    rule: str = ""
    lag_m: float | None = None
    lags_m: tuple[tuple[int, float], ...] = ()
    status: UavStatus = field(default_factory=UavStatus)
    monitor: MonitorReport = field(default_factory=MonitorReport)
    wind_mps: tuple[float, float] | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    nodes: Mapping[str, Told] = field(default_factory=dict)
    tracks: tuple[FloatArray, FloatArray] = (EMPTY, EMPTY)
    trend: FloatArray = field(default_factory=lambda: EMPTY)
    quiet: str = ""
    answers: tuple[str, ...] = ()
    marks: tuple[Mark, ...] = ()
    pattern: FloatArray = field(default_factory=lambda: EMPTY)
    is_playback: bool = False

    @property
    def engaged(self) -> bool:
        """Whether the planner leads the UAV."""
        return self.rule not in ("", "idle")

    @property
    def slot(self) -> str:
        """Where the UAV's place is, as its planner names it: ``left``, ``right 2``; else empty."""
        planner = self.node("planner")
        return "" if planner is None else planner.value("slot")

    @property
    def horizontal_m(self) -> float | None:
        """The horizontal separation [m]."""
        if self.helicopter is None or self.uav is None:
            return None
        one, other = self.helicopter.motion, self.uav.motion
        return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)

    @property
    def vertical_m(self) -> float | None:
        """How much higher the UAV is than the helicopter [m], NaN where that is not known."""
        if self.uav is None or self.helicopter is None:
            return None
        return self.uav.altitude_m - self.helicopter.altitude_m

    def node(self, name: str) -> Told | None:
        """Return what a node has told; None where it was never heard."""
        return self.nodes.get(name)

    def is_stale(self, name: str) -> bool:
        """Whether a node is missing, or has said nothing for too long."""
        told = self.nodes.get(name)
        return told is None or told.is_stale

    @property
    def least_separation_m(self) -> float:
        """The least separation that the monitor keeps [m]; 0 where that is not known."""
        return self.monitor.thresholds.get("min_separation_m", 0.0)
