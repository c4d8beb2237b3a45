"""The least separation and the next lags of the paper's rules, enclosed.

A box's axes are the share of a piece that is flown, the share of the rule's domain, and the shares
of the spans of s, R, d and c. Domains are flown by share: whatever the parameters, a box's lags
are those for which its rule is chosen, and no box straddles two rules. Where a rule's domain is
open, the bounds are those of its closure.

The distance is bounded along the way between the aircraft in the middle of a box. Where the
distance's slope along an axis has a certain sign, its least value lies on a face, and what is left
to divide has an axis less.

Every rule's path is longer than 4 s where d > R and (12) hold. At its end both aircraft cruise at V
along the new leg, and the distance no longer changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import NamedTuple

from flint import arb

from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.rules.paper_rules import Rule
from sar_sim.trials.enclosure.branch_and_bound import (
    Box,
    Inspect,
    Look,
    Minimum,
    looked_at,
    minimise,
    on_faces,
)
from sar_sim.trials.enclosure.corner_pieces import (
    FROM_M,
    TO_M,
    Path,
    Terms,
    convergent_angle,
    convergent_straight_m,
    cut_lag_m,
    fixed_lag_m,
    gap_m,
    lag_at,
    next_lag_m,
    path_of,
)
from sar_sim.trials.enclosure.jets import HALF_PI, EnclosureError, Jet, square

FLOWN, DOMAIN, FIRST_TERM = 0, 1, 2
AXES = 6
SPANNED = ("speed_mps", "accel_mps2", "turn_radius_m", "spacing_m", "convergence")
MOST_BOXES = 200_000


class Span(NamedTuple):
    """A parameter from ``low`` on, over ``width``."""

    low: arb
    width: arb


class Spans(NamedTuple):
    """The spans of s, R, d [m] and c, in the order of ``Terms``."""

    stopping_m: Span
    turn_radius_m: Span
    spacing_m: Span
    convergence: Span

    def terms(self, shares: Sequence[Jet]) -> Terms:
        """Return the parameters at shares of their spans, shape (4,)."""
        return Terms(
            *(span.low + share * span.width for span, share in zip(self, shares, strict=True))
        )

    def whole(self) -> Terms:
        """Return all parameters of the spans."""
        return self.terms([Jet(arb(0.5, 0.5))] * len(self))


@dataclass(frozen=True, slots=True)
class Enclosure:
    """What is proved of one rule over all its lags and all parameters.

    ``separation``: the least distance [m]. ``least_lag``, ``greatest_lag``: of L(k+1) [m], the
    latter with its sign changed.
    """

    rule: Rule
    separation: Minimum
    least_lag: Minimum
    greatest_lag: Minimum

    @property
    def next_lags_m(self) -> tuple[float, float]:
        """Between what L(k+1) lies [m]."""
        return self.least_lag.low, -self.greatest_lag.low

    @property
    def lag_sizes_m(self) -> tuple[float, float]:
        """Between what |L(k+1)| lies [m]."""
        low, high = self.next_lags_m
        return max(0.0, low, -high), max(abs(low), abs(high))

    @property
    def boxes(self) -> int:
        """How many boxes were looked at."""
        return self.separation.boxes + self.least_lag.boxes + self.greatest_lag.boxes


def spans_about(p: CornerParameters, percent: float) -> Spans:
    """Return the spans of V, R, a, d and c about ``p``, each by as many percent to both sides.

    V and a come as s alone. Raises ``ParameterError`` where the rules' conditions do not hold in
    all of it.
    """
    if not 0.0 <= percent < 100.0:
        raise ParameterError(f"box = {percent}: expected 0 or more, less than 100 (percent)")
    if p.taylor_y_m is not None:
        raise ParameterError(f"taylor_y_m = {p.taylor_y_m}: expected none, (7) is solved exactly")
    share = arb(percent) / 100
    values = {name: arb(value) for name, value in asdict(p).items() if name in SPANNED}
    low = {name: value * (1 - share) for name, value in values.items()}
    high = {name: value * (1 + share) for name, value in values.items()}
    low["stopping_m"] = square(low["speed_mps"]) / (2 * high["accel_mps2"])
    high["stopping_m"] = square(high["speed_mps"]) / (2 * low["accel_mps2"])
    # Without a box the widths are zero, not balls about zero: these axes are not divided.
    width = {name: high[name] - low[name] if percent else arb(0) for name in Spans._fields}
    spans = Spans(*(Span(low[name], width[name]) for name in Spans._fields))
    _check(spans.whole())
    return spans


def _check(p: Terms) -> None:
    """Refuse spans in which a condition of the rules is not certain."""
    s, r, d, c = (jet.value for jet in p)
    cut, fixed = cut_lag_m(p).value, fixed_lag_m(p).value
    for holds, what in (
        (0 < c < 1, "convergence between 0 and 1"),
        (d > r, "spacing_m more than turn_radius_m (outside loop, 10)"),
        (2 * s + d > (HALF_PI - 1) * r, "a straight before the cut corner (4)"),
        (s * (3 - c) < (5 * HALF_PI - 5 - c) * r, "V^2/2aR < (5 pi/2 - 5 - c)/(3 - c) (12)"),
        (r + d - fixed - s > 0, "a straight y in the fixed curve (5)"),
        (-s < fixed < cut < TO_M, f"-s < L0 < the cut corner's lags < {TO_M} m"),
        (-s > FROM_M, f"s less than {-FROM_M} m"),
    ):
        if not holds:
            raise ParameterError(f"these parameters: expected everywhere {what}")


class RuleBoxes:
    """A rule over a spans: how boxes are made of shares, and looked at."""

    def __init__(self, rule: Rule, spans: Spans) -> None:
        """Take the rule and the spans of its parameters."""
        self.rule, self.spans = rule, spans
        self._high = (1.0, 1.0, *(float(not span.width.is_zero()) for span in spans))

    def jets(self, box: Box) -> list[Jet]:
        """Return the shares as variables, shape (``AXES``,)."""
        return [
            Jet(ball, {axis: arb(1)} if box.high[axis] > box.low[axis] else {})
            for axis, ball in enumerate(box.balls())
        ]

    @property
    def whole(self) -> Box:
        """All lags and parameters, at the beginning of the path."""
        return Box(0, (0.0,) * AXES, (0.0, *self._high[1:]))

    def pieces(self, box: Box) -> list[Box]:
        """Return a box's lags and parameters over each piece of the path."""
        count = len(self._path([Jet(share) for share in box.middle])[0].pieces)
        low, high = (0.0, *box.low[1:]), (1.0, *box.high[1:])
        return [Box(part, low, high) for part in range(count)]

    def _path(self, shares: Sequence[Jet]) -> tuple[Path, Terms]:
        p = self.spans.terms(shares[FIRST_TERM:])
        return path_of(self.rule, shares[DOMAIN], p), p

    def _gap_m(self, box: Box, shares: Sequence[Jet]) -> tuple[Jet, Jet]:
        path, p = self._path(shares)
        return gap_m(path, box.part, shares[FLOWN], p)

    def distance(self, box: Box) -> Look:
        """Look at the distance between the aircraft [m]."""
        try:
            x, y = self._gap_m(box, self.jets(box))
        except EnclosureError:
            return Look(0.0, math.inf, box, box.radii)
        face = on_faces(box, (x * x + y * y).slopes)
        here_x, here_y = (
            one.value for one in self._gap_m(face, [Jet(share) for share in face.middle])
        )
        ahead, across = here_x.mid(), here_y.mid()
        length = _length_m(ahead, across)
        if not length > 0:
            ahead, across, length = arb(1), arb(0), arb(1)
        ahead, across = ahead / length, across / length
        high = _length_m(here_x.abs_upper(), here_y.abs_upper())
        least = _length_m(x.value.abs_lower(), y.value.abs_lower())
        look = looked_at(
            here_x * ahead + here_y * across,
            x * ahead + y * across,
            face,
            high,
            least,
        )
        return look._replace(low=max(0.0, look.low))

    def next_lag(self, sign: int) -> Inspect:
        """Return how L(k+1) [m] is looked at, times a sign."""

        def value(shares: Sequence[Jet]) -> Jet:
            return sign * next_lag_m(*self._path(shares))

        return lambda box: self._value(value, box)

    def straight(self, box: Box) -> Look:
        """Look at T3's straight y [m]."""

        def value(shares: Sequence[Jet]) -> Jet:
            p = self.spans.terms(shares[FIRST_TERM:])
            lag = lag_at(Rule.T3, shares[DOMAIN], p)
            return convergent_straight_m(lag, convergent_angle(lag, p), p)

        return self._value(value, box)

    def _value(self, value: Callable[[Sequence[Jet]], Jet], box: Box) -> Look:
        try:
            on_box = value(self.jets(box))
        except EnclosureError:
            return Look(-math.inf, math.inf, box, box.radii)
        face = on_faces(box, on_box.slopes)
        middle = value([Jet(share) for share in face.middle]).value
        return looked_at(middle, on_box, face, middle, on_box.value)


