"""The legs of the search patterns that a helicopter flies, by the manual's own terms. Pure.

IAMSAR manual, volume II, chapter 5; U.S. Coast Guard Addendum, appendix H: expanding square (SS),
sector (VS), parallel track (PS), creeping line (CS), track line single and return (TS). A human
flies them: lengths and turns are what is expected, never what is certain.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Literal, NamedTuple

import numpy as np

from sar_estimator.common.checked import Side
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import FloatArray

PatternKind = Literal[
    "expanding_square",
    "sector",
    "parallel_track",
    "creeping_line",
    "track_line",
    "track_line_return",
    "none",
]
RIGHT_ANGLE_RAD = 0.5 * math.pi
MOST_LEGS = 40
SECTOR_RAD = math.radians(120.0)


CORNERS: dict[str, int] = {"track_line": 0, "track_line_return": 2}
"""How many corners a pattern has, of those that have a number of their own."""


class Leg(NamedTuple):
    """A leg: its length [m], and the turn at its end, left positive [rad]; 0 after the last."""

    length_m: float
    turn_rad: float


class PatternTerms(NamedTuple):
    """A pattern by the manual's terms, as far as they are known.

    ``side``: to which its first leg ends, 1 right, -1 left. ``leg_m``: the first leg of an
    expanding square, the radius of a sector search, the search legs of the others; ``spacing_m``:
    between the helicopter's neighbouring tracks; 0 for not known.
    """

    kind: PatternKind = "expanding_square"
    side: Side = 1
    leg_m: float = 0.0
    spacing_m: float = 0.0

    def turn_after(self, leg: int) -> float:
        """Return the turn at the end of a leg (from 0), left positive [rad]; see ``legs_of``."""
        back = self.kind in ("parallel_track", "creeping_line") and leg // 2 % 2 == 1
        back = back or (self.kind == "track_line_return" and leg > 1)
        return (self.side if back else -self.side) * self.angle_rad

    @property
    def angle_rad(self) -> float:
        """The size of its turns [rad]."""
        return SECTOR_RAD if self.kind == "sector" else RIGHT_ANGLE_RAD

    @property
    def turns_one_way(self) -> bool:
        """Whether all its turns are to one side."""
        return self.kind in ("expanding_square", "sector", "none")

    def is_cross_leg(self, leg: int) -> bool:
        """Whether a leg (from 0) leads from one search leg to the next."""
        return not self.turns_one_way and leg % 2 == 1

    def lengths_m(self) -> tuple[float, ...]:
        """Return the lengths of more legs than are flown [m], none where they are not known."""
        return (
            tuple(self.length_of(leg) for leg in range(MOST_LEGS))
            if self.length_of(0) > 0.0
            else ()
        )

    def length_of(self, leg: int) -> float:
        """Return the length expected of a leg (from 0) [m], 0 where it is not known."""
        if self.leg_m <= 0.0 or self.kind == "none":
            return 0.0
        if self.kind == "expanding_square":
            return self.leg_m + (leg // 2) * self.spacing_m
        if self.kind == "sector":  # radius, chord, diameter through the datum, chord, diameter
            return self.leg_m if leg == 0 or leg % 2 == 1 else 2.0 * self.leg_m
        return self.leg_m if leg % 2 == 0 else self.spacing_m


SQUARE = PatternTerms()


def inside_of(turn_rad: float) -> Side:
    """Return which side is inside of a turn: 1 right, -1 left."""
    return -1 if turn_rad > 0.0 else 1


def legs_of(
    kind: PatternKind,
    *,
    leg_m: float,
    spacing_m: float,
    corners: int,
    side: Side,
    last_m: float | None = None,
) -> list[Leg]:
    """Return the legs of a pattern with so many corners; ``side``: 1 first to the right, -1 left.

    ``leg_m``: the first leg of an expanding square, the radius of a sector search, the search legs
    of the others. ``spacing_m``: between the helicopter's neighbouring tracks. ``last_m``: the last
    leg, where it is another length. Raises ``ValueError`` for corners that a pattern has not, and
    for none.
    """
    if kind == "none":
        raise ValueError("pattern none: expected one that a helicopter can be simulated in")
    wanted = CORNERS.get(kind, corners)
    if corners != wanted:
        raise ValueError(f"corners = {corners}: expected {wanted} in a {kind}")
    terms = PatternTerms(kind, side, leg_m, spacing_m)
    legs = [Leg(terms.length_of(leg), terms.turn_after(leg)) for leg in range(corners)]
    last = terms.length_of(corners)
    if kind == "sector":  # back to the datum
        last = leg_m
    return [*legs, Leg(last if last_m is None else last_m, 0.0)]


def ends_of(legs: Iterable[Leg], begun: Pose) -> FloatArray:
    """Return where each leg ends when the first begins at a pose, shape (n, 2) [m]."""
    at, found = begun, []
    for length_m, turn_rad in legs:
        at = at.offset(length_m)
        found.append(at[:2])
        at = at._replace(heading_rad=at.heading_rad + turn_rad)
    return np.array(found, dtype=np.float64).reshape(-1, 2)
