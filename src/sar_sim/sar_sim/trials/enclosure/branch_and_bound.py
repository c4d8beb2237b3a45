"""The least value of a function over boxes, enclosed: best-first branch and bound.

A box is a product of intervals of *shares*, each within 0 and 1. They come of halving, so that
their bounds are exact. A look at a box gives a value that is nowhere undercut in it, and one that
is attained.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from flint import arb

from sar_sim.trials.enclosure.jets import Jet, Slopes


class Box(NamedTuple):
    """Shares from ``low`` to ``high``, each of shape (n,), in a part of what is looked at."""

    part: int
    low: tuple[float, ...]
    high: tuple[float, ...]

    @property
    def middle(self) -> tuple[float, ...]:
        """The shares in the middle, shape (n,)."""
        return tuple(0.5 * (a + b) for a, b in zip(self.low, self.high, strict=True))

    @property
    def radii(self) -> tuple[float, ...]:
        """How far the bounds are from the middle, shape (n,); these differences are exact."""
        bounds = zip(self.low, self.middle, self.high, strict=True)
        return tuple(max(b - m, m - a) for a, m, b in bounds)

    def balls(self) -> list[arb]:
        """Return the shares as balls."""
        return [arb(m, r) for m, r in zip(self.middle, self.radii, strict=True)]

    def at(self, axis: int, share: float) -> Box:
        """Return the face on which one share has this value."""
        low, high = list(self.low), list(self.high)
        low[axis] = high[axis] = share
        return Box(self.part, tuple(low), tuple(high))

    def halves(self, axis: int) -> tuple[Box, Box]:
        """Return the halves along an axis."""
        middle = 0.5 * (self.low[axis] + self.high[axis])
        low, high = list(self.low), list(self.high)
        low[axis], high[axis] = middle, middle
        return Box(self.part, self.low, tuple(high)), Box(self.part, tuple(low), self.high)


class Look(NamedTuple):
    """What is known of a box: nothing in it is below ``low``, something is at most ``high``.

    ``box``: what of it has to be looked at further; ``spreads``, shape (n,): by how much the
    function may change along each axis.
    """

    low: float
    high: float
    box: Box
    spreads: tuple[float, ...]


Inspect = Callable[[Box], Look]


@dataclass(frozen=True, slots=True)
class Minimum:
    """A least value, between ``low`` and ``high``; the latter is attained in ``at``.

    ``boxes``: how many were looked at.
    """

    low: float
    high: float
    boxes: int
    at: Box


def minimise(
    starts: Iterable[Box], inspect: Inspect, *, tolerance: float, most_boxes: int
) -> Minimum:
    """Enclose the least value over boxes, until the bounds are ``tolerance`` apart.

    After ``most_boxes`` boxes the bounds are as far apart as they are.
    """
    count = itertools.count()
    heap: list[tuple[float, int, Look]] = []
    best, at = math.inf, None

    def take(box: Box) -> None:
        nonlocal best, at
        look = inspect(box)
        if look.high < best or at is None:
            best, at = look.high, look.box
        if look.low <= best:
            heapq.heappush(heap, (look.low, next(count), look))

    boxes = 0
    for box in starts:
        take(box)
        boxes += 1
    while heap[0][0] < best - tolerance and boxes < most_boxes:
        look = heapq.heappop(heap)[2]
        axis = _axis(look)
        for half in look.box.halves(axis):
            take(half)
        boxes += 2
    assert at is not None
    return Minimum(min(heap[0][0], best), best, boxes, at)


def _axis(look: Look) -> int:
    """Return the axis to divide along: where the function may change most, else the widest."""
    spreads: Sequence[float] = look.spreads
    if not all(map(math.isfinite, spreads)) or max(spreads) <= 0.0:
        spreads = look.box.radii
    return max(range(len(spreads)), key=spreads.__getitem__)


def on_faces(box: Box, slopes: Slopes) -> Box:
    """Return the face of a box that holds its least value, by the slopes' certain signs."""
    for axis, slope in slopes.items():
        if slope >= 0:
            box = box.at(axis, box.low[axis])
        elif slope <= 0:
            box = box.at(axis, box.high[axis])
    return box


def looked_at(middle: arb, on_box: Jet, box: Box, high: arb, least: arb) -> Look:
    """Return what the mean-value form tells of a box.

    ``middle``: the function in the middle of the box; ``on_box``: on all of it, with slopes.
    ``high``: the value that is attained in the middle; ``least``: one that is nowhere undercut.
    """
    low, spreads = middle, [0.0] * len(box.low)
    for axis, radius in enumerate(box.radii):
        if radius > 0.0 and axis in on_box.slopes:
            spread = on_box.slopes[axis].abs_upper() * radius
            low -= spread
            spreads[axis] = float(spread.upper())
    bounds = [float(one.lower()) for one in (low, on_box.value, least)]
    known = [one for one in bounds if math.isfinite(one)]
    top = float(high.upper())
    return Look(
        max(known, default=-math.inf),
        top if math.isfinite(top) else math.inf,
        box,
        tuple(spreads),
    )
