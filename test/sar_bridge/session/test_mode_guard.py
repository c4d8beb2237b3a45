"""Who has the UAV: every mode that can be flown, in every state."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.session.mode_guard import ModeGuard

MODES = ("GUIDED", "AUTO", "LOITER", "RTL", "MANUAL")


def flying(mode, *, may_engage=True):
    guard = ModeGuard()
    guard.begin(mode, may_engage=may_engage)
    return guard


@pytest.mark.parametrize(("was", "mode"), list(itertools.product(MODES, MODES)))
def test_only_auto_and_a_guided_that_was_not_left_are_ours(was, mode):
    guard = flying(was)
    taken = guard.is_taken(mode)
    assert taken is not (mode == "AUTO" or (mode == "GUIDED" and was != "AUTO"))
    assert guard.released is taken
    assert guard.takes_lists is not taken
    assert guard.taken == (f"mode {mode} was chosen by somebody else" if taken else "")


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("may_engage", [True, False])
def test_auto_is_chosen_once_from_guided_after_an_engagement_alone(mode, may_engage):
    guard = flying(mode, may_engage=may_engage)
    assert guard.may_start(mode) is (may_engage and mode == "GUIDED")
    assert not guard.may_start("GUIDED")


def test_who_was_taken_or_sent_home_takes_lists_again_after_a_withdrawal():
    guard = flying("AUTO")
    assert guard.is_taken("LOITER")
    guard.withdraw()
    assert guard.takes_lists
    assert guard.taken == "mode LOITER was chosen by somebody else"
    guard.send_home()
    assert not guard.takes_lists
    assert guard.taken == ""
    guard.withdraw()
    assert guard.takes_lists


@given(st.lists(st.sampled_from(("withdraw", "home", "start", *MODES)), max_size=30))
def test_whatever_happens_auto_is_never_chosen_against_a_human(events):
    guard = flying("GUIDED")
    human = False
    for event in events:
        if event == "withdraw":
            guard.withdraw()
            human = True  # until a list is begun again
        elif event == "home":
            guard.send_home()
            human = True
        elif event == "start":
            assert not (human and guard.may_start("GUIDED"))
        elif guard.is_taken(event):
            human = True
