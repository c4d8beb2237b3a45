"""Whose priority is raised, whose lowered, and what is told where that is not permitted."""

import os
import subprocess
import sys

import pytest

from sar_estimator.common import priorities
from sar_estimator.common.priorities import LOWERED, RAISED, set_priority


class System:
    """An operating system that permits nice values from ``least`` on; below ``have`` it asks."""

    def __init__(self, monkeypatch, *, have=0, least=0, leads_session=False):
        self.nice, self.least, self.group, self.busy = have, least, [], 0
        monkeypatch.setattr(os, "getpriority", lambda *_: self.nice)
        monkeypatch.setattr(os, "setpriority", self.set)
        monkeypatch.setattr(os, "getsid", lambda _: os.getpid() if leads_session else 1)
        monkeypatch.setattr(priorities, "least_permitted", lambda: least)
        monkeypatch.setattr(priorities, "AUTOGROUP", self)
        monkeypatch.setattr(priorities, "AGAIN_S", 0.0)

    def set(self, _which, _who, nice):
        if nice < min(self.nice, self.least):
            raise PermissionError(13, "no")
        self.nice = nice

    def write_text(self, text, encoding):
        if self.busy > 0:
            self.busy -= 1
            raise BlockingIOError(11, "later")
        self.group.append(text)


@pytest.mark.parametrize("node", ["estimator", "planner", "monitor", "bridge"])
def test_what_leads_is_raised_where_that_is_permitted(monkeypatch, node):
    system = System(monkeypatch, least=-20)
    assert set_priority(node, {}) == f"priority: nice {RAISED}"
    assert system.nice == RAISED


def test_what_is_permitted_is_taken(monkeypatch):
    system = System(monkeypatch, least=-5)
    assert set_priority("planner", {}) == "priority: nice -5"
    assert system.nice == -5


@pytest.mark.parametrize("have", [0, 5])
def test_where_nothing_is_permitted_that_is_told_and_nothing_else(monkeypatch, have):
    system = System(monkeypatch, have=have, least=20)
    assert set_priority("bridge", {}).startswith(f"priority: nice {have}, more is not permitted")
    assert (system.nice, system.group) == (have, [])


def test_one_that_is_raised_farther_already_stays_there(monkeypatch):
    system = System(monkeypatch, have=-15, least=20)
    assert set_priority("planner", {}) == "priority: nice -15"
    assert system.nice == -15


@pytest.mark.parametrize(("have", "then"), [(0, LOWERED), (-5, LOWERED), (15, 15)])
def test_what_records_and_shows_is_lowered(monkeypatch, have, then):
    for node in ("record", "console"):
        system = System(monkeypatch, have=have, least=20)
        assert set_priority(node, {}) == ""
        assert system.nice == then


def test_others_are_left_alone_and_all_where_that_is_asked_for(monkeypatch):
    system = System(monkeypatch, least=-20)
    assert set_priority("play", {}) == ""
    for node in ("planner", "record"):
        assert set_priority(node, dict([priorities.OFF])) == ""
    assert system.nice == 0


def test_the_session_gets_the_value_too_after_some_tries(monkeypatch):
    system = System(monkeypatch, least=-20, leads_session=True)
    system.busy = 3
    set_priority("planner", {})
    assert system.group == [str(RAISED)]
    other = System(monkeypatch, least=-20, leads_session=True)
    other.busy = 1000
    set_priority("planner", {})
    assert (other.nice, other.group) == (RAISED, [])


def test_a_session_of_others_is_left_alone(monkeypatch):
    system = System(monkeypatch, least=-20)
    set_priority("planner", {})
    assert system.group == []


@pytest.mark.timeout(60)
def test_a_real_process_is_lowered_with_its_children_and_its_session():
    code = (
        "import os, subprocess, sys\n"
        "from sar_estimator.common.priorities import set_priority\n"
        "set_priority('record', {})\n"
        "print(os.getpriority(os.PRIO_PROCESS, 0), flush=True)\n"
        "subprocess.run([sys.executable, '-c',\n"
        "    'import os; print(os.getpriority(os.PRIO_PROCESS, 0))'], check=True)\n"
        "if os.path.exists('/proc/self/autogroup'):\n"
        "    print(open('/proc/self/autogroup').read().split()[-1])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=50,
        check=True,
        start_new_session=True,
    )
    assert set(done.stdout.split()) == {str(LOWERED)}
