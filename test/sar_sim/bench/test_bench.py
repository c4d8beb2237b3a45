"""What ``bench`` measures is told as it is, and how."""

import json
import os
import time

import pytest

from sar_estimator.common import topics
from sar_estimator.common.reports import Uploaded
from sar_estimator.common.wires import WIRES
from sar_sim.bench import bench_cli
from sar_sim.bench.bench import (
    Figure,
    as_json,
    cpu_ticks,
    delays,
    memory_kb,
    node_name,
    pace,
    private_kb,
)
from sar_sim.bench.probe_node import Probe


def test_a_figure_is_met_or_not():
    assert Figure("replan", "median", 1.9, "ms", 2.0).met is True
    assert Figure("replan", "median", 2.1, "ms", 2.0).met is False
    assert Figure("campaign", "x real time", 900.0, "", 1000.0, at_least=True).met is False
    assert Figure("campaign", "x real time", 1200.0, "", 1000.0, at_least=True).met is True
    assert Figure("estimator", "step", 0.5, "ms").met is None


def test_a_row_says_what_is_asked_and_whether_it_is_met():
    row = Figure("replan", "median", 2.125, "ms", 2.0).row()
    assert row.split() == ["replan", "median", "2.12", "ms", "≤", "2", "NOT", "MET"]
    row = Figure("campaign", "x real time", 1234.4, "", 1000.0, at_least=True).row()
    assert row.split() == ["campaign", "x", "real", "time", "1234", "≥", "1000", "met"]
    (found,) = json.loads(as_json([Figure("graph", "CPU", 27.0, "%", 30.0)]))
    assert found["met"] is True
    assert found["value"] == 27.0


def test_what_others_share_is_no_memory_of_its_own():
    rollup = "[rollup]\nPss:  412 kB\nPrivate_Clean: 30 kB\nPrivate_Dirty: 300 kB\nSwap: 0 kB\n"
    assert private_kb(rollup) == 330


def test_memory_and_cpu_time_are_read_as_the_kernel_tells_them():
    assert memory_kb("55e0-7fff ---p [rollup]\nRss:  900 kB\nPss:  412 kB\nPss_Anon: 7 kB\n") == 412
    assert memory_kb("") == 0
    stat = "17 (a) name)) S 1 17 17 0 -1 4194560 1 0 0 0 120 30 0 0 20 0 1 0 5 6 7"
    assert cpu_ticks(stat) == 150
    begun, until = bench_cli._used(os.getpid())[0], time.process_time() + 0.3
    while time.process_time() < until:
        pass
    used, memory = bench_cli._used(os.getpid())
    assert used - begun == pytest.approx(0.3, abs=0.15)
    assert 20.0 < memory < 2000.0


def test_a_node_is_known_by_its_command():
    command = (
        "/usr/bin/python3\0/ws/install/lib/sar_planner/planner\0--ros-args\0--params-file\0x\0"
    )
    assert node_name(command) == "planner"
    assert node_name("/usr/bin/python3\0-m\0sar_sim.launch_cli\0--out\0x\0") is None
    assert node_name("") is None


def test_pace_is_of_the_flight_alone():
    seen = [(100.0 + 0.05 * second, 7.0 + second) for second in range(50)]
    assert pace(seen) == pytest.approx(20.0)
    with pytest.raises(ValueError, match="1 fixes seen: expected two or more"):
        pace(seen[:1])


def test_delays_are_of_lists_that_were_made_for_a_fix():
    fixes = [10.0, 11.0, 12.0]
    lists = {1.0: 10.02, 2.0: 11.9, 3.0: 12.05, 4.0: 9.0}
    accepted = {1.0: 10.06, 2.0: 11.95, 3.0: 12.09, 4.0: 9.1, 5.0: 13.0}
    found = delays(fixes, lists, accepted, 0.3)
    assert found == [pytest.approx((0.02, 0.04)), pytest.approx((0.05, 0.04))]


def test_parts_are_chosen_by_name(tmp_path, capsys):
    file = tmp_path / "bench.json"
    assert bench_cli.main(["--only", "estimator", "--json", str(file)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    assert all(line.startswith("estimator ") for line in lines)
    ratio = json.loads(file.read_text(encoding="utf-8"))[2]
    assert ratio["what"] == "step over two bare filterpy filters"
    assert ratio["value"] > 1.0
    with pytest.raises(SystemExit) as ended:
        bench_cli.main(["--only", "speeed"])
    assert ended.value.code == 2
    assert "expected one of estimator, replan" in capsys.readouterr().err


def test_a_flight_that_fails_is_one_line(monkeypatch, capsys):
    monkeypatch.setattr(bench_cli, "SETTLING_S", 0.2)
    monkeypatch.setattr(bench_cli, "SAMPLED_S", 0.1)
    launch = bench_cli.start_flight
    monkeypatch.setattr(
        bench_cli, "start_flight", lambda out, *_: launch(out, "--scenario", "nowhere")
    )
    monkeypatch.setattr(bench_cli, "_used", lambda _: (0.0, 0.0))
    assert bench_cli.main(["--only", "load"]) == 1
    assert capsys.readouterr().err.startswith("bench: the flight failed: ")


@pytest.mark.graph
@pytest.mark.timeout(120)
def test_memory_is_told_for_every_node(monkeypatch, own_domain, tmp_path):
    monkeypatch.setenv("ROS_DOMAIN_ID", own_domain["ROS_DOMAIN_ID"])
    for name, value in (("SETTLING_S", 2.0), ("GROWN_S", 20.0), ("SAMPLE_S", 1.0)):
        monkeypatch.setattr(bench_cli, name, value)
    flown, *sizes = bench_cli.graph_memory(tmp_path, 0.02)
    assert 0.005 < flown.value < 0.1
    began = {one.what.split(",")[0]: one.value for one in sizes[::2]}
    grown = {one.what.split(",")[0]: one.value for one in sizes[1::2]}
    assert (
        {"sim", "estimator", "planner", "monitor", "bridge", "record"} == set(began) == set(grown)
    )
    assert all(10.0 < size < 300.0 for size in began.values())
    assert all(0.0 <= more < 50.0 for more in grown.values())


@pytest.mark.graph
@pytest.mark.timeout(60)
def test_a_bare_chain_passes_on(monkeypatch, own_domain):
    monkeypatch.setenv("ROS_DOMAIN_ID", own_domain["ROS_DOMAIN_ID"])
    monkeypatch.setattr("sar_sim.bench.probe_node.BARE_FIXES", 5)
    from sar_sim.bench.probe_node import bare_delays_s  # noqa: PLC0415 (ROS is started there)

    found = bare_delays_s(items=10)
    assert len(found) >= 3
    assert all(0.0 < one < 2.0 for one in found)


def test_the_probe_notes_lists_that_were_accepted():
    probe = Probe.__new__(Probe)
    probe.accepted_s, probe.waypoints = {}, []
    wire = WIRES[topics.UPLOADED]
    probe._on_accepted(wire.to_message(Uploaded(12_500_000_001, 40, 210.0), 0.0))
    assert list(probe.accepted_s) == [12_500_000_001]
    assert probe.waypoints == [40]
