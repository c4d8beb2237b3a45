"""The decaying maximum of delays, and the two delays of a node."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.lateness import (
    HALF_S,
    LONGEST_S,
    MOST_LISTS,
    SLACK_S,
    Lateness,
    Punctuality,
    counted_s,
)

DELAYS = st.lists(
    st.tuples(st.floats(0.0, 30.0), st.floats(0.0, LONGEST_S)), min_size=1, max_size=30
)
"""Times between samples, and delays [s]."""


def measured(samples, begun_s=0.0):
    lateness, now = Lateness(), begun_s
    for gap, late in samples:
        now += gap
        lateness.add(late, now)
    return lateness, now


@given(DELAYS)
def test_it_is_the_greatest_of_what_is_left_of_every_delay(samples):
    lateness, now = measured(samples)
    at, left = 0.0, []
    for gap, late in samples:
        at += gap
        left.append(late * 0.5 ** ((now - at) / HALF_S))
    assert lateness.value_s(now) == pytest.approx(max(left), abs=1e-9)


@given(DELAYS, st.floats(0.0, 100.0))
def test_it_only_gets_less_while_nothing_is_measured(samples, quiet):
    lateness, now = measured(samples)
    assert lateness.value_s(now + quiet) <= lateness.value_s(now)
    assert lateness.value_s(now + quiet + 60.0) <= LONGEST_S / 8.0


@given(DELAYS, st.integers(0, 29), st.floats(0.0, 5.0))
def test_a_longer_delay_never_makes_it_less(samples, which, more):
    which %= len(samples)
    longer = list(samples)
    longer[which] = samples[which][0], samples[which][1] + more
    (one, now), (other, _) = measured(samples), measured(longer)
    assert other.value_s(now) >= one.value_s(now) - 1e-12


@given(DELAYS, st.floats(0.0, 500.0))
def test_a_clock_that_is_set_back_changes_nothing(samples, back):
    lateness, now = measured(samples, 1000.0)
    assert lateness.value_s(now - back) == lateness.value_s(now)


def test_nothing_measured_is_not_late_and_what_is_no_delay_does_not_count():
    lateness = Lateness()
    assert lateness.value_s(5.0) == 0.0
    lateness.add(math.nan, 5.0)
    lateness.add(math.inf, 5.0)
    lateness.add(-3.0, 5.0)
    assert lateness.value_s(5.0) == 0.0
    lateness.add(100.0, 5.0)
    assert lateness.value_s(5.0) == LONGEST_S


@given(st.floats(0.0, LONGEST_S), st.floats(0.0, 5.0), st.floats(0.0, LONGEST_S))
def test_what_is_counted_on_is_what_is_assumed_or_clearly_more(late, assumed, most):
    counted = counted_s(late, assumed, most)
    assert counted >= assumed
    if counted > assumed:
        assert counted == min(late, most)
        assert late > assumed + SLACK_S
    else:
        assert min(late, most) <= assumed + SLACK_S


def test_a_fix_is_late_by_its_first_use_whatever_the_receivers_period():
    timing = Punctuality()
    for second in range(0, 40, 4):  # a fix every 4 s, used twice a second, at once
        timing.hear_fix(float(second))
        for half in range(8):
            timing.use(second + 0.1 + 0.5 * half)
    assert 0.05 < timing.fixes.value_s(40.0) < 0.11
    timing.hear_fix(40.0)
    timing.use(41.8)
    assert timing.fixes.value_s(41.8) == pytest.approx(1.8)
    assert timing.problem(41.8, 1.5) == "laptop is late: fixes 1.8 s old at decision"
    assert timing.problem(41.8, 2.0) == ""
    assert timing.values(41.8) == {"fix_late_s": "1.8", "list_late_s": "0.0"}


def test_a_fix_of_another_clock_is_not_late_and_a_list_that_took_ages_is():
    timing = Punctuality()
    timing.hear_fix(100.0)
    timing.use(130.0)
    assert timing.fixes.value_s(130.0) == 0.0
    timing.give(1, 100.0)
    timing.flown(1, 130.0)
    assert timing.lists.value_s(130.0) == LONGEST_S


def test_only_lists_that_were_flown_count():
    timing = Punctuality()
    timing.give(1, 10.0)
    timing.give(2, 11.0)
    timing.give(3, 12.0)
    timing.flown(2, 12.5)
    assert timing.lists.value_s(12.5) == pytest.approx(1.5)
    timing.flown(1, 20.0)  # a newer one is flown: it has no business there
    timing.flown(7, 20.0)  # somebody else's
    assert timing.lists.value_s(20.0) < 1.5
    timing.flown(3, 15.0)
    assert timing.lists.value_s(15.0) == pytest.approx(3.0)


def test_lists_of_a_clock_that_was_set_back_are_forgotten():
    timing = Punctuality()
    timing.give(1, 10.0)
    timing.hear_fix(10.0)
    timing.set_clock_back()
    timing.flown(1, 12.0)
    timing.use(12.0)
    assert timing.values(12.0) == {"fix_late_s": "0.0", "list_late_s": "0.0"}


def test_lists_that_never_arrive_are_not_kept_for_ever():
    timing = Punctuality()
    for number in range(3 * MOST_LISTS):
        timing.give(number, float(number))
    timing.flown(1, 200.0)
    assert timing.lists.value_s(200.0) == 0.0
    timing.flown(3 * MOST_LISTS - 1, 151.0)
    assert timing.lists.value_s(151.0) == pytest.approx(2.0)
