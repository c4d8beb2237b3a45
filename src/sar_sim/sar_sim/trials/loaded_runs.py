"""Flights of the whole graph on a busy machine: what keeps it busy, and what came of them."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sar_estimator.bags.bag import read_messages
from sar_estimator.common import topics
from sar_estimator.common.statuses import values_of
from sar_estimator.common.wires import WIRES
from sar_sim.campaign.missions import seeded
from sar_sim.report.flight_data import read_flight
from sar_sim.report.metrics import separation
from sar_sim.scenario.scenario import Scenario

ONE_CORE, NOTHING = "one_core", "none"
HOG = "while True: pass"
WRITER = """
import os, sys
with open(sys.argv[1], "wb", buffering=0) as file:
    while True:
        file.seek(0)
        for _ in range(64):
            file.write(os.urandom(1 << 18))
        os.fsync(file.fileno())
"""
LEG_M = 1500.0
WATCHED = ("planner", "monitor")
LATE = ("fix_late_s", "list_late_s")
HEADER = (
    "| load | seed | closest approach, m | escapes | planner: fixes, s | lists, s | planned with, s"
    " | monitor: fixes, s | lists, s | flown / real time |\n"
    "|---|---|---|---|---|---|---|---|---|---|"
)


@dataclass(frozen=True, slots=True)
class Load:
    """What keeps the machine busy: programs that compute, that write; or one core for all."""

    cpu: int = 0
    io: int = 0
    one_core: bool = False

    def __str__(self) -> str:
        """Return it as it is asked for."""
        parts = [f"cpu{self.cpu}"] * bool(self.cpu) + [f"io{self.io}"] * bool(self.io)
        return ",".join(parts + [ONE_CORE] * self.one_core) or NOTHING

    def commands(self, scratch: Path, stress_ng: str | None) -> list[list[str]]:
        """Return the programs; ``scratch``: folder to write in, ``stress_ng``: program or None."""
        if stress_ng is not None and self.cpu + self.io > 0:
            words = [stress_ng, "--temp-path", str(scratch), "--quiet"]
            words += ["--cpu", str(self.cpu)] if self.cpu else []
            return [words + (["--hdd", str(self.io)] if self.io else [])]
        writers = [str(scratch / f"written_{i}") for i in range(self.io)]
        return [[sys.executable, "-c", HOG]] * self.cpu + [
            [sys.executable, "-c", WRITER, file] for file in writers
        ]


def load_of(text: str) -> Load:
    """Return a load by its name: ``cpu4,io2``, ``one_core``, ``none``. Raises ``ValueError``."""
    found = Load()
    for part in text.split(","):
        number = re.fullmatch(r"(cpu|io)([1-9]\d?)", part)
        if number is not None and getattr(found, number[1]) == 0:
            count = int(number[2])
            found = replace(found, cpu=count) if number[1] == "cpu" else replace(found, io=count)
        elif part == ONE_CORE and not found.one_core:
            found = replace(found, one_core=True)
        elif text != NOTHING:
            raise ValueError(f"load {text}: expected cpuN,ioN, {ONE_CORE} or {NOTHING}")
    return found


def loaded_scenario(base: Scenario, seed: int, corners: int) -> Scenario:
    """Return a short flight with few corners, drawn from a seed: some 5 minutes with two."""
    pattern = replace(base.pattern, first_leg_m=LEG_M, last_leg_m=LEG_M, corners=corners)
    short = replace(base, name="loaded", pattern=pattern, uav=replace(base.uav, lag_m=0.0))
    return seeded(short, seed, None)


@dataclass(frozen=True, slots=True)
class LoadedRun:
    """What came of a flight.

    ``late_s``: the most that planner and monitor told of ``LATE``, by node and name [s].
    ``reaction_s``: the most that was planned with. ``pace``: flown over real time.
    """

    load: Load
    seed: int
    separation_m: float
    escapes: int
    late_s: dict[tuple[str, str], float]
    reaction_s: float
    pace: float

    def row(self) -> str:
        """Return it as a row of the table."""
        late = [f"{self.late_s[node, name]:.1f}" for node in WATCHED for name in LATE]
        late.insert(len(LATE), f"{self.reaction_s:.1f}")
        first = [str(self.load), str(self.seed), f"{self.separation_m:.0f}", str(self.escapes)]
        return f"| {' | '.join([*first, *late, f'{self.pace:.2f}'])} |"


def read_loaded(load: Load, seed: int, bag: Path, real_s: float) -> LoadedRun:
    """Return what came of a flight that took ``real_s``, its start and report included.

    Raises ``ValueError`` when the bag has no flight in it.
    """
    times, distances = separation(read_flight(bag))
    if len(times) == 0:
        raise ValueError(f"{bag}: expected a flight of both aircraft")
    late = dict.fromkeys(((node, name) for node in WATCHED for name in LATE), 0.0)
    reaction, escapes = 0.0, 0
    for topic, _, message in read_messages(bag, {topics.DIAGNOSTICS, topics.MONITOR}):
        if topic == topics.MONITOR:
            escapes = WIRES[topic].from_message(message).counts.get("escape", 0)
            continue
        for status in message.status:
            told = values_of(status)
            for name in LATE if status.name in WATCHED else ():
                key = status.name, name
                late[key] = max(late[key], _figure(told.get(name)))
            if status.name == "planner":
                reaction = max(reaction, _figure(told.get("reaction_s")))
    flown_s = float(times[-1] - times[0])
    return LoadedRun(
        load, seed, float(distances.min()), escapes, late, reaction, flown_s / max(real_s, 1e-3)
    )


def _figure(value: Any) -> float:
    """Return a figure of a status, 0 for none."""
    return float(value) if value else 0.0


def summary(runs: Sequence[LoadedRun]) -> str:
    """Return the worst of all flights of a load, in one line."""
    least = min((run.separation_m for run in runs), default=math.inf)
    late = [max((run.late_s[node, name] for run in runs), default=0.0)
            for node in WATCHED for name in LATE]  # fmt: skip
    return (
        f"{runs[0].load}: {len(runs)} flights, closest approach {least:.0f} m, "
        f"{sum(run.escapes for run in runs)} escapes; most late: planner's fixes {late[0]:.1f} s, "
        f"lists {late[1]:.1f} s, monitor's fixes {late[2]:.1f} s, lists {late[3]:.1f} s"
    )