def _length_m(x_m: arb, y_m: arb) -> arb:
    return (square(x_m) + square(y_m)).sqrt()


def enclose(
    rule: Rule,
    spans: Spans,
    *,
    tolerance_m: float,
    most_boxes: int = MOST_BOXES,
    within: Box | None = None,
) -> Enclosure:
    """Enclose a rule's least separation and its next lags, the bounds ``tolerance_m`` apart.

    ``most_boxes``: after as many the bounds of a value are as far apart as they are. ``within``:
    the shares of the domain and of the spans, all of them by default. Raises ``ParameterError``
    where T3's straight is not certain to be positive.
    """
    boxes_of = RuleBoxes(rule, spans)
    whole = boxes_of.whole if within is None else within

    def least(inspect: Inspect, starts: Sequence[Box] = (whole,)) -> Minimum:
        return minimise(starts, inspect, tolerance=tolerance_m, most_boxes=most_boxes)

    if rule is Rule.T3:
        straight = least(boxes_of.straight)
        if straight.low <= 0.0:
            raise ParameterError(
                f"these parameters: T3's straight is {straight.low:.1f} m or more, expected more "
                "than 0"
            )
    return Enclosure(
        rule,
        least(boxes_of.distance, boxes_of.pieces(whole)),
        least(boxes_of.next_lag(1)),
        least(boxes_of.next_lag(-1)),
    )


def lag_m(enclosure: Enclosure, spans: Spans) -> float:
    """Return the lag [m] of the corner whose separation is the upper bound."""
    shares = [Jet(share) for share in enclosure.separation.at.middle]
    p = spans.terms(shares[FIRST_TERM:])
    return float(lag_at(enclosure.rule, shares[DOMAIN], p).value.mid())
