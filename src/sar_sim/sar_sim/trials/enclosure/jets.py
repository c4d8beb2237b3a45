"""Enclosed numbers with enclosed slopes, for bounds of the mean-value form.

A ``Jet`` holds balls of Arb (Johansson 2017): whatever the variables are within their box, the
value and its partial derivatives lie in them, rounding included. Without slopes it is a number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from flint import arb

Slopes = Mapping[int, arb]
Number = arb | float | int
NONE: Slopes = {}
HALF_PI = arb.pi() / 2
ROOT_STEP = 1e-13
ROOT_STEPS = 60


def square(value: arb) -> arb:
    """Return the square; a ball's power may be not a number where its middle is zero."""
    return value * value


class EnclosureError(ValueError):
    """What cannot be enclosed; the message names the value and what was expected."""


class Jet:
    """A value's ball, and the balls of its slopes by the number of the variable."""

    __slots__ = ("slopes", "value")

    def __init__(self, value: Number, slopes: Slopes = NONE) -> None:
        """Take a value and its slopes; those that are absent are zero."""
        self.value = arb(value)
        self.slopes = slopes

    def __add__(self, other: Jet | Number) -> Jet:
        """Return the sum."""
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.slopes)
        slopes = dict(self.slopes)
        for i, slope in other.slopes.items():
            slopes[i] = slopes[i] + slope if i in slopes else slope
        return Jet(self.value + other.value, slopes)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        """Return the negative."""
        return Jet(-self.value, {i: -slope for i, slope in self.slopes.items()})

    def __sub__(self, other: Jet | Number) -> Jet:
        """Return the difference."""
        return self + (-other)

    def __rsub__(self, other: Number) -> Jet:
        """Return the difference from a number."""
        return (-self) + other

    def __mul__(self, other: Jet | Number) -> Jet:
        """Return the product."""
        if not isinstance(other, Jet):
            return self.along(self.value * other, arb(other))
        slopes = {i: slope * other.value for i, slope in self.slopes.items()}
        for i, slope in other.slopes.items():
            own = slope * self.value
            slopes[i] = slopes[i] + own if i in slopes else own
        return Jet(self.value * other.value, slopes)

    __rmul__ = __mul__

    def __truediv__(self, other: Jet | Number) -> Jet:
        """Return the quotient; not finite where the divisor may be zero."""
        if not isinstance(other, Jet):
            return self.along(self.value / other, 1 / arb(other))
        return self * other.along(1 / other.value, -1 / square(other.value))

    def along(self, value: arb, slope: arb) -> Jet:
        """Return a function of this one by the chain rule: its value, and its slope here."""
        return Jet(value, {i: slope * own for i, own in self.slopes.items()})


def sin_cos(angle: Jet) -> tuple[Jet, Jet]:
    """Return the sine and the cosine of an angle [rad]."""
    sine, cosine = angle.value.sin_cos()
    return angle.along(sine, cosine), angle.along(cosine, -sine)


def root(square: Jet) -> Jet:
    """Return the square root; not finite where the square may be negative."""
    value = square.value.sqrt()
    return square.along(value, 1 / (2 * value))


def arctangent(ratio: Jet) -> Jet:
    """Return the angle [rad] of a tangent."""
    return ratio.along(ratio.value.atan(), 1 / (1 + square(ratio.value)))


def square_beyond(length: Jet) -> Jet:
    """Return max(0, length)^2, whose slope is continuous."""
    beyond = length.value.max(arb(0))
    return length.along(square(beyond), 2 * beyond)


def _swing(angle: arb) -> arb:
    return angle + angle.sin() + angle.cos()


def _angle_beyond(sum_: arb, side: int) -> arb:
    """Return an angle that is proved to be beyond the root at ``sum_``, above (1) or below (-1)."""
    wanted, angle = float(sum_.mid()), 0.5
    for _ in range(ROOT_STEPS):
        error = angle + math.sin(angle) + math.cos(angle) - wanted
        angle -= error / (1.0 - math.sin(angle) + math.cos(angle))
        angle = min(max(angle, -0.5), 1.5)
        if abs(error) < ROOT_STEP:
            break
    step = ROOT_STEP
    for _ in range(ROOT_STEPS):
        beyond = arb(angle + side * step)
        if side * (_swing(beyond) - sum_) >= 0 and -1 < beyond < HALF_PI:
            return beyond
        step *= 2.0
    raise EnclosureError(f"theta + sin theta + cos theta = {wanted:.6f}: expected -1.3 to 2.57")


def swing_angle(sum_: Jet) -> Jet:
    """Return theta [rad] with theta + sin theta + cos theta = ``sum_``, -1 < theta < pi/2.

    The sum rises strictly there, with the slope 1 + cos theta - sin theta. Each end is taken by
    Newton's method in floating point, then proved to lie beyond the root by the sum's sign in
    intervals. Raises ``EnclosureError`` where that fails.
    """
    low = _angle_beyond(sum_.value.lower(), -1)
    high = _angle_beyond(sum_.value.upper(), 1)
    angle = low.union(high)
    return sum_.along(angle, 1 / (1 + angle.cos() - angle.sin()))
