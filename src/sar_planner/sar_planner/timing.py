"""How late the planner is, and what it therefore plans with. Pure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

from sar_estimator.common.lateness import Punctuality, counted_s
from sar_planner.parameters.mission import MissionParameters

STEPS_A_SECOND = 10
"""What is planned with changes in steps: most decisions are taken with the same."""


class Plans(Protocol):
    """What plans with the time from a decision to the list being flown."""

    def set_reaction(self, reaction_s: float) -> None:
        """Plan with another one [s]."""
        ...


class Timing(Punctuality):
    """From a fix to its use in a decision, and from a decision to the list being flown."""

    def __init__(self, mission: MissionParameters, planning: Sequence[Plans] = ()) -> None:
        """Have measured nothing; ``planning`` plans with what the parameters say."""
        super().__init__()
        self._planning, self._planned_s = planning, mission.reaction_s
        self._least_s, self._most_s = mission.reaction_s, mission.most_reaction_s
        self._late_fix_s = mission.late_fix_s

    def reaction_s(self, now_s: float) -> float:
        """Return the time [s] from a decision to the list being flown that is planned with.

        ``reaction_s`` of the parameters, or what was measured where that is clearly more: no more
        than ``most_reaction_s`` of that.
        """
        measured_s = math.ceil(STEPS_A_SECOND * self.lists.value_s(now_s)) / STEPS_A_SECOND
        return counted_s(measured_s, self._least_s, self._most_s)

    def adapt(self, now_s: float) -> None:
        """Have everything planned with the time of now, where that is another."""
        reaction_s = self.reaction_s(now_s)
        if reaction_s != self._planned_s:
            self._planned_s = reaction_s
            for one in self._planning:
                one.set_reaction(reaction_s)

    def problems(self, now_s: float) -> str:
        """Return what is too late to be planned for, empty where nothing is."""
        found, late_s = [self.problem(now_s, self._late_fix_s)], self.lists.value_s(now_s)
        if late_s > self._most_s > 0.0:
            most = f"planned with {self._most_s:g} s at most"
            found.append(f"lists are flown {late_s:.1f} s after their decision: {most}")
        return "; ".join(one for one in found if one)
