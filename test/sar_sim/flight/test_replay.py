"""A recorded flight once more through the modules that flew it.

The three bags are flights of the scenarios beside them. After a change that is meant to change what
is flown they are made anew:

    ros2 run sar_sim fly --scenario test/sar_sim/bags/NAME.yaml --seed SEED --out FOLDER
    ros2 run sar_sim replay FOLDER/bag --reference test/sar_sim/bags/NAME
"""

import copy
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from diagnostic_msgs.msg import KeyValue

from sar_estimator.bags.bag import read_messages
from sar_estimator.common import topics
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_sim.flight.replay import Tolerance, compare, flown_with, replay
from sar_sim.flight.replay_cli import main

BAGS = Path(__file__).parent / "bags"
SEEDS = {"one_corner": 5, "one_corner_in_wind": 6, "one_corner_human": 7}
ESTIMATOR = EstimatorParameters()


@pytest.fixture(scope="module")
def events():
    return list(read_messages(BAGS / "one_corner"))


def differences(events, limits=None):
    flown = flown_with(events, ESTIMATOR, 0.1)
    return compare(events, replay(events, flown), limits or Tolerance()).differences


@pytest.mark.parametrize("name", SEEDS)
def test_reference_flights_are_decided_as_they_were(name, capsys):
    assert main([str(BAGS / name)]) == 0
    out = capsys.readouterr().out
    assert "no difference" in out
    compared = {line.split()[0]: int(line.split()[1]) for line in out.splitlines()[:-1]}
    assert compared[topics.WAYPOINTS] >= 5
    assert compared[topics.CLEARED] >= 5
    assert compared[topics.CORNER] > 5
    assert compared[topics.HELICOPTER_ODOMETRY] > 500


@pytest.mark.parametrize("kernel", [None, "Nehalem"])
@pytest.mark.parametrize("name", SEEDS)
def test_reference_flights_are_flown_as_they_were(name, kernel, tmp_path, capsys):
    """The whole loop, simulation included: what was decided then is decided now.

    On any processor: another kernel of the linear algebra rounds the last bits differently.
    """
    arguments = ["--scenario", str(BAGS / f"{name}.yaml"), "--seed", str(SEEDS[name])]
    chosen = {} if kernel is None else {"OPENBLAS_CORETYPE": kernel}
    alone = [
        sys.executable,
        "-m",
        "sar_sim.flight.fly_cli",
        *arguments,
        "--out",
        str(tmp_path),
        "--quiet",
    ]
    subprocess.run(alone, env={**os.environ, **chosen}, check=True, timeout=120)
    now = list(read_messages(tmp_path / "bag"))
    then = list(read_messages(BAGS / name))
    assert compare(then, now, Tolerance()).differences == []
    reference = tmp_path / "reference"
    assert main([str(tmp_path / "bag"), "--reference", str(reference)]) == 0
    assert compare(then, list(read_messages(reference)), Tolerance()).differences == []
    told = {topic for topic, _, _ in read_messages(reference)}
    # A reference may be from before the time of a fix was told.
    assert told == {topic for topic, _, _ in then} | {topics.FIX_TIME}
    assert topics.FIX_TIME in told


def changed(events, topic, number, change):
    """Return the events with one message of a topic changed."""
    events = list(events)
    at = [i for i, event in enumerate(events) if event[0] == topic][number]
    message = copy.deepcopy(events[at][2])
    change(message)
    events[at] = (topic, events[at][1], message)
    return events, events[at][1]


def test_a_fix_that_was_another_one_shows_in_what_is_estimated_from_then_on(events):
    def aside(message):
        message.latitude += 10.0 / 111_000.0

    moved, at_s = changed(events, topics.FIX, 60, aside)
    found = differences(moved)
    assert found[0].time_s == pytest.approx(at_s, abs=0.11)
    assert found[0].topic in (topics.HELICOPTER_ODOMETRY, topics.LEG)
    assert found == sorted(found)
    # What comes in is compared, not what comes of it: the planner was told what it was told.
    assert {one.topic for one in found} <= {
        topics.HELICOPTER_ODOMETRY,
        topics.LEG,
        topics.CORNER,
        topics.PREDICTION,
        topics.PHASE,
    }


def test_other_parameters_show_in_what_is_planned(events):
    def slower(message):
        (value,) = (one for one in message.values if one.key == "mission.reaction_s")
        value.value = "1.5"

    other, _ = changed(events, topics.MISSION, 0, slower)
    found = differences(other)
    corner_s = next(time_s for topic, time_s, _ in events if topic == topics.CORNER_PLAN)
    assert found[0].topic in (topics.WAYPOINTS, topics.CORNER_PLAN, topics.SPEED)
    assert found[0].time_s <= corner_s


def test_a_list_into_the_helicopters_way_is_not_cleared(events):
    def across(message):
        for pose in message.poses:
            pose.pose.position.x -= 250.0

    other, at_s = changed(events, topics.WAYPOINTS, 3, across)
    found = differences(other)
    cleared = next(one for one in found if one.topic == topics.CLEARED)
    assert cleared.time_s == pytest.approx(at_s, abs=0.01)
    assert cleared.what == "recorded, not replayed"
    alert = next(one for one in found if one.topic == topics.MONITOR)
    assert alert.what.startswith(("passed", "refused"))


def test_messages_are_paired_by_their_times(events):
    lists = [event for event in events if event[0] == topics.WAYPOINTS]
    missing = compare(lists, lists[:4] + lists[5:], Tolerance())
    assert [one.what for one in missing.differences] == ["recorded, not replayed"]
    assert missing.same[topics.WAYPOINTS] == len(lists) - 1
    added = compare(lists[:4] + lists[5:], lists, Tolerance())
    assert [one.what for one in added.differences] == ["replayed, not recorded"]
    late = [(topic, time_s + 0.2, message) for topic, time_s, message in events]
    phases = [event for event in late if event[0] == topics.PHASE]
    assert len(compare(events, phases, Tolerance(time_s=0.3)).differences) > len(lists)
    told = [event for event in events if event[0] == topics.PHASE]
    assert compare(told, phases, Tolerance(time_s=0.3)).differences == []
    assert len(compare(told, phases, Tolerance()).differences) == 2 * len(told)


def test_the_first_difference_is_told_with_its_time_and_topic(monkeypatch, capsys):
    monkeypatch.setattr("sar_planner.strategies.deadbeat.path_following.BESIDE_M", -1.0)
    monkeypatch.setattr("sar_planner.strategies.deadbeat.correction.CORRECTED_SHARE", 4.0)
    assert main([str(BAGS / "one_corner_human")]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[-2].startswith("t = ")
    assert re.search(
        f", ({topics.CORNER_PATH}|{topics.CORNER_PLAN}|{topics.WAYPOINTS}): ", lines[-2]
    )
    assert lines[-1].endswith("; the first")


def test_what_is_no_flight_is_told_in_one_line(events, tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"replay: {tmp_path}: ")
    assert error.count("\n") == 1
    without = [event for event in events if event[0] != topics.MISSION]
    with pytest.raises(ValueError, match="/planner/mission"):
        flown_with(without, ESTIMATOR, 0.1)

    def older(message):
        message.values.append(KeyValue(key="mission.unknown_m", value="1.0"))

    with pytest.raises(ValueError, match="unknown_m"):
        flown_with(changed(events, topics.MISSION, 0, older)[0], ESTIMATOR, 0.1)
