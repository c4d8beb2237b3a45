"""How nodes end, and when they report."""

import math
import os
import signal
import subprocess
import sys
import time
from itertools import pairwise
from types import SimpleNamespace

import pytest

from sar_estimator.common import node_support

HANGING = """
import sys, time
import rclpy
from rclpy.node import Node
from sar_estimator.common import node_support

def hang(node):
    print("spinning", flush=True)
    while True:
        try:
            time.sleep(60.0)
        except KeyboardInterrupt:
            pass

node_support.PATIENCE_S = 0.5
rclpy.spin = hang
sys.exit(node_support.run_node("hanging", lambda: Node("hanging")))
"""


@pytest.mark.graph
@pytest.mark.timeout(60)
@pytest.mark.parametrize("trapped", ["", "trap '' INT; "], ids=["alone", "in_the_background"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_node_ends_when_asked_whatever_hangs_in_it(number, trapped):
    """A shell has what it starts in the background ignore SIGINT."""
    process = subprocess.Popen(
        ["bash", "-c", f'{trapped}exec "$@"', "bash", sys.executable, "-c", HANGING],
        stdout=subprocess.PIPE,
        env=dict(os.environ, ROS_DOMAIN_ID="96"),
        text=True,
    )
    try:
        assert process.stdout.readline() == "spinning\n"
        time.sleep(0.3)
        assert process.poll() is None
        process.send_signal(number)
        assert process.wait(timeout=15.0) == 0
    finally:
        process.kill()
        process.wait()


@pytest.mark.parametrize("begun", [0.0, 0.1, 0.2, 0.45, 0.7, 0.95])
@pytest.mark.parametrize("late", [0.0, 0.03])
def test_reports_come_each_second_and_between_the_fixes(begun, late):
    reported, times = -math.inf, []
    for step in range(80):
        now = begun + 0.5 * step + late * (step % 3)
        if node_support.is_report_due(now, reported):
            reported = now
            times.append(now)
    assert len(times) > 34
    gaps = [after - before for before, after in pairwise(times)]
    assert min(gaps) > 0.4
    assert max(gaps) < 1.6
    assert all(0.1 < time % 1.0 < 0.8 for time in times[2:])


def test_a_clock_set_back_is_reported_at_once():
    assert node_support.is_report_due(100.1, 160.5)
    assert node_support.is_report_due(3700.1, 160.5)
    assert not node_support.is_report_due(160.9, 160.5)


class FakeClient:
    """A service that answers when a test says so."""

    def __init__(self):
        self.asked = []

    def service_is_ready(self):
        return True

    def call_async(self, _request):
        self.asked.append(FakeFuture())
        return self.asked[-1]


class FakeFuture:
    answer = None

    def done(self):
        return self.answer is not None

    def result(self):
        return self.answer


@pytest.mark.parametrize(("unanswered_s", "times"), [(None, 3), (60.0, 1)])
def test_what_is_slow_to_be_answered_is_not_asked_again_too_soon(monkeypatch, unanswered_s, times):
    client, clock = FakeClient(), [100.0]
    monkeypatch.setattr(node_support.time, "monotonic", lambda: clock[0])
    node = SimpleNamespace(create_client=lambda *_: client)
    asking = node_support.Persistent(node, "/planner/resume", 0.5, unanswered_s)
    for _ in range(3):
        assert asking.ask() == ""
        clock[0] += 0.6
    assert len(client.asked) == times
    client.asked[-1].answer = SimpleNamespace(success=True, message="back to the formation")
    assert asking.ask() == "back to the formation"
    assert asking.done


@pytest.mark.parametrize("is_ok", [True, False])
def test_a_wait_that_fails_once_the_end_was_asked_for_is_the_end(monkeypatch, is_ok):
    """Between two waits rclpy makes the next one of a context that is none any more."""

    def spin(_node):
        raise RuntimeError("failed to initialize wait set: the given context is not valid")

    ended = []
    for name in ("_end_when_asked", "start_ros", "refuse_unknown_parameters"):
        monkeypatch.setattr(node_support, name, lambda *_: None)
    monkeypatch.setattr(node_support.rclpy, "spin", spin)
    monkeypatch.setattr(node_support.rclpy, "ok", lambda: is_ok)
    monkeypatch.setattr(node_support, "end_process", ended.append)
    node = SimpleNamespace(close=lambda: None)
    if is_ok:
        with pytest.raises(RuntimeError, match="wait set"):
            node_support.run_node("one", lambda: node)
    else:
        node_support.run_node("one", lambda: node)
    assert ended == ([] if is_ok else [0])


LOWERED = """
import os, sys
from rclpy.node import Node
from sar_estimator.common.node_support import run_node

class Told(Node):
    def __init__(self):
        super().__init__("told")
        threads = os.listdir("/proc/self/task")
        values = {os.getpriority(os.PRIO_PROCESS, int(thread)) for thread in threads}
        print(len(threads) > 1, sorted(values), flush=True)
        raise ValueError("enough")

sys.exit(run_node("record", Told))
"""


@pytest.mark.graph
@pytest.mark.timeout(60)
@pytest.mark.parametrize(("given", "told"), [("1", "True [10]"), ("0", "True [0]")])
def test_all_threads_of_a_node_have_its_priority(given, told):
    """Also those of the middleware, which begin with the node."""
    done = subprocess.run(
        [sys.executable, "-c", LOWERED],
        capture_output=True,
        text=True,
        timeout=50,
        check=False,
        env=dict(os.environ, ROS_DOMAIN_ID="96", SAR_PRIORITIES=given),
    )
    assert done.returncode == 2
    assert done.stdout.strip() == told
