"""The page's banner: the one thing that matters most now, why, and what to do. Pure."""

from __future__ import annotations

import enum
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from sar_bridge.console.snapshot import LEADING, OWN, STALE_S, Snapshot
from sar_estimator.common.lateness import LATE
from sar_estimator.common.states import Phase

END_OTHERS = "End what else runs on this laptop."
FIGURES = re.compile(r"-?[\d.]+")
CRUISING = ("leg", "rejoin", "hold", "orbit")


class Urgency(enum.IntEnum):
    """How urgent it is; each has a colour and a shape."""

    IDLE = 0
    NORMAL = 1
    CAUTION = 2
    WARNING = 3


SHAPES = {
    Urgency.IDLE: "■",
    Urgency.NORMAL: "●",
    Urgency.CAUTION: "◆",
    Urgency.WARNING: "▲",
}
NAMES = {
    Urgency.IDLE: "idle",
    Urgency.NORMAL: "normal",
    Urgency.CAUTION: "caution",
    Urgency.WARNING: "warning",
}


@dataclass(frozen=True, slots=True)
class Banner:
    """``state`` in a few words, ``reason`` as it was told, ``action``: what to do.

    ``is_shared``: whether it is the same for all UAVs; else ``of``: the one that it is of, empty
    for one without a name.
    """

    urgency: Urgency
    state: str
    reason: str = ""
    action: str = ""
    acknowledged: bool = False
    is_shared: bool = False
    of: str = ""

    @property
    def title(self) -> str:
        """Its state, and whose it is where there are others."""
        return f"{self.of}: {self.state}" if self.of else self.state

    @property
    def key(self) -> str:
        """What it is about, whatever its figures are: by which it is acknowledged."""
        return f"{self.of}|" + FIGURES.sub("", f"{self.state}|{self.reason}")

    @property
    def sounds(self) -> bool:
        """Whether it is to be heard."""
        return self.urgency >= Urgency.CAUTION and not self.acknowledged


def banner(snapshot: Snapshot) -> Banner:
    """Return what matters most; the urgent before the rest, in the order of the checks."""
    found = max(_findings(snapshot), key=lambda one: one.urgency)
    found = replace(found, of="" if found.is_shared else snapshot.callsign)
    return replace(found, acknowledged=found.key == snapshot.quiet)


def worst(banners: Iterable[Banner]) -> Banner:
    """Return the most urgent of several UAVs' banners, before those that are acknowledged."""
    return max(banners, key=lambda one: (one.urgency, one.sounds))


def _findings(snapshot: Snapshot) -> Iterator[Banner]:
    yield from _separation(snapshot)
    yield from _nodes(snapshot)
    yield from _aircraft(snapshot)
    yield from _planner(snapshot)
    yield _ordinary(snapshot)


def _separation(snapshot: Snapshot) -> Iterator[Banner]:
    """Tell what the monitor says."""
    monitor = snapshot.monitor
    if snapshot.is_stale("monitor"):
        return
    if monitor.too_near:
        yield Banner(Urgency.CAUTION, "TOO NEAR", monitor.too_near, "Look out for the UAV.")
    if monitor.adsb:
        do = "Check the GPS receiver: the UAV is led by it."
        yield Banner(Urgency.CAUTION, "HELICOPTER POSITION", monitor.adsb, do)
    if monitor.alert == "none":
        return
    told = snapshot.node("monitor")
    reason = monitor.reason or (told.health.problem if told is not None else "")
    if monitor.alert == "escape":
        do = "Hold course and speed. The UAV clears by itself; RETURN HOME if it does not."
        yield Banner(Urgency.WARNING, "UAV SENT AWAY", reason, do)
    elif monitor.alert == "warning":
        do = "Look out. Do not turn towards the UAV."
        yield Banner(Urgency.WARNING, "SEPARATION", reason, do)
    else:
        yield Banner(Urgency.CAUTION, "SEPARATION", reason, "Look out for the UAV.")


def _nodes(snapshot: Snapshot) -> Iterator[Banner]:
    """Tell of nodes that were heard, and are not any more."""
    urgency = Urgency.WARNING if snapshot.engaged else Urgency.CAUTION
    for name in LEADING:
        told = snapshot.node(name)
        if told is not None and told.is_stale and not snapshot.is_playback:
            reason = f"node {name} silent for {told.age_s:.0f} s"
            do = "It is started again by itself. Be ready to take the UAV by its RC."
            yield Banner(urgency, "SYSTEM", reason, do, is_shared=name not in OWN)


def _aircraft(snapshot: Snapshot) -> Iterator[Banner]:
    """Tell of GPS and link."""
    urgency = Urgency.WARNING if snapshot.engaged else Urgency.CAUTION
    if snapshot.phase is Phase.LOST or (
        snapshot.helicopter is not None and snapshot.helicopter_age_s > STALE_S
    ):
        do = "Check the receiver. Fly straight on; the UAV goes out of the way."
        reason = _problem(snapshot, "estimator")
        yield Banner(urgency, "HELICOPTER GPS LOST", reason, do, is_shared=True)
    bridge = snapshot.node("bridge")
    if bridge is not None and not bridge.is_stale and not snapshot.status.connected:
        do = "Check the radio. The UAV's own failsafe acts."
        yield Banner(urgency, "UAV LINK LOST", bridge.health.problem, do)
    elif snapshot.uav is not None and snapshot.uav_age_s > STALE_S and snapshot.status.connected:
        reason = f"no position of the UAV for {snapshot.uav_age_s:.0f} s"
        yield Banner(urgency, "UAV POSITION LOST", reason, "Check the radio.")


def _planner(snapshot: Snapshot) -> Iterator[Banner]:
    """Tell what keeps the UAV from its place, and what else is told of."""
    problem = _problem(snapshot, "planner")
    if problem.startswith("released"):
        do = "Somebody has the UAV. ENGAGE when it may be led again."
        yield Banner(Urgency.CAUTION, "UAV RELEASED", problem, do)
    elif problem.startswith(LATE):
        yield Banner(Urgency.CAUTION, "LAPTOP LATE", problem, END_OTHERS)
    elif problem:
        yield Banner(Urgency.CAUTION, "FORMATION", problem, "")
    for name, told in sorted(snapshot.nodes.items()):
        if name != "planner" and not told.is_stale and told.health.problem:
            state = "RECORDER" if name == "record" else name.upper()
            shared, do = name not in OWN, ""
            if told.health.problem.startswith(LATE):
                state, do = "LAPTOP LATE", END_OTHERS
            yield Banner(Urgency.CAUTION, state, told.health.problem, do, is_shared=shared)


def _problem(snapshot: Snapshot, name: str) -> str:
    told = snapshot.node(name)
    return "" if told is None or told.is_stale else told.health.problem


def _ordinary(snapshot: Snapshot) -> Banner:
    if not snapshot.nodes:
        return Banner(Urgency.IDLE, "WAITING", "nothing heard yet", "")
    if not snapshot.engaged:
        return Banner(Urgency.IDLE, "NOT ENGAGED", "", "Go through the checklist, then ENGAGE.")
    what = {
        "leg": "IN FORMATION",
        "rejoin": "REJOINING",
        "hold": "HOLDING",
        "orbit": "ORBITING THE MARK",
    }.get(snapshot.rule, f"CORNER, RULE {snapshot.rule}")
    return Banner(Urgency.NORMAL, what, "", "")
