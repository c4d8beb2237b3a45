"""Which leg of its pattern the helicopter flies, and what is expected at the leg's end. Pure.

A pattern is a prior: where the helicopter turns otherwise that is followed, and counted on from.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sar_estimator.common.pose import Pose, wrap_angle
from sar_planner.patterns.legs import PatternTerms, inside_of
from sar_planner.patterns.slot import INSIDE, Slot

TURNED_RAD = math.radians(45.0)
LEAST_CROSSING = 0.3
"""The sine of the angle at which two lines must cross, for their crossing to be believed."""


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


def begin_of(foot: Pose, left: Pose) -> Pose:
    """Return where a leg began: where its line crosses that of the leg that was left.

    Each is given by a foot on it. Where they hardly cross, it is abeam the foot on the one left.
    """
    sine = math.sin(foot.heading_rad - left.heading_rad)
    across_m = foot.across(left.x_m, left.y_m)
    corner = left.offset(across_m / sine if abs(sine) > LEAST_CROSSING else 0.0)
    return foot.offset(foot.along(corner.x_m, corner.y_m))


class Progress:
    """Counts the legs that were flown.

    ``terms``: of the pattern. ``leg``: the one being flown, from 0. ``begun``: where that began,
    with its heading as it is flown; None before any. ``slot``: kept.
    """

    def __init__(self, terms: PatternTerms, slot: Slot = INSIDE) -> None:
        """Begin on the first."""
        self.terms = terms
        self.slot = slot
        self.leg = 0
        self._foot: Pose | None = None
        self._left: Pose | None = None
        self.begun: Pose | None = None
        self._first_m: tuple[float, float] | None = None

    def see(self, x_m: float, y_m: float) -> None:
        """Take where the helicopter is [m]: where it was first, the first leg began."""
        self._first_m = self._first_m or (x_m, y_m)

    def fly(self, foot: Pose) -> None:
        """Take a foot on the leg being flown: one with another heading is on the next."""
        before, self._foot = self._foot, foot
        if before is None:
            self._left = Pose(*(self._first_m or foot[:2]), foot.heading_rad)
        elif self._is_other(foot.heading_rad, before.heading_rad):
            self._left = before
            self.leg += 1
        if self._left is not None:
            self.begun = begin_of(foot, self._left)

    @property
    def stays_inside(self) -> bool:
        """Whether the slot is inside of every turn of the pattern, on the same side."""
        return self.terms.turns_one_way and self.slot.side == "inside"

    @property
    def here(self) -> Expectation:
        """What is expected of the leg being flown."""
        return expectation(self.terms, self.leg)

    @property
    def next(self) -> Expectation:
        """What is expected of the leg after it."""
        return expectation(self.terms, self.leg + 1)

    def leg_on(self, heading_rad: float) -> int:
        """Return the leg (from 0) that has a heading [rad]: this one, or the one to come."""
        now = self._foot
        return self.leg + (now is not None and self._is_other(heading_rad, now.heading_rad))

    def across(self, heading_rad: float) -> float:
        """Return where the slot is on a leg of a heading [rad]; see ``Slot.across_on``."""
        return self.slot.across_on(self.terms, self.leg_on(heading_rad))

    def stays_outside(self, heading_rad: float) -> bool:
        """Whether the slot is outside of the turn that ends a leg of a heading [rad], and after it.

        Not beyond a cross leg, onto which a UAV comes ahead.
        """
        leg = self.leg_on(heading_rad)
        if self.terms.is_cross_leg(leg) and self.slot.side == "inside":
            return False
        inside = inside_of(self.terms.turn_after(leg))
        return all(inside * self.slot.across_on(self.terms, at) < 0.0 for at in (leg, leg + 1))

    def is_cross_leg(self, heading_rad: float) -> bool:
        """Whether a leg of a heading [rad] leads from one search leg to the next."""
        return self.terms.is_cross_leg(self.leg_on(heading_rad))

    @staticmethod
    def _is_other(one_rad: float, other_rad: float) -> bool:
        return abs(wrap_angle(one_rad - other_rad)) > TURNED_RAD
