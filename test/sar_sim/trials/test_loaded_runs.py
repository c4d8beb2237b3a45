"""Flights on a busy machine: the load, the scenario, and what is read of a flight."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_estimator.bags.bag import BagWriter
from sar_estimator.common import topics
from sar_estimator.common.reports import Health, MonitorReport
from sar_sim.flight.offline import OfflineFlight
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import load_scenario
from sar_sim.trials import loaded_flights_cli
from sar_sim.trials.loaded_runs import (
    HEADER,
    Load,
    LoadedRun,
    load_of,
    loaded_scenario,
    read_loaded,
    summary,
)


@given(st.integers(0, 99), st.integers(0, 99), st.booleans())
def test_a_load_is_read_as_it_is_written(cpu, io, one_core):
    load = Load(cpu, io, one_core)
    assert load_of(str(load)) == load


@pytest.mark.parametrize("text", ["", "cpu", "cpu0", "cpu4,cpu2", "one_core,one_core", "gpu1"])
def test_what_is_no_load_is_refused_by_name(text):
    with pytest.raises(ValueError, match=f"load {text}: expected cpuN"):
        load_of(text)


def test_the_load_is_programs_of_this_python_or_stress_ng():
    commands = Load(4, 2).commands(Path("scratch"), None)
    assert [command[0] for command in commands] == [sys.executable] * 6
    (one,) = Load(4, 2).commands(Path("scratch"), "/usr/bin/stress-ng")
    assert one[0] == "/usr/bin/stress-ng"
    assert one[one.index("--cpu") + 1] == "4"
    assert one[one.index("--hdd") + 1] == "2"
    assert Load(one_core=True).commands(Path("scratch"), "/usr/bin/stress-ng") == []


@pytest.mark.timeout(60)
def test_what_keeps_busy_works_writes_and_ends(tmp_path, monkeypatch):
    monkeypatch.setattr(loaded_flights_cli.shutil, "which", lambda _: None)
    with loaded_flights_cli.busy(Load(1, 1), tmp_path):
        latest = time.monotonic() + 40.0
        while not list(tmp_path.glob("written_*")):
            assert time.monotonic() < latest
            time.sleep(0.05)
        found = working(tmp_path)
        assert len(found) == 1
    assert working(tmp_path) == []


def working(folder):
    """Return the processes of this machine that write in a folder."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / "cmdline").read_bytes().decode().split("\0")
            except OSError:
                continue
            found += [entry.name] if any(str(folder) in word for word in words) else []
    return found


def test_one_core_is_the_first_that_may_be_used(tmp_path):
    command = loaded_flights_cli.command_of(Load(one_core=True), tmp_path, [])
    done = subprocess.run(
        [*command[:3], sys.executable, "-c", "import os; print(os.sched_getaffinity(0))"],
        capture_output=True,
        text=True,
        timeout=30,
        check=True,
    )
    assert done.stdout.strip() == str({min(os.sched_getaffinity(0))})
    assert loaded_flights_cli.command_of(Load(4), tmp_path, [])[0] == sys.executable


def test_flights_are_short_and_each_seed_is_another():
    base = load_scenario(find_scenario("human"))
    one, other = loaded_scenario(base, 1, 2), loaded_scenario(base, 2, 2)
    assert one.pattern.corners == 2
    assert (one.pilot.seed, one.gps.seed) != (other.pilot.seed, other.gps.seed)
    assert one == loaded_scenario(base, 1, 2)


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    """A flight offline of a corner, in which planner and monitor were late."""
    folder = tmp_path_factory.mktemp("loaded") / "bag"
    base = load_scenario(find_scenario("arduplane"))
    writer = BagWriter(folder)
    flight = OfflineFlight(loaded_scenario(base, 1, 1), bag=writer)
    flight.run()
    for name, fix, listed in (("planner", "0.7", "3.4"), ("monitor", "2.2", "")):
        late = {"fix_late_s": fix, "list_late_s": listed, "reaction_s": "3.4"}
        flight._record(topics.DIAGNOSTICS, Health(name, "", late))
    flight._record(topics.DIAGNOSTICS, Health("bridge", "", {"list_late_s": "9.9"}))
    flight._record(topics.MONITOR, MonitorReport(counts={"escape": 2}))
    writer.close()
    return folder


def test_a_flight_is_read_with_what_was_told_of_it(bag):
    run = read_loaded(Load(4, 2), 1, bag, 400.0)
    assert 150.0 < run.separation_m < 260.0
    assert run.escapes == 2
    assert run.late_s["planner", "fix_late_s"] == 0.7
    assert run.late_s["planner", "list_late_s"] == 3.4
    assert run.late_s["monitor", "fix_late_s"] == 2.2
    assert run.late_s["monitor", "list_late_s"] < 2.0
    assert run.reaction_s == 3.4
    assert 0.1 < run.pace < 1.0
    assert run.row().count("|") == HEADER.splitlines()[0].count("|")
    assert run.row().startswith("| cpu4,io2 | 1 | ")
    told = summary([run, run])
    assert told.startswith("cpu4,io2: 2 flights")
    assert "4 escapes" in told
    assert "lists 3.4 s" in told


def test_flights_that_fail_are_said_and_the_next_is_flown(monkeypatch, capsys, tmp_path):
    def fly(load, _scenario, seed, _out, options):
        assert options == ["--speed", "1", "--no-priorities"]
        if seed == 2:
            raise OSError("it failed")
        return LoadedRun(load, seed, 200.0 + seed, 0, dict.fromkeys(LATE, 0.1), 1.0, 0.9)

    monkeypatch.setattr(loaded_flights_cli, "fly", fly)
    options = ["--flights", "3", "--load", "one_core", "--no-priorities", "--keep", str(tmp_path)]
    assert loaded_flights_cli.main(options) == 1
    told, errors = capsys.readouterr()
    assert len([line for line in told.splitlines() if line.startswith("| one_core |")]) == 2
    assert "one_core: 2 flights, closest approach 201 m" in told
    assert "it failed" in errors


def test_bad_input_is_refused_in_one_line(capsys):
    assert loaded_flights_cli.main(["--load", "gpu"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


LATE = [(node, name) for node in ("planner", "monitor") for name in ("fix_late_s", "list_late_s")]
