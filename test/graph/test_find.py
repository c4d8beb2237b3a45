"""A find in the graph, by the operator's commands; the small case is in sar_sim/flight."""

import math
import time
from pathlib import Path

import pytest

from sar_estimator.bags.bag import read_messages

pytestmark = [pytest.mark.proof, pytest.mark.timeout(240)]
ROOT = Path(__file__).parents[2]


def ask(flight, action):
    """Ask by ``operator`` until it is granted."""
    ends = time.monotonic() + 60.0
    while True:
        answer = flight.operator(action)
        if answer.returncode == 0:
            return answer.stdout
        assert time.monotonic() < ends, answer.stderr + answer.stdout
        time.sleep(1.0)


def test_a_find_is_marked_orbited_and_left(launch):
    flight = launch("--scenario", "arduplane", "--speed", "5")
    bag = flight.out / "bag" / "bag.mcap"
    ends = time.monotonic() + 60.0
    while not (bag.exists() and bag.stat().st_size > 100_000):
        assert time.monotonic() < ends
        time.sleep(0.2)
    assert ask(flight, "mark") == "mark: mark 1 set\n"
    assert ask(flight, "orbit") == "orbit: to mark 1\n"
    time.sleep(30.0)
    assert ask(flight, "resume") == "resume: back to the formation\n"
    time.sleep(8.0)
    flight.process.terminate()
    code, output, errors = flight.wait(60.0)
    assert (code, errors) == (0, "")
    assert "stopped by SIGTERM" in output
    assert (flight.out / "report.html").exists()
    marks, modes, off, apart, places = [], [], [], [], {}
    for topic, time_s, message in read_messages(flight.out / "bag"):
        if topic == "/planner/marks" and message.poses:
            marks.append(message.poses[-1].pose.position)
        elif topic == "/planner/mode":
            modes.append((time_s, message.data))
        elif topic in ("/sim/uav", "/sim/helicopter"):
            there = message.pose.pose.position
            places[topic] = there
            if len(places) == 2:
                one, other = places.values()
                apart.append(math.hypot(one.x - other.x, one.y - other.y))
            if topic == "/sim/uav" and modes and modes[-1][1] == "orbit":
                off.append(math.hypot(there.x - marks[-1].x, there.y - marks[-1].y))
    assert len(marks) == 1
    named = [mode for _, mode in modes]
    assert "orbit" in named
    assert named[-1] != "orbit"
    last_minute = off[-300:]
    assert max(abs(radius - 300.0) for radius in last_minute) < 40.0
    assert min(apart) > 180.0


def test_a_helicopter_that_comes_to_hover_is_circled_in_a_mission_of_its_own(launch):
    """The scenario ``find``: its simulated operator marks, orbits, and resumes when it may."""
    flight = launch("--scenario", "find", "--speed", "8")
    code, output, errors = flight.wait(200.0)
    assert (code, errors) == (0, "")
    marks, mode, apart, hovered, last = [], "", [], [], {}
    for topic, _, message in read_messages(flight.out / "bag"):
        if topic == "/planner/marks" and message.poses:
            marks = [pose.pose.position for pose in message.poses]
        elif topic == "/planner/mode":
            mode = message.data
        elif topic in ("/sim/uav", "/sim/helicopter"):
            last[topic] = message
            if len(last) < 2:
                continue
            one, other = (message.pose.pose.position for message in last.values())
            apart.append(math.hypot(one.x - other.x, one.y - other.y))
            uav, helicopter = last["/sim/uav"], last["/sim/helicopter"]
            there, leader = uav.pose.pose.position, helicopter.pose.pose.position
            at_mark = marks and math.hypot(leader.x - marks[0].x, leader.y - marks[0].y) < 30.0
            if mode == "orbit" and at_mark:
                hovered.append(math.hypot(there.x - marks[0].x, there.y - marks[0].y))
    assert len(marks) == 1
    assert len(hovered) > 400  # at 5 Hz
    on_circle = [abs(radius - 300.0) < 30.0 for radius in hovered[len(hovered) // 2 :]]
    assert sum(on_circle) > 0.9 * len(on_circle)
    assert min(apart) > 180.0
    assert mode == "leg"
    assert "0 escapes" in output
