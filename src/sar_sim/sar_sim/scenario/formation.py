"""The UAVs of a formation: names, slots, where each starts, and what flies it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import CHECKED, Word
from sar_planner.patterns.slot import Slot, SlotSide, SlotTracks

NAME = re.compile(r"[a-z][a-z0-9_]*")
SystemId = Annotated[int, Field(ge=1, le=239)]


@dataclass(frozen=True, slots=True, config=CHECKED)
class Member:
    """One UAV of a formation.

    ``name``: the namespace of its planner, monitor and bridge; none where there is one UAV only.
    ``side``, ``tracks``: its slot: inside or outside of the turns, or always right or left of the
    helicopter; and how many track spacings from its track. ``lag_m``: with which it starts, None
    for the scenario's. ``autopilot``: URL of its autopilot, empty where it is simulated.
    ``system_id``: its MAVLink system; several may share one link.
    """

    name: Word = ""
    side: SlotSide = "inside"
    tracks: SlotTracks = 1
    lag_m: float | None = None
    autopilot: str = ""
    system_id: SystemId = 1

    @property
    def slot(self) -> Slot:
        """Its place beside the helicopter."""
        return Slot(self.side, self.tracks)


def fault_of(members: Sequence[Member]) -> tuple[str, object, str] | None:
    """Return the key, the value and what was expected, where a formation cannot be flown."""
    if not members:
        return "formation", [], "one UAV or more"
    alone = len(members) == 1
    for i, member in enumerate(members):
        if not (NAME.fullmatch(member.name) or (alone and not member.name)):
            expected = "a name of small letters, digits and underscores"
            return f"formation[{i}].name", member.name, expected
    for key in ("name", "slot"):
        found = Counter(getattr(member, key) for member in members)
        twice = [value for value, count in found.items() if count > 1]
        if twice:
            return f"formation {key}", str(twice[0]), "each only once"
    reached = Counter((one.autopilot, one.system_id) for one in members if one.autopilot)
    for (url, system), count in reached.items():
        if count > 1:
            return "formation autopilot", f"{url}, system {system}", "another system_id on one link"
    return None
