"""Flights of the whole graph with one fault each, and what came of them, from their bags."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from sar_estimator.bags.bag import read_messages
from sar_estimator.common import topics
from sar_estimator.common.wires import WIRES
from sar_sim.report.flight_data import read_flight
from sar_sim.report.metrics import separation, true_lag_m
from sar_sim.scenario.scenario import NODES, Fault, Pattern, Scenario

AT_S = 60.0
SIZED = ("wrong", "slow", "delayed")
FIGURES = re.compile(r"[\d.]+")
CASES: tuple[Fault, ...] = (
    Fault("gps", "off", AT_S),
    Fault("gps", "off", AT_S, 120.0),
    Fault("gps", "stuck", AT_S),
    Fault("gps", "garbage", AT_S),
    Fault("gps", "wrong", AT_S, 30.0, 150.0),
    Fault("gps", "slow", AT_S, 60.0, 4.0),
    Fault("gps", "delayed", AT_S, 60.0, 3.0),
    Fault("gps", "intermittent", AT_S, 60.0, 0.5),
    Fault("radio", "off", AT_S),
    Fault("radio", "slow", AT_S, 60.0, 3.0),
    Fault("radio", "intermittent", AT_S, 60.0, 0.4),
    Fault("autopilot", "off", AT_S, 3.0),
    Fault("mode", "wrong", AT_S),
    Fault("clock", "wrong", AT_S, size=30.0),
    Fault("clock", "wrong", AT_S, size=-30.0),
    Fault("dds", "off", AT_S, 30.0),
    *(Fault(name, "off", AT_S) for name in NODES),
    *(Fault(name, "stuck", AT_S, 30.0) for name in NODES),
)
# What shows that a node does its work.
WORK = {
    "estimator": topics.HELICOPTER_ODOMETRY,
    "planner": topics.LAG,
    "monitor": topics.DIAGNOSTICS,
    "bridge": topics.UAV_ODOMETRY,
}
HEADER = (
    "| fault | said first | after, s | node at work after, s | what the UAV did "
    "| closest approach, m | L(k), m |\n"
    "|---|---|---|---|---|---|---|"
)


@dataclass(frozen=True)
class FaultRun:
    """One flight: the fault, the first word about it, the UAV's modes, distances [m].

    ``after_s``: of the first word; ``silent_s``: for how long the node that failed did no work.
    """

    fault: Fault
    said: str
    after_s: float | None
    silent_s: float | None
    modes: tuple[str, ...]
    separation_m: float
    lags_m: tuple[float, ...]

    def row(self) -> str:
        """Return it as a row of the table."""
        fault = self.fault
        sized = fault.kind in SIZED and fault.component != "mode"
        size = f", {fault.size:g}" if sized else ""
        size = f", {fault.size:.0%}" if fault.kind == "intermittent" else size
        at_once = fault.component in ("mode", "clock")
        at_once = at_once or (fault.component in NODES and fault.kind == "off")
        length = "" if at_once else f" {fault.for_s:g} s"
        # A node is killed, missed and started in real time, at any speed of the simulation.
        real = fault_speed(fault) if fault.component in NODES else 1.0
        after, back = (
            "–" if time_s is None else f"{time_s / real:.1f}"
            for time_s in (self.after_s, self.silent_s)
        )
        lags = ", ".join(f"{lag:.0f}" for lag in self.lags_m)
        return (
            f"| {fault.component} {fault.kind}{size}{length} | {self.said or '–'} | {after} | "
            f"{back} | {' → '.join(self.modes)} | {self.separation_m:.0f} | {lags} |"
        )


def fault_scenario(base: Scenario, fault: Fault) -> Scenario:
    """Return a short square with one fault, half a minute before the first corner ends."""
    return replace(
        base,
        name="fault",
        pattern=Pattern(first_leg_m=1500.0, last_leg_m=1500.0, corners=3),
        uav=replace(base.uav, lag_m=0.0),
        faults=[fault],
    )


def fault_speed(fault: Fault) -> float:
    """Return the speed to fly at: a node takes as long to start at any."""
    return 4.0 if fault.component in (*NODES, "dds", "autopilot") else 10.0


def _problems(message: Any) -> list[str]:
    return [
        f"{status.name}: {status.message}"
        for status in message.status
        if status.level > 0  # rosbags reads an octet as a number
    ]


def silent_s(fault: Fault, bag: Path) -> float | None:
    """Return the longest time [s] for which a node did no work since it failed; None of others."""
    if fault.component not in WORK:
        return None
    topic, seen = WORK[fault.component], [fault.at_s]
    for _, time_s, message in read_messages(bag, {topic}):
        told = getattr(message, "status", None)
        mine = told is None or any(status.name == fault.component for status in told)
        if mine and time_s > fault.at_s:
            seen.append(time_s)
    return max((later - time_s for time_s, later in pairwise(seen)), default=None)


def read_run(fault: Fault, bag: Path) -> FaultRun:
    """Return what came of a flight. Raises ``ValueError`` when the bag has no flight in it."""
    data = read_flight(bag)
    _, distances = separation(data)
    said, after = "", None
    modes: list[str] = []
    known: set[str] = set()
    alert = "none"
    stepped_s = fault.size if fault.component == "clock" else 0.0
    for topic, time_s, message in read_messages(
        bag, {topics.DIAGNOSTICS, topics.MODE, topics.MONITOR}
    ):
        if stepped_s < 0.0 and time_s < fault.at_s:
            continue  # what was recorded before and after it was set back is mixed here
        if topic == topics.MODE and (not modes or modes[-1] != message.data):
            modes.append(message.data)
        if topic == topics.MONITOR:
            was, alert = alert, WIRES[topic].from_message(message).alert
            if alert == "escape" != was:
                modes.append("away")
        if topic == topics.DIAGNOSTICS:
            for problem in _problems(message):
                kind = FIGURES.sub("", problem)
                if time_s < fault.at_s:
                    known.add(kind)
                elif not said and kind not in known:
                    said, after = problem, time_s - fault.at_s - stepped_s
    lags = tuple(true_lag_m(data, corner) for corner in data.corners)
    silent, closest = silent_s(fault, bag), float(distances.min())
    return FaultRun(fault, said, after, silent, tuple(modes), closest, lags)
