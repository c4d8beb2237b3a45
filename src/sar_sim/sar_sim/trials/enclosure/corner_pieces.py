"""The paper's rules and the helicopter at a corner, in enclosed numbers.

With perfect tracking at V all depends on path distance l = V t alone, and V and a only on the
stopping distance s = V^2 / 2a. The helicopter is at

    x = -max(0, 2 s - l)^2 / 4 s,
    y = -(max(0, l - 2 s)^2 - max(0, l - 4 s)^2) / 4 s:

it slows until l = 2 s, turns on the spot, speeds up until l = 4 s, and cruises. Frame, symbols and
paths are those of ``paper_rules``. Every piece is a function of the share of it that is flown.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from flint import arb

from sar_planner.rules.paper_rules import Rule
from sar_sim.trials.enclosure.jets import (
    HALF_PI,
    Jet,
    arctangent,
    root,
    sin_cos,
    square_beyond,
    swing_angle,
)

PI = arb.pi()
FROM_M, TO_M = -800, 1400
Point = tuple[Jet, Jet]
RULES = (Rule.T1, Rule.T2, Rule.T3, Rule.T4)


class Terms(NamedTuple):
    """What a corner's geometry depends on: s, R, d [m] and c."""

    stopping_m: Jet
    radius_m: Jet
    spacing_m: Jet
    convergence: Jet


class Piece(NamedTuple):
    """A straight or an arc: its length [m], and the point [m] at a share of it."""

    length_m: Jet
    point_at: Callable[[Jet], Point]


class Path(NamedTuple):
    """A rule's path from the onset on: its pieces, and y [m] at its end on the new slot track."""

    pieces: list[Piece]
    end_y_m: Jet

    @property
    def length_m(self) -> Jet:
        """Length [m]."""
        return sum((piece.length_m for piece in self.pieces), Jet(0))

    def begun_m(self, part: int) -> Jet:
        """Return the path distance [m] at which a piece begins."""
        return sum((piece.length_m for piece in self.pieces[:part]), Jet(0))


def fixed_lag_m(p: Terms) -> Jet:
    """Return L0 [m] of (5)."""
    return (p.radius_m * (5 * HALF_PI - 4) - 4 * p.stopping_m) / (p.convergence + 1)


def cut_lag_m(p: Terms) -> Jet:
    """Return the lower end [m] of T1's domain (4)."""
    return p.stopping_m + 2 * p.spacing_m + p.radius_m * (2 - HALF_PI)


def domain_m(rule: Rule, p: Terms) -> tuple[Jet, Jet]:
    """Return the ends [m] of a rule's domain within ``FROM_M`` and ``TO_M``, both closed."""
    if rule is Rule.T1:
        return cut_lag_m(p), Jet(TO_M)
    if rule is Rule.T2:
        return fixed_lag_m(p), cut_lag_m(p)
    if rule is Rule.T3:
        return -p.stopping_m, fixed_lag_m(p)
    return Jet(FROM_M), -p.stopping_m


def lag_at(rule: Rule, share: Jet, p: Terms) -> Jet:
    """Return the lag [m] at a share of a rule's domain: whatever p is, it stays within it."""
    low, high = domain_m(rule, p)
    return low + share * (high - low)


def path_of(rule: Rule, share: Jet, p: Terms) -> Path:
    """Return a rule's path for the lag at a share of its domain.

    Raises ``EnclosureError`` where T3's theta cannot be enclosed.
    """
    lag = lag_at(rule, share, p)
    if rule is Rule.T1:
        return _cut_corner(lag, p)
    if rule is Rule.T2:
        fixed = fixed_lag_m(p)
        return _curve(share * (cut_lag_m(p) - fixed), fixed, Jet(0), p)
    if rule is Rule.T3:
        return _curve(None, lag, convergent_angle(lag, p), p)
    return _outside_loop(lag, p)


def convergent_angle(lag: Jet, p: Terms) -> Jet:
    """Return T3's theta [rad], for which f(L, y) = c L.

    With sin theta of (7) y leaves that equation: theta + sin theta + cos theta =
    5 pi/4 - 1 - (4 s + (1 + c) L) / 2R.
    """
    over = (4 * p.stopping_m + (p.convergence + 1) * lag) / (2 * p.radius_m)
    return swing_angle(5 * HALF_PI / 2 - 1 - over)


