"""``bench``: what the software costs on this machine: estimator, replan, campaigns, the graph."""

from __future__ import annotations

import argparse
import json
import math
import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import yaml
from filterpy.kalman import KalmanFilter

from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.parameters import EstimatorParameters
from sar_planner.cli.replan_benchmark import LISTS, replan_times_ms
from sar_sim.bench.bench import Figure, as_json, cpu_ticks, memory_kb, node_name, private_kb
from sar_sim.bench.probe_node import bare_delays_s, flown_pace, graph_delays_s
from sar_sim.campaign.missions import fly
from sar_sim.jobs.pool import Workers
from sar_sim.jobs.processes import end_flight, folder_bytes, start_flight
from sar_sim.launch.launch_cli import free_port
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Pattern, Scenario, load_scenario, scenario_document
from sar_sim.world.world import World

REPLANS = 2000
LAGS_M = (-150.0, 1000.0)
LEG_M = 1500.0
POOL_MISSIONS = 4
SETTLING_S, SAMPLED_S = 20.0, 60.0
BEGUN_S, BEGUN_BYTES = 60.0, 20_000
LONG_SPEED, GROWN_S, SAMPLE_S, SLOWEST = 10.0, 600.0, 10.0, 1.5
HELD = 0.98
UNASKED = ("estimator", "replan", "campaign", "load", "speed", "chain")


def estimator() -> Iterator[Figure]:
    """Time an estimator's step against two bare filterpy filters' predict and update."""
    world = World(load_scenario(find_scenario("closed_loop")))
    fixes = []
    while not world.finished:
        fixes += [reception.fix for reception in world.step()]
    tested = HelicopterEstimator(EstimatorParameters(), world.datum)
    bare = KalmanFilter(dim_x=6, dim_z=2)
    bare.F, bare.H = np.eye(6) + 0.1 * np.eye(6, k=1), np.eye(2, 6)
    steps, updates = [], []
    for fix in fixes:
        begun = time.perf_counter()
        tested.add_fix(fix)
        between = time.perf_counter()
        bare.predict()
        bare.update(np.zeros(2))
        updates.append(time.perf_counter() - between)
        steps.append(between - begun)
    step, update = float(np.median(steps)), float(np.median(updates))
    yield Figure("estimator", "step, a fix in, leg and corner out", 1e3 * step, "ms")
    yield Figure("estimator", "two bare filterpy filters, predict and update", 2e3 * update, "ms")
    yield Figure("estimator", "step over two bare filterpy filters", 0.5 * step / update, "", 3.0)


def replans() -> Iterator[Figure]:
    """Time the choice of a rule, its separation check and its waypoint list."""
    for name, tuning in LISTS.items():
        times = replan_times_ms(REPLANS, LAGS_M, tuning)
        yield Figure("replan", f"median, {name}", float(np.median(times)), "ms", 2.0)
        yield Figure("replan", f"p99, {name}", float(np.percentile(times, 99)), "ms", 5.0)


def _long(corners: int) -> Scenario:
    """Return a mission of many corners and legs that do not grow."""
    base = load_scenario(find_scenario("arduplane"))
    pattern = Pattern(first_leg_m=LEG_M, last_leg_m=LEG_M, corners=corners, track_spacing_m=1e-3)
    return replace(base, pattern=pattern)


def _pace(corners: int) -> float:
    """Return how many times faster than real time a mission is flown offline, CPU time counted."""
    begun = time.process_time()
    flown = fly(_long(corners), "deadbeat")
    return flown.flown_s / (time.process_time() - begun)


def _fly_one(_number: int) -> None:
    fly(_long(4), "deadbeat")


def _missions_s(workers: int) -> float:
    with Workers(workers) as pool:
        list(pool.map(_fly_one, range(workers)))  # everything is imported
        begun = time.monotonic()
        list(pool.map(_fly_one, range(POOL_MISSIONS)))
        return time.monotonic() - begun


