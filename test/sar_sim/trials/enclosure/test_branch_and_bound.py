"""Branch and bound on functions whose least value is known."""

import math

import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from sar_sim.trials.enclosure.branch_and_bound import Box, looked_at, minimise, on_faces
from sar_sim.trials.enclosure.jets import Jet, root, sin_cos

SQUARE = Box(0, (0.0, 0.0), (1.0, 1.0))
TOLERANCE = 1e-3


def inspecting(function):
    def inspect(box):
        variables = [
            Jet(ball, {axis: arb(1)} if box.high[axis] > box.low[axis] else {})
            for axis, ball in enumerate(box.balls())
        ]
        on_box = function(box.part, *variables)
        face = on_faces(box, on_box.slopes)
        middle = function(box.part, *(Jet(share) for share in face.middle)).value
        return looked_at(middle, on_box, face, middle, on_box.value)

    return inspect


def least(function, starts=(SQUARE,), most_boxes=10_000):
    return minimise(starts, inspecting(function), tolerance=TOLERANCE, most_boxes=most_boxes)


@given(
    x=st.floats(-0.5, 1.5), y=st.floats(-0.5, 1.5), a=st.floats(0.5, 30.0), b=st.floats(0.5, 30.0)
)
def test_a_bowl_has_its_least_value_between_the_bounds(x, y, a, b):
    def bowl(_, u, v):
        return a * ((u - x) * (u - x)) + b * ((v - y) * (v - y))

    found = least(bowl)
    true = a * (min(max(x, 0.0), 1.0) - x) ** 2 + b * (min(max(y, 0.0), 1.0) - y) ** 2
    assert found.low - 1e-12 <= true <= found.high + 1e-12
    assert found.high - found.low <= TOLERANCE


@given(phase=st.floats(0.0, 6.0), rate=st.floats(3.0, 20.0))
def test_of_several_valleys_the_deepest_is_found(phase, rate):
    def waves(_, u, v):
        return sin_cos(rate * u + phase)[0] + u * v

    found = least(waves)
    true = min(math.sin(rate * i / 20_000 + phase) for i in range(20_001))  # at v = 0
    assert found.low <= true
    assert true - 1e-5 <= found.high <= found.low + TOLERANCE


def test_a_slope_with_a_sign_leaves_a_face():
    found = least(lambda _, u, v: 3 * u - 2 * v)
    assert found.boxes == 1
    assert found.at == Box(0, (0.0, 1.0), (0.0, 1.0))
    assert found.low == pytest.approx(-2.0)


def test_the_least_of_all_parts_is_taken():
    starts = [SQUARE._replace(part=part) for part in range(3)]
    found = least(lambda part, u, v: u * u + v * v + (1, -1, 0)[part], starts)
    assert found.at.part == 1
    assert found.low <= -1.0 <= found.high


def test_bounds_are_sound_when_the_boxes_are_used_up():
    found = least(lambda _, u, v: sin_cos(40 * u)[0] + sin_cos(50 * v)[0], most_boxes=20)
    assert found.boxes <= 21
    assert found.high - found.low > TOLERANCE
    assert found.low <= -2.0 <= found.high


def test_boxes_in_which_nothing_is_known_are_divided():
    def reaching(_, u, v):
        # The root of (1 + u - v)^2, as a difference that falls below zero on the whole square.
        return root(1 + u * u + v * v + 2 * u - 2 * v - 2 * u * v) + u

    assert inspecting(reaching)(SQUARE).low == -math.inf
    found = least(reaching, [Box(0, (0.0, 0.0), (1.0, 0.5))])
    assert found.low <= 0.5 <= found.high <= found.low + TOLERANCE
