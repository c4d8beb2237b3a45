"""Enclosed numbers against floating point: values, and slopes by the mean-value theorem."""

import math

import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from sar_sim.trials.enclosure.jets import (
    EnclosureError,
    Jet,
    arctangent,
    root,
    sin_cos,
    square_beyond,
    swing_angle,
)

SLACK = 1e-9
FUNCTIONS = {
    "sine": (lambda x: sin_cos(x)[0], math.sin, (-7.0, 7.0)),
    "cosine": (lambda x: sin_cos(x)[1], math.cos, (-7.0, 7.0)),
    "root": (root, math.sqrt, (0.5, 90.0)),
    "arctangent": (arctangent, math.atan, (-9.0, 9.0)),
    "square_beyond": (square_beyond, lambda x: max(0.0, x) ** 2, (-9.0, 9.0)),
    "plus": (lambda x: 3.0 + x - 1, lambda x: 3.0 + x - 1.0, (-9.0, 9.0)),
    "minus": (lambda x: 2 - x * x, lambda x: 2.0 - x * x, (-9.0, 9.0)),
    "times": (lambda x: 3 * x * (x + 1), lambda x: 3.0 * x * (x + 1.0), (-9.0, 9.0)),
    "over": (lambda x: (x - 4) / (x * x + 1), lambda x: (x - 4.0) / (x * x + 1.0), (-9.0, 9.0)),
    "halved": (lambda x: -x / 2, lambda x: -x / 2.0, (-9.0, 9.0)),
}
SHARES = st.floats(0.0, 1.0)


def holds(ball, value):
    return float(ball.lower()) - SLACK <= value <= float(ball.upper()) + SLACK


@pytest.mark.parametrize("name", FUNCTIONS)
@given(middle=SHARES, radius=st.floats(1e-3, 0.2), first=SHARES, second=SHARES)
def test_values_and_slopes_are_enclosed(name, middle, radius, first, second):
    enclosed, plain, (low, high) = FUNCTIONS[name]
    middle = low + radius + middle * (high - low - 2.0 * radius)
    found = enclosed(Jet(arb(middle, radius), {0: arb(1)}))
    a, b = (middle + radius * (2.0 * share - 1.0) for share in (first, second))
    assert holds(found.value, plain(a))
    if abs(b - a) > 1e-4:
        assert holds(found.slopes[0], (plain(b) - plain(a)) / (b - a))


@pytest.mark.parametrize("name", FUNCTIONS)
@given(share=SHARES)
def test_a_point_is_enclosed_narrowly(name, share):
    enclosed, plain, (low, high) = FUNCTIONS[name]
    point = low + share * (high - low)
    found = enclosed(Jet(point, {0: arb(1)}))
    assert float(found.value.mid()) == pytest.approx(plain(point), abs=1e-9)
    assert float(found.value.rad()) < 1e-9
    assert float(found.slopes[0].rad()) < 1e-9


@given(
    x=st.floats(-5.0, 5.0), y=st.floats(1.0, 5.0), dx=st.floats(-0.1, 0.1), dy=st.floats(-0.1, 0.1)
)
def test_slopes_of_two_variables_bound_a_change(x, y, dx, dy):
    def plain(u, v):
        return u * math.sin(v) / v - u

    one, two = Jet(arb(x, 0.1), {0: arb(1)}), Jet(arb(y, 0.1), {1: arb(1)})
    found = one * sin_cos(two)[0] / two - one
    change = found.slopes[0] * dx + found.slopes[1] * dy
    assert holds(change, plain(x + dx, y + dy) - plain(x, y))


@given(angle=st.floats(-0.3, 1.1), radius=st.floats(0.0, 0.1), share=st.floats(-1.0, 1.0))
def test_the_angle_of_a_swing_is_enclosed(angle, radius, share):
    def swing(theta):
        return theta + math.sin(theta) + math.cos(theta)

    found = swing_angle(Jet(arb(swing(angle), radius), {0: arb(1)}))
    low, high = float(found.value.lower()), float(found.value.upper())
    assert swing(low) <= swing(angle) - radius + 1e-12
    assert swing(high) >= swing(angle) + radius - 1e-12
    assert swing(high) - swing(low) <= 2.0 * radius * (1.0 + 1e-6) + 1e-11
    inside = low + (high - low) * (0.5 + 0.49 * share)
    slope = 1.0 / (1.0 + math.cos(inside) - math.sin(inside))
    assert holds(found.slopes[0], slope)


@pytest.mark.parametrize("sum_", [-2.0, 2.6, 9.0])
def test_a_swing_without_an_angle_is_refused(sum_):
    with pytest.raises(EnclosureError, match="expected"):
        swing_angle(Jet(sum_))


def test_what_may_not_be_is_not_finite():
    assert not (Jet(1) / Jet(arb(0, 1))).value.is_finite()
    assert not root(Jet(arb(0, 1))).value.is_finite()
