"""The legs of the search patterns that a helicopter flies, by the manual's own terms. Pure.

IAMSAR manual, volume II, chapter 5; U.S. Coast Guard Addendum, appendix H: expanding square (SS),
sector (VS), parallel track (PS), creeping line (CS), track line single and return (TS). A human
flies them: lengths and turns are what is expected, never what is certain.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

PatternKind = Literal[
    "expanding_square",
    "sector",
    "parallel_track",
    "creeping_line",
    "track_line",
    "track_line_return",
]
RIGHT_ANGLE_RAD = 0.5 * math.pi
SECTOR_RAD = math.radians(120.0)


CORNERS: dict[str, int] = {"track_line": 0, "track_line_return": 2}
"""How many corners a pattern has, of those that have a number of their own."""


class Leg(NamedTuple):
    """A leg: its length [m], and the turn at its end, left positive [rad]; 0 after the last."""

    length_m: float
    turn_rad: float


def turn_after(kind: PatternKind, side: int, leg: int) -> float:
    """Return the turn at the end of a leg (from 0), left positive [rad]; see ``legs_of``."""
    if kind == "sector":
        return -side * SECTOR_RAD
    back = kind in ("parallel_track", "creeping_line") and leg // 2 % 2 == 1
    back = back or (kind == "track_line_return" and leg > 1)
    return (side if back else -side) * RIGHT_ANGLE_RAD


def inside_of(turn_rad: float) -> int:
    """Return which side is inside of a turn: 1 right, -1 left."""
    return -1 if turn_rad > 0.0 else 1


def legs_of(
    kind: PatternKind,
    *,
    leg_m: float,
    spacing_m: float,
    corners: int,
    side: int,
    last_m: float | None = None,
) -> list[Leg]:
    """Return the legs of a pattern with so many corners; ``side``: 1 first to the right, -1 left.

    ``leg_m``: the first leg of an expanding square, the radius of a sector search, the search legs
    of the others. ``spacing_m``: between the helicopter's neighbouring tracks. ``last_m``: the last
    leg, where it is another length. Raises ``ValueError`` for corners that a pattern has not.
    """
    wanted = CORNERS.get(kind, corners)
    if corners != wanted:
        raise ValueError(f"corners = {corners}: expected {wanted} in a {kind}")
    lengths = {
        "expanding_square": _square,
        "sector": _sector,
    }.get(kind, _back_and_forth)(corners, leg_m, spacing_m)
    if last_m is not None:
        lengths[-1] = last_m
    turns = [turn_after(kind, side, leg) for leg in range(corners)]
    return [Leg(length, turn) for length, turn in zip(lengths, [*turns, 0.0], strict=True)]


def _square(corners: int, leg_m: float, spacing_m: float) -> list[float]:
    """Return first, first, + spacing, + spacing, + 2 spacing, ..."""
    return [leg_m + (i // 2) * spacing_m for i in range(corners + 1)]


def _sector(corners: int, leg_m: float, _spacing_m: float) -> list[float]:
    """Return radius, chord, diameter through the datum, chord, diameter, ..., back to the datum."""
    lengths = [leg_m if i == 0 or i % 2 == 1 else 2.0 * leg_m for i in range(corners + 1)]
    lengths[-1] = leg_m
    return lengths


def _back_and_forth(corners: int, leg_m: float, spacing_m: float) -> list[float]:
    """Return search leg, cross leg, search leg, ..."""
    return [leg_m if i % 2 == 0 else spacing_m for i in range(corners + 1)]
