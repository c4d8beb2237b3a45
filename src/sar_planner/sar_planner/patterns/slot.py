"""A place in the formation: on which side of the helicopter, and how many tracks from it. Pure."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from sar_planner.patterns.legs import PatternTerms, inside_of

SlotSide = Literal["inside", "outside", "right", "left"]
CROSS_SPACINGS = 1.4
SlotTracks = Annotated[int, Field(ge=1, le=3)]


class Slot(NamedTuple):
    """A place beside the helicopter, so many track spacings from its track.

    ``side``: inside or outside of the turn that ends a leg; or always to the helicopter's right or
    left. Where search legs lie side by side, inside is the ground side to which the pattern goes
    over, on cross legs too: beyond them.
    """

    side: SlotSide = "inside"
    tracks: int = 1

    def across_on(self, terms: PatternTerms, leg: int) -> float:
        """Return where it is on a leg (from 0) of a pattern: right positive, over the spacing.

        Beyond a cross leg it is ``CROSS_SPACINGS`` off: a UAV comes onto it ahead of the
        helicopter, and is not to pass before its nose as it stands at the cross leg's end.
        """
        if self.side in ("right", "left"):
            return self.tracks if self.side == "right" else -self.tracks
        across = (1 if self.side == "inside" else -1) * inside_of(terms.turn_after(leg))
        if terms.is_cross_leg(leg):
            return -across * (self.tracks - 1.0 + CROSS_SPACINGS)
        return across * self.tracks

    def __str__(self) -> str:
        """Return it as a crew says it."""
        return self.side if self.tracks == 1 else f"{self.side} {self.tracks}"


INSIDE = Slot()