def convergent_straight_m(lag: Jet, theta: Jet, p: Terms) -> Jet:
    """Return y [m] from sin theta = (R + d - L - y - s) / 2R of (7)."""
    sine, _ = sin_cos(theta)
    return p.radius_m + p.spacing_m - lag - p.stopping_m - 2 * (p.radius_m * sine)


def helicopter_at(way_m: Jet, stopping_m: Jet) -> Point:
    """Return the helicopter's place [m] when the UAV has flown ``way_m`` since the onset."""
    s = stopping_m
    if way_m.value >= 4 * s.value:
        return Jet(0), 3 * s - way_m
    x = -square_beyond(2 * s - way_m) / (4 * s)
    y = (square_beyond(way_m - 4 * s) - square_beyond(way_m - 2 * s)) / (4 * s)
    return x, y


def gap_m(path: Path, part: int, share: Jet, p: Terms) -> Point:
    """Return the way [m] from the helicopter to the UAV at a share of one piece of its path."""
    piece = path.pieces[part]
    way = path.begun_m(part) + share * piece.length_m
    x, y = piece.point_at(share)
    there = helicopter_at(way, p.stopping_m)
    return x - there[0], y - there[1]


def next_lag_m(path: Path, p: Terms) -> Jet:
    """Return L(k+1) = l - Y - 3 s [m] from (2)."""
    return path.length_m + path.end_y_m - 3 * p.stopping_m


def _cut_corner(lag: Jet, p: Terms) -> Path:
    """S(s + L - d - R) R(pi/2)."""
    s, r, d = p.stopping_m, p.radius_m, p.spacing_m
    straight = s + lag - d - r

    def turn(share: Jet) -> Point:
        sine, cosine = sin_cos(share * HALF_PI)
        return r * sine - d - r, r * cosine - d - r

    pieces = [
        Piece(straight, lambda share: (share * straight - s - lag, -d)),
        Piece(r * HALF_PI, turn),
    ]
    return Path(pieces, -d - r)


def _curve(lead: Jet | None, lag: Jet, theta: Jet, p: Terms) -> Path:
    """S(lead) R(pi) S(y) L(pi - theta) R(pi/2 - theta), where ``lag`` is that without the lead."""
    s, r, d = p.stopping_m, p.radius_m, p.spacing_m
    y = convergent_straight_m(lag, theta, p)
    begin = -(s + lag)
    cosine_theta = sin_cos(theta)[1]
    last_y = -d - 3 * r - 2 * (r * cosine_theta)
    swing, last = PI - theta, HALF_PI - theta

    def half_circle(share: Jet) -> Point:
        sine, cosine = sin_cos(share * PI)
        return begin + r * sine, r * cosine - d - r

    def swing_left(share: Jet) -> Point:
        sine, cosine = sin_cos(share * swing)
        return begin - y - r * sine, r * cosine - d - 3 * r

    def swing_right(share: Jet) -> Point:
        sine, cosine = sin_cos(theta + share * last)
        return r * sine - d - r, last_y + r * cosine

    pieces = [
        Piece(r * PI, half_circle),
        Piece(y, lambda share: (begin - share * y, -d - 2 * r)),
        Piece(r * swing, swing_left),
        Piece(r * last, swing_right),
    ]
    if lead is not None:
        pieces.insert(0, Piece(lead, lambda share: (begin - (1 - share) * lead, -d)))
    return Path(pieces, last_y)


def _outside_loop(lag: Jet, p: Terms) -> Path:
    """L(pi + psi) S(h) L(pi/2 - psi), tan psi = R / (d - R - s - L), h the hypotenuse."""
    s, r, d = p.stopping_m, p.radius_m, p.spacing_m
    ahead = d - r - s - lag
    psi, straight = arctangent(r / ahead), root(r * r + ahead * ahead)
    sine_psi, cosine_psi = sin_cos(psi)
    loop, last = PI + psi, HALF_PI - psi
    from_x, from_y = -(s + lag) - r * sine_psi, r * cosine_psi + r - d

    def around(share: Jet) -> Point:
        sine, cosine = sin_cos(share * loop)
        return r * sine - s - lag, r - d - r * cosine

    def onto(share: Jet) -> Point:
        sine, cosine = sin_cos(psi + share * last)
        return r - d - r * sine, r * cosine - d

    pieces = [
        Piece(r * loop, around),
        Piece(straight, lambda share: (from_x - share * ahead, from_y - share * r)),
        Piece(r * last, onto),
    ]
    return Path(pieces, -d)