def campaigns(corners: list[int]) -> Iterator[Figure]:
    """Fly whole closed-loop missions offline: how fast, and how that grows."""
    _fly_one(0)  # everything is imported
    paces = [_pace(count) for count in corners]
    for count, pace in zip(corners, paces, strict=True):
        asked = 1000.0 if count == corners[0] else None
        what = f"x real time a core, {count} corners"
        yield Figure("campaign", what, pace, "", asked, at_least=True)
    growth = paces[0] / paces[-1]
    what = f"time a corner, {corners[-1]} corners over {corners[0]}"
    yield Figure("campaign", what, growth, "", 1.2)
    one, two = _missions_s(1), _missions_s(2)
    yield Figure("campaign", "two workers over one", one / two, "", 1.8, at_least=True)


def _family(process: int) -> list[int]:
    """Return a process and all that come from it."""
    found = [process]
    for one in found:
        for task in Path(f"/proc/{one}/task").glob("*/children"):
            found += [int(child) for child in task.read_text("utf-8").split()]
    return found


def _used(process: int) -> tuple[float, float]:
    """Return CPU time [s] and memory [MB] of a process and all that come from it, as of now."""
    ticks = kilobytes = 0
    for one in _family(process):
        ticks += cpu_ticks(Path(f"/proc/{one}/stat").read_text("utf-8"))
        kilobytes += memory_kb(Path(f"/proc/{one}/smaps_rollup").read_text("utf-8"))
    return ticks / os.sysconf("SC_CLK_TCK"), kilobytes / 1024.0


def _await_flight(flight: subprocess.Popen[str], out: Path) -> None:
    """Wait until a flight that was started has begun: its nodes are recorded."""
    latest = time.monotonic() + BEGUN_S
    while time.monotonic() < latest and flight.poll() is None:
        if folder_bytes(out / "bag") > BEGUN_BYTES:
            return
        time.sleep(0.2)


def graph_load(scratch: Path) -> Iterator[Figure]:
    """Fly the whole graph at real time for a while: CPU, memory, and what is recorded."""
    page = ("--console-port", str(free_port(socket.SOCK_STREAM)))
    flight = start_flight(scratch / "load", "--scenario", "arduplane", "--speed", "1", *page)
    bag = scratch / "load" / "bag" / "bag.mcap"
    try:
        _await_flight(flight, scratch / "load")
        time.sleep(SETTLING_S)
        empty, before, begun = bag.stat().st_size, _used(flight.pid)[0], time.monotonic()
        time.sleep(SAMPLED_S)
        after, memory = _used(flight.pid)
        lasted_s, recorded = time.monotonic() - begun, bag.stat().st_size - empty
    finally:
        end_flight(flight)
    yield Figure(
        "graph", "CPU at real time, of one core", 100.0 * (after - before) / lasted_s, "%", 40.0
    )
    yield Figure("graph", "memory, proportional set size of all processes", memory, "MB", 900.0)
    yield Figure("graph", "recorded in an hour", 3.6e-3 * recorded / lasted_s, "MB", 80.0)


def _nodes_mb(process: int) -> dict[str, float]:
    """Return the memory of its own [MB] of every node that comes from a process, as of now."""
    found = {}
    for one in _family(process):
        name = node_name(Path(f"/proc/{one}/cmdline").read_text("utf-8"))
        if name is not None:
            rollup = Path(f"/proc/{one}/smaps_rollup").read_text("utf-8")
            found[name] = private_kb(rollup) / 1024.0
    return found


