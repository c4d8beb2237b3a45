"""What a slot does at every corner of a pattern: from which place to which, and by which rules."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sar_planner.parameters.corner import CornerParameters
from sar_planner.patterns.legs import PatternTerms, inside_of
from sar_planner.patterns.slot import Slot
from sar_planner.rules.deadbeat_rules import DeadbeatRules
from sar_planner.rules.outside_rules import OutsideRules
from sar_planner.rules.paper_rules import NoPathError


@dataclass(frozen=True, slots=True)
class PatternCorner:
    """A corner: its turn, left positive [rad], and the slot's places [m] inside of it positive."""

    number: int
    turn_rad: float
    from_m: float
    to_m: float

    def rules(self, parameters: CornerParameters) -> DeadbeatRules | OutsideRules:
        """Return the rules by which it is flown; ``parameters``: with the slot's own distance.

        Raises ``NoPathError`` where there are none: from the outside of a turn to its inside.
        """
        size_rad = abs(self.turn_rad)
        if self.to_m < 0.0:
            from_m, to_m = -self.from_m, -self.to_m
            return OutsideRules(parameters, size_rad, from_m=from_m, to_m=to_m)
        if self.from_m < 0.0:
            raise NoPathError("from the outside of the turn to its inside: rejoin")
        return DeadbeatRules(parameters, turn_rad=size_rad)

    def __str__(self) -> str:
        """Return the turn and both places."""
        side = "right" if inside_of(self.turn_rad) > 0 else "left"
        places = (
            f"{abs(place_m):.0f} {'inside' if place_m > 0.0 else 'outside'}"
            for place_m in (self.from_m, self.to_m)
        )
        return f"{math.degrees(abs(self.turn_rad)):.0f} {side}, {' to '.join(places)}"

    @property
    def kind(self) -> tuple[float, float, float]:
        """What makes it another corner for the rules than one to the other side."""
        return abs(self.turn_rad), self.from_m, self.to_m


def corners_of(
    terms: PatternTerms, slot: Slot, spacing_m: float, count: int
) -> Iterator[PatternCorner]:
    """Yield the first corners of a pattern as a slot sees them."""
    for leg in range(count):
        turn_rad = terms.turn_after(leg)
        scale = inside_of(turn_rad) * spacing_m
        from_m, to_m = (scale * slot.across_on(terms, at) for at in (leg, leg + 1))
        yield PatternCorner(leg + 1, turn_rad, from_m, to_m)


def line_of(
    rules: DeadbeatRules | OutsideRules, lag_m: float, lead_m: float, separation_m: float
) -> str:
    """Return rule, L(k+1) and closest approach for a lag; dashes where no path is safe."""
    try:
        plan = rules.plan(lag_m, lead_m=lead_m, separation_m=separation_m)
    except NoPathError:
        return "--"
    return f"{plan.rule} {plan.next_lag_m:8.1f} {rules.closest(plan.path).distance_m:8.1f}"
