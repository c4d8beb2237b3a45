"""The pre-flight checklist: what the graph can tell is ticked by itself. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from sar_bridge.console.lights import LEAST_FREE_GB
from sar_bridge.console.snapshot import LEADING, STALE_S, Snapshot
from sar_estimator.common.states import Phase

SURE_M = 15.0
MODES = ("AUTO", "GUIDED")
FAR_M = 5_000.0
BY_HAND = (
    "Altitudes agreed, and set apart",
    "RC pilot ready to take the UAV",
    "Lost-link behaviour agreed",
)
"""What only people can tell."""


@dataclass(frozen=True, slots=True)
class Item:
    """``done`` where the graph says so; ``why`` it is not, or how it is."""

    text: str
    done: bool
    why: str


def checklist(snapshot: Snapshot, free_gb: float) -> list[Item]:
    """Return the items that are ticked by what is told, in the order they are gone through."""
    return [
        _nodes(snapshot),
        _gps(snapshot),
        _leg(snapshot),
        _link(snapshot),
        _mode(snapshot),
        _parameters(snapshot),
        _failsafe(snapshot),
        _monitor(snapshot),
        _apart(snapshot),
        _recorder(snapshot, free_gb),
    ]


def _nodes(snapshot: Snapshot) -> Item:
    missing = [name for name in LEADING if snapshot.is_stale(name)]
    return Item("All nodes answer", not missing, ", ".join(missing) + " missing" if missing else "")


def _gps(snapshot: Snapshot) -> Item:
    text = "Helicopter's GPS"
    if snapshot.helicopter is None or snapshot.helicopter_age_s > STALE_S:
        return Item(text, done=False, why="no position")
    sigma_m = snapshot.helicopter.position_sigma_m
    return Item(text, sigma_m <= SURE_M, f"±{sigma_m:.1f} m, expected within {SURE_M:.0f}")


def _leg(snapshot: Snapshot) -> Item:
    cruising = snapshot.phase is Phase.CRUISE and snapshot.leg is not None
    phase = "unknown" if snapshot.phase is None else str(snapshot.phase)
    return Item("Helicopter on a leg", cruising, f"phase {phase}")


def _link(snapshot: Snapshot) -> Item:
    fresh = snapshot.status.connected and snapshot.uav_age_s <= STALE_S
    heard = "autopilot not heard" if not snapshot.status.connected else "position old"
    return Item("UAV heard", fresh, "" if fresh else heard)


def _mode(snapshot: Snapshot) -> Item:
    status = snapshot.status
    ready = status.armed and status.mode in MODES
    how = f"{'armed' if status.armed else 'not armed'}, mode {status.mode or 'unknown'}"
    return Item("UAV in the air, in AUTO or GUIDED", ready, how)


def _parameters(snapshot: Snapshot) -> Item:
    planner = snapshot.node("planner")
    warning = "" if planner is None else planner.value("autopilot")
    known = bool(snapshot.parameters)
    return Item(
        "Autopilot's parameters", known and not warning, warning or ("" if known else "not read")
    )


def _failsafe(snapshot: Snapshot) -> Item:
    values = snapshot.parameters
    on = values.get("FS_GCS_ENABL") == 1.0 and values.get("FS_LONG_ACTN") == 1.0
    return Item(
        "UAV's failsafe on",
        on,
        f"FS_LONG_TIMEOUT {values.get('FS_LONG_TIMEOUT', 0.0):g} s"
        if on
        else "expected FS_GCS_ENABL 1 and FS_LONG_ACTN 1",
    )


def _monitor(snapshot: Snapshot) -> Item:
    watching = not snapshot.is_stale("monitor") and not snapshot.monitor.watch_only
    how = f"least separation {snapshot.least_separation_m:.0f} m"
    return Item("Separation monitor on", watching, how if watching else "it does not act")


def _apart(snapshot: Snapshot) -> Item:
    apart_m = snapshot.horizontal_m
    if apart_m is None:
        return Item("Aircraft well apart", done=False, why="a position is missing")
    fits = snapshot.least_separation_m < apart_m < FAR_M
    return Item("Aircraft well apart", fits, f"{apart_m:.0f} m")


def _recorder(snapshot: Snapshot, free_gb: float) -> Item:
    told = snapshot.node("record")
    works = told is not None and not told.is_stale and not told.health.problem
    why = f"{free_gb:.1f} GB free" if works else "not recording"
    return Item("Recorder runs", works and free_gb >= LEAST_FREE_GB, why)