def graph_memory(scratch: Path, hours: float) -> Iterator[Figure]:
    """Fly the whole graph for hours, faster than real time: what every node grows by."""
    file, seconds = scratch / "long.yaml", 3600.0 * hours
    corners = math.ceil(seconds * _long(1).corner.speed_mps / LEG_M)
    file.write_text(yaml.safe_dump(scenario_document(_long(corners))), encoding="utf-8")
    out = scratch / "memory"
    flight = start_flight(out, "--scenario", str(file), "--speed", str(LONG_SPEED))
    sizes: dict[str, list[float]] = {}
    try:
        _await_flight(flight, out)
        time.sleep(SETTLING_S + GROWN_S / LONG_SPEED)
        latest = time.monotonic() + SLOWEST * (seconds - GROWN_S) / LONG_SPEED
        while time.monotonic() < latest and flight.poll() is None:
            for name, size in _nodes_mb(flight.pid).items():
                sizes.setdefault(name, []).append(size)
            time.sleep(SAMPLE_S)
    finally:
        end_flight(flight)
    flown_s = json.loads((out / "metrics.json").read_text("utf-8"))["duration_s"]
    yield Figure("memory", "flown", flown_s / 3600.0, "h", hours, at_least=True)
    for name, found in sizes.items():
        yield Figure("memory", f"{name}, {GROWN_S / 60.0:.0f} min into the flight", found[0], "MB")
        yield Figure("memory", f"{name}, most after that, more", max(found) - found[0], "MB", 10.0)


def graph_speed(scratch: Path) -> Iterator[Figure]:
    """Fly the whole graph faster than real time: it should hold the rate, and lead as well."""
    for speed in (10, 20):
        out = scratch / f"speed{speed}"
        begun = time.monotonic()
        in_flight = flown_pace(out, "closed_loop", speed)
        metrics = json.loads((out / "metrics.json").read_text("utf-8"))
        pace = metrics["duration_s"] / (time.monotonic() - begun)
        late = max(abs(lag) for lag in metrics["lag_m"][2:])
        what = f"x real time with --speed {speed}"
        yield Figure("graph", f"{what}, in flight", in_flight, "", HELD * speed, at_least=True)
        yield Figure("graph", f"{what}, start and report included", pace, "")
        yield Figure("graph", f"|L(k)| from corner 3, --speed {speed}", late, "m", 15.0)


def chain(scratch: Path) -> Iterator[Figure]:
    """Time fix -> list -> mission accepted in the graph, and the same hops without any content."""
    found, waypoints = graph_delays_s(scratch / "chain")
    listed = float(np.median([one[0] for one in found]))
    accepted = float(np.median([sum(one) for one in found]))
    bare = float(np.median(bare_delays_s(waypoints)))
    yield Figure("chain", "fix received to list published, median", 1e3 * listed, "ms")
    yield Figure("chain", "fix received to mission accepted, median", 1e3 * accepted, "ms")
    what = f"the same hops, {waypoints} waypoints, nothing computed, median"
    yield Figure("chain", what, 1e3 * bare, "ms")
    yield Figure("chain", "graph over bare chain", accepted / bare, "", 3.0)


def main(argv: list[str] | None = None) -> int:
    """Measure and print; 1 when a flight failed."""
    parser = argparse.ArgumentParser(prog="bench", description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file, too")
    parser.add_argument("--only", nargs="+", default=[], help="these parts")
    parser.add_argument(
        "--hours", type=float, default=8.0, help="of flight that memory, only on demand, looks at"
    )
    parser.add_argument(
        "--corners", type=int, nargs="+", default=[10, 1000], help="missions' lengths"
    )
    args = parser.parse_args(argv)
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        parts: dict[str, Callable[[], Iterator[Figure]]] = {
            "estimator": estimator,
            "replan": replans,
            "campaign": partial(campaigns, args.corners),
            "load": partial(graph_load, scratch),
            "speed": partial(graph_speed, scratch),
            "chain": partial(chain, scratch),
            "memory": partial(graph_memory, scratch, args.hours),
        }
        unknown = [name for name in args.only if name not in parts]
        if unknown:
            parser.error(f"--only {unknown[0]}: expected one of {', '.join(parts)}")
        figures: list[Figure] = []
        try:
            for name, measure in parts.items():
                for figure in measure() if name in (args.only or UNASKED) else ():
                    figures.append(figure)
                    sys.stdout.write(figure.row() + "\n")
                    sys.stdout.flush()
        except (OSError, ValueError, subprocess.TimeoutExpired) as error:
            sys.stderr.write(f"bench: {error}\n")
            return 1
    if args.json is not None:
        args.json.write_text(as_json(figures), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
