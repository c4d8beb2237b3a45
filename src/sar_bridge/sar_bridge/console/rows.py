"""The page's rows: what matters of each UAV, where there are several. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from sar_bridge.console.banner import SHAPES, Banner, Urgency
from sar_bridge.console.figures import NONE, Figure, figures
from sar_bridge.console.lights import link
from sar_bridge.console.snapshot import Snapshot


@dataclass(frozen=True, slots=True)
class Row:
    """``name`` of the UAV, how urgent its alert is, and the cells beside it."""

    name: str
    urgency: Urgency
    cells: tuple[Figure, ...]


def row(snapshot: Snapshot, alert: Banner) -> Row:
    """Return a UAV's row, always the same names in the same order; ``alert``: its banner."""
    known = {one.name: one for one in figures(snapshot)}
    no_bridge = snapshot.is_stale("bridge")
    seen = " (acknowledged)" if alert.acknowledged else ""
    return Row(
        snapshot.callsign or "UAV",
        alert.urgency,
        (
            Figure("slot", snapshot.slot or NONE, snapshot.is_stale("planner")),
            known["rule"],
            known["lag L"],
            known["apart"],
            Figure("alert", f"{SHAPES[alert.urgency]} {alert.state}{seen}", is_stale=False),
            known["UAV mode"],
            Figure("link", link(snapshot).text, no_bridge),
            Figure("list", _list(snapshot), no_bridge),
        ),
    )


def _list(snapshot: Snapshot) -> str:
    """Return how long the UAV's list is, and how far it has come."""
    waypoints, uploaded = snapshot.waypoints, snapshot.uploaded
    if waypoints is None or len(waypoints.points) == 0:
        return NONE
    taken = uploaded is not None and uploaded.list_id == waypoints.list_id
    flown = "flown" if snapshot.status.tracking_list else "accepted"
    return f"{len(waypoints.points)} points, {flown if taken else 'sent'}"
