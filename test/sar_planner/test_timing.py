"""What the planner plans with where its lists are flown late."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.lateness import SLACK_S
from sar_planner.parameters.mission import MissionParameters
from sar_planner.timing import Timing

DELAYS = st.lists(st.floats(0.0, 12.0), min_size=1, max_size=10)


class Planning:
    """What plans with a time, and has noted which."""

    def __init__(self):
        self.given = []

    def set_reaction(self, reaction_s):
        self.given.append(reaction_s)


def measured(late_s, now_s=100.0, planning=(), **parameters):
    timing = Timing(MissionParameters(**parameters), planning)
    timing.give(1, now_s - late_s)
    timing.flown(1, now_s)
    return timing


@pytest.mark.parametrize(
    ("late_s", "planned_s"),
    [(0.0, 1.0), (0.9, 1.0), (1.44, 1.0), (1.53, 1.6), (3.0, 3.0), (8.0, 5.0)],
)
def test_it_is_what_was_measured_between_the_least_and_the_most(late_s, planned_s):
    assert measured(late_s).reaction_s(100.0) == pytest.approx(planned_s)


@given(DELAYS, st.floats(0.0, 3.0), st.floats(0.0, 8.0))
def test_it_is_never_less_than_the_parameter_nor_more_than_both_bounds(delays, least, most):
    timing = Timing(MissionParameters(reaction_s=least, most_reaction_s=most))
    for number, late_s in enumerate(delays):
        timing.give(number, 10.0 * number)
        timing.flown(number, 10.0 * number + late_s)
        planned_s = timing.reaction_s(10.0 * number + late_s)
        assert least <= planned_s <= max(least, most)
        assert planned_s >= min(late_s, most) - SLACK_S - 1e-9


def test_where_nothing_measured_may_be_planned_with_the_parameter_stands():
    timing = measured(4.0, reaction_s=0.0, most_reaction_s=0.0)
    assert timing.reaction_s(100.0) == 0.0
    assert timing.problems(100.0) == ""


def test_what_plans_is_told_when_it_changes_and_when_it_is_over():
    planning = Planning()
    timing = measured(3.0, planning=(planning,))
    for tenth in range(1200):
        timing.adapt(100.0 + 0.1 * tenth)
    assert planning.given[0] == 3.0
    assert planning.given[-1] == 1.0
    assert planning.given == sorted(set(planning.given), reverse=True)
    assert len(planning.given) == 16  # in steps of 0.1 s until it is 1.6 s


def test_what_is_too_late_to_be_planned_for_is_told():
    assert measured(4.0).problems(100.0) == ""
    late = measured(8.0).problems(100.0)
    assert late == "lists are flown 8.0 s after their decision: planned with 5 s at most"
    timing = measured(8.0)
    timing.hear_fix(98.0)
    timing.use(100.0)
    assert timing.problems(100.0) == f"laptop is late: fixes 2.0 s old at decision; {late}"
