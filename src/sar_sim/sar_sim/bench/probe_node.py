"""Node ``probe`` of ``bench``: from a fix to a mission's acceptance, in the graph and bare."""

from __future__ import annotations

import struct
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticStatus
from nav_msgs.msg import Path as PathMessage
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import NavSatFix

from sar_estimator.common import topics
from sar_estimator.common.component_node import subscribe
from sar_estimator.common.conversions import NANOSECONDS, from_stamp, to_stamp
from sar_estimator.common.node_support import LATCHED, RELIABLE, start_ros
from sar_estimator.common.wires import WIRES
from sar_sim.bench.bare_chain_node import ACCEPTED, FIX
from sar_sim.bench.bench import delays, pace
from sar_sim.jobs.processes import end_flight, start_flight

HOPS = ("estimator", "planner", "monitor", "bridge")
BARE_FIXES = 40
BARE_PERIOD_S = 0.2
STARTING_S = 30.0
FLOWN_S = 240.0
FOR_THE_FIX_S = 0.3
CDR_BYTES, STAMP = 4, struct.Struct("<iI")  # what a serialised message with a header begins with


class Probe(Node):
    """Notes when fixes, lists and acceptances are seen, by the wall's clock."""

    def __init__(self) -> None:
        """Listen to the graph and to the bare chain.

        ``fixes``: when they were seen, and their stamps.
        """
        super().__init__("probe")
        self.fixes: list[tuple[float, float]] = []
        self.lists_s: dict[int, float] = {}
        self.accepted_s: dict[int, float] = {}
        self.waypoints: list[int] = []
        self.bare_s: list[float] = []
        self._sent_s = 0.0
        self.bare = self.create_publisher(NavSatFix, FIX, RELIABLE)
        self.create_subscription(NavSatFix, topics.FIX, self._on_fix, qos_profile_sensor_data)
        waypoints = topics.name_of(topics.WAYPOINTS)
        self.create_subscription(PathMessage, waypoints, self._on_list, LATCHED, raw=True)
        subscribe(self, topics.UPLOADED, self._on_accepted)
        self.create_subscription(DiagnosticStatus, ACCEPTED, self._on_bare, RELIABLE)

    def _on_fix(self, message: Any) -> None:
        self.fixes.append((time.perf_counter(), from_stamp(message.header.stamp)))

    def _on_list(self, data: bytes) -> None:
        """Note a list by its stamp alone: to read all of it would take what is measured."""
        sec, nanosec = STAMP.unpack_from(data, CDR_BYTES)
        self.lists_s[sec * NANOSECONDS + nanosec] = time.perf_counter()

    def _on_accepted(self, message: Any) -> None:
        uploaded = WIRES[topics.UPLOADED].from_message(message)
        self.accepted_s[uploaded.list_id] = time.perf_counter()
        self.waypoints.append(uploaded.waypoints)

    def _on_bare(self, _message: Any) -> None:
        self.bare_s.append(time.perf_counter() - self._sent_s)

    def send(self, number: int) -> None:
        """Send a fix down the bare chain."""
        message = NavSatFix()
        message.header.stamp = to_stamp(float(number))
        self._sent_s = time.perf_counter()
        self.bare.publish(message)


def _probe() -> Probe:
    start_ros(args=[])
    return Probe()


def _spin(probe: Probe, seconds: float) -> None:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        rclpy.spin_once(probe, timeout_sec=max(0.0, until - time.monotonic()))


def _flown(out: Path, *options: str) -> Probe:
    """Fly with ``launch``'s options, ``FLOWN_S`` at most; return what was seen."""
    probe = _probe()
    flight = start_flight(out, *options)
    try:
        until = time.monotonic() + FLOWN_S
        while flight.poll() is None and time.monotonic() < until:
            _spin(probe, 1.0)
    finally:
        probe.destroy_node()
        rclpy.try_shutdown()
        end_flight(flight)
    return probe


def flown_pace(out: Path, scenario: str, speed: int) -> float:
    """Fly a scenario; return how many times faster than real time it went in flight."""
    return pace(_flown(out, "--scenario", scenario, "--speed", str(speed)).fixes)


def graph_delays_s(out: Path) -> tuple[list[tuple[float, float]], int]:
    """Fly at real time; return fix to list and list to acceptance [s] of every list for a fix.

    And how many waypoints a list had, the median.
    """
    probe = _flown(out, "--scenario", "short", "--speed", "1")
    walls = [wall_s for wall_s, _ in probe.fixes]
    found = delays(walls, probe.lists_s, probe.accepted_s, FOR_THE_FIX_S)
    if not found:
        raise OSError("no list was made for a fix and accepted: expected some at every corner")
    return found, int(np.median(probe.waypoints))


def bare_delays_s(items: int) -> list[float]:
    """Return how long a fix takes through as many processes that compute nothing [s].

    ``items``: waypoints of the list, and datagrams there and back of its upload.
    """
    probe = _probe()
    module = [sys.executable, "-m", "sar_sim.bench.bare_chain_node", "--items", str(items)]
    nodes = [subprocess.Popen([*module, hop]) for hop in HOPS]  # noqa: S603
    try:
        until = time.monotonic() + STARTING_S
        number = 0
        while not probe.bare_s and time.monotonic() < until:
            number += 1
            probe.send(number)
            _spin(probe, BARE_PERIOD_S)
        probe.bare_s.clear()
        for _ in range(BARE_FIXES):
            number += 1
            probe.send(number)
            _spin(probe, BARE_PERIOD_S)
    finally:
        for node in nodes:
            node.terminate()
        for node in nodes:
            node.wait()
        found = list(probe.bare_s)
        probe.destroy_node()
        rclpy.try_shutdown()
    if not found:
        raise OSError("nothing came through the bare chain")
    return found
