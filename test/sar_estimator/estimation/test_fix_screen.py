"""The screen by itself: every kind of fix, and a clock that is set back."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.common.gps_fix import Fix
from sar_estimator.estimation.fix_screen import SET_BACK_AFTER, FixScreen, Verdict


def screened(*fixes):
    screen = FixScreen()
    for fix in fixes:
        screen.note(fix, screen.refusal(fix) or Verdict.ACCEPTED)
    return screen


@pytest.mark.parametrize(
    ("fix", "verdict"),
    [
        (Fix(11.0, 37.0, -122.0), None),
        (Fix(11.0, 37.0, -122.0, has_fix=False), Verdict.NO_FIX),
        (Fix(11.0, math.nan, -122.0), Verdict.NOT_FINITE),
        (Fix(11.0, 91.0, -122.0), Verdict.NOT_FINITE),
        (Fix(math.inf, 37.0, -122.0), Verdict.NOT_FINITE),
        (Fix(9.0, 37.0, -122.0), Verdict.OUT_OF_ORDER),
        (Fix(10.0, 37.1, -122.0), Verdict.DUPLICATE),
        (Fix(11.0, 37.5, -122.5), Verdict.REPEATED),
    ],
)
def test_every_kind_of_fix_has_its_verdict(fix, verdict):
    assert screened(Fix(10.0, 37.5, -122.5)).refusal(fix) is verdict


def test_every_verdict_is_counted():
    screen = screened(Fix(1.0, 37.0, -122.0), Fix(1.0, 37.1, -122.0), Fix(2.0, 37.2, -122.0))
    assert screen.counts[Verdict.ACCEPTED] == 2
    assert screen.counts[Verdict.DUPLICATE] == 1
    assert sum(screen.counts.values()) == 3


def test_fixes_that_keep_coming_from_before_are_a_clock_that_was_set_back():
    screen = screened(Fix(1000.0, 37.0, -122.0))
    said = [screen.set_back(10.0 + i) for i in range(SET_BACK_AFTER + 1)]
    assert said == [False] * SET_BACK_AFTER + [True]
    screen.forget()
    assert screen.refusal(Fix(16.0, 37.0, -122.0)) is None


def test_old_fixes_in_no_order_are_only_late():
    screen = screened(Fix(1000.0, 37.0, -122.0))
    assert not any(screen.set_back(time_s) for time_s in (10.0, 9.0, 8.0, 7.0, 6.0, 5.0, 4.0))


@given(st.lists(st.tuples(st.floats(0.0, 50.0), st.floats(-80.0, 80.0)), max_size=30))
def test_what_is_accepted_is_newer_and_elsewhere(rows):
    screen, newest, where = FixScreen(), -math.inf, None
    for time_s, latitude in rows:
        fix = Fix(time_s, latitude, 0.0)
        verdict = screen.note(fix, screen.refusal(fix) or Verdict.ACCEPTED)
        if verdict.moved:
            assert time_s > newest
            assert latitude != where
        if verdict.moved or verdict is Verdict.REPEATED:
            newest, where = time_s, latitude
