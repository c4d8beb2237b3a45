"""The page's lights: receiver, link, every node, recorder and disk. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from sar_bridge.console.banner import Urgency
from sar_bridge.console.snapshot import LEADING, STALE_S, Snapshot, Told
from sar_estimator.common.states import Phase

OTHERS = ("gps", "record", "sim")
LEAST_FREE_GB = 2.0


@dataclass(frozen=True, slots=True)
class Light:
    """``name`` and ``text`` beside it; grey (IDLE) where nothing is known."""

    name: str
    urgency: Urgency
    text: str


def lights(snapshot: Snapshot, free_gb: float) -> list[Light]:
    """Return all lights; ``free_gb``: space on the recorder's disk [GB]."""
    names = [*LEADING, *(name for name in OTHERS if snapshot.node(name) is not None)]
    return [
        _receiver(snapshot),
        link(snapshot),
        *(_node(name, snapshot.node(name)) for name in names),
        *([] if snapshot.is_playback else [_disk(free_gb)]),
    ]


def _receiver(snapshot: Snapshot) -> Light:
    helicopter = snapshot.helicopter
    if helicopter is None:
        return Light("GPS", Urgency.IDLE, "no position yet")
    age_s = snapshot.helicopter_age_s
    told = snapshot.node("estimator")
    refused = "" if told is None else told.value("refused")
    parts = [f"{age_s:.1f} s old", f"±{helicopter.position_sigma_m:.1f} m"]
    if refused not in ("", "0"):
        parts.append(f"{refused} refused")
    lost = age_s > STALE_S or snapshot.phase is Phase.LOST
    return Light("GPS", Urgency.WARNING if lost else Urgency.NORMAL, ", ".join(parts))


def link(snapshot: Snapshot) -> Light:
    """Return the light of the UAV's link."""
    told = snapshot.node("bridge")
    if told is None:
        return Light("LINK", Urgency.IDLE, "no bridge yet")
    if told.is_stale or not snapshot.status.connected:
        return Light("LINK", Urgency.WARNING, told.health.problem or "bridge silent")
    parts = [f"heartbeat {told.value('heartbeat_age_s') or '?'} s"]
    if snapshot.uploaded is not None:
        parts.append(f"upload {snapshot.uploaded.upload_ms:.0f} ms")
    if told.value("radio_rssi"):
        parts.append(f"RSSI {told.value('radio_rssi')}, noise {told.value('radio_noise')}")
    return Light("LINK", Urgency.NORMAL, ", ".join(parts))


def _node(name: str, told: Told | None) -> Light:
    if told is None:
        return Light(name, Urgency.IDLE, "not heard yet")
    if told.is_stale:
        return Light(name, Urgency.WARNING, f"silent for {told.age_s:.0f} s")
    if told.health.problem:
        severe = Urgency.WARNING if told.health.severe else Urgency.CAUTION
        return Light(name, severe, told.health.problem)
    return Light(name, Urgency.NORMAL, "ok")


def _disk(free_gb: float) -> Light:
    urgency = Urgency.NORMAL if free_gb >= LEAST_FREE_GB else Urgency.CAUTION
    return Light("disk", urgency, f"{free_gb:.1f} GB free")
