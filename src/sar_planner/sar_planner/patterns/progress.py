"""Which leg of its pattern the helicopter flies, and what is expected at the leg's end. Pure.

A pattern is a prior: where the helicopter turns otherwise that is followed, and counted on from.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sar_estimator.common.pose import wrap_angle
from sar_planner.patterns.legs import PatternKind, inside_of, turn_after

TURNED_RAD = math.radians(45.0)


class Expectation(NamedTuple):
    """What is expected of a leg: the turn at its end, left positive [rad].

    The UAV is inside of it. Where legs lead back and forth it changes over behind the helicopter as
    that turns from a cross leg onto a search leg, and so searches the strip of the tracks to come
    on all of them.
    """

    turn_rad: float

    @property
    def slot_side(self) -> int:
        """The UAV's side: 1 to the helicopter's right, -1 to its left."""
        return inside_of(self.turn_rad)


def expectation(kind: PatternKind, side: int, leg: int) -> Expectation:
    """Return what is expected of a leg (from 0) of a pattern that first turns to ``side``."""
    return Expectation(turn_after(kind, side, leg))


def sides_of(kind: PatternKind, side: int, first: int, count: int) -> list[int]:
    """Return the UAV's sides on so many legs of a pattern from leg ``first`` (from 0) on."""
    return [expectation(kind, side, leg).slot_side for leg in range(first, first + count)]


class Progress:
    """Counts the legs that were flown. ``leg``: the one being flown, from 0."""

    def __init__(self, kind: PatternKind, side: int) -> None:
        """Begin on the first."""
        self._kind, self._side = kind, side
        self.leg = 0
        self._heading_rad: float | None = None

    def fly(self, heading_rad: float) -> None:
        """Take the heading of the leg being flown [rad]: another one is the next."""
        before, self._heading_rad = self._heading_rad, heading_rad
        if before is not None and self._is_other(heading_rad, before):
            self.leg += 1

    @property
    def here(self) -> Expectation:
        """What is expected of the leg being flown."""
        return expectation(self._kind, self._side, self.leg)

    def slot_side(self, heading_rad: float) -> int:
        """Return the UAV's side on a leg of a heading [rad]: this one, or the one to come."""
        now = self._heading_rad
        ahead = now is not None and self._is_other(heading_rad, now)
        return expectation(self._kind, self._side, self.leg + ahead).slot_side

    @staticmethod
    def _is_other(one_rad: float, other_rad: float) -> bool:
        return abs(wrap_angle(one_rad - other_rad)) > TURNED_RAD
