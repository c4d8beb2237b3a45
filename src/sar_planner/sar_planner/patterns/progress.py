"""Which leg of its pattern the helicopter flies, and what is expected at the leg's end. Pure.

A pattern is a prior: where the helicopter turns otherwise that is followed, and counted on from.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sar_estimator.common.pose import wrap_angle
from sar_planner.patterns.legs import PatternTerms
from sar_planner.patterns.slot import INSIDE, Slot

TURNED_RAD = math.radians(45.0)


class Expectation(NamedTuple):
    """What is expected of a leg: the turn at its end, left positive [rad]; and its length [m].

    The length is 0 where it is not known.
    """

    turn_rad: float
    length_m: float = 0.0


def expectation(terms: PatternTerms, leg: int) -> Expectation:
    """Return what is expected of a leg (from 0) of a pattern."""
    return Expectation(terms.turn_after(leg), terms.length_of(leg))


def places_of(terms: PatternTerms, first: int, count: int, slot: Slot = INSIDE) -> list[float]:
    """Return where a slot is on so many legs of a pattern from leg ``first`` (from 0) on.

    Over the track spacing, right of the helicopter positive.
    """
    return [slot.across_on(terms, leg) for leg in range(first, first + count)]


class Progress:
    """Counts the legs that were flown. ``leg``: the one being flown, from 0. ``slot``: kept."""

    def __init__(self, terms: PatternTerms, slot: Slot = INSIDE) -> None:
        """Begin on the first."""
        self._terms = terms
        self.slot = slot
        self.leg = 0
        self._heading_rad: float | None = None

    def fly(self, heading_rad: float) -> None:
        """Take the heading of the leg being flown [rad]: another one is the next."""
        before, self._heading_rad = self._heading_rad, heading_rad
        if before is not None and self._is_other(heading_rad, before):
            self.leg += 1

    @property
    def stays_inside(self) -> bool:
        """Whether the slot is inside of every turn of the pattern, on the same side."""
        return self._terms.turns_one_way and self.slot.side == "inside"

    @property
    def here(self) -> Expectation:
        """What is expected of the leg being flown."""
        return expectation(self._terms, self.leg)

    @property
    def next(self) -> Expectation:
        """What is expected of the leg after it."""
        return expectation(self._terms, self.leg + 1)

    def leg_on(self, heading_rad: float) -> int:
        """Return the leg (from 0) that has a heading [rad]: this one, or the one to come."""
        now = self._heading_rad
        return self.leg + (now is not None and self._is_other(heading_rad, now))

    def across(self, heading_rad: float) -> float:
        """Return where the slot is on a leg of a heading [rad]; see ``Slot.across_on``."""
        return self.slot.across_on(self._terms, self.leg_on(heading_rad))

    def is_cross_leg(self, heading_rad: float) -> bool:
        """Whether a leg of a heading [rad] leads from one search leg to the next."""
        return self._terms.is_cross_leg(self.leg_on(heading_rad))

    @staticmethod
    def _is_other(one_rad: float, other_rad: float) -> bool:
        return abs(wrap_angle(one_rad - other_rad)) > TURNED_RAD
