"""``upload_benchmark``: how long a list takes over a slow radio, telemetry and all.

Both ends are the ones that fly: the bridge's session and the simulated autopilot. The radio is
simulated on a clock of its own: so many bytes a second each way, and a latency.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import deque

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.session.list_transfer import Messages
from sar_bridge.session.session import AutopilotSession
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import list_id_at
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav

DATUM = Datum(37.8, -122.8)
STEP_S = 0.005
BITS_A_BYTE = 10
CONNECT_S, LONGEST_S = 12.0, 60.0


class OneWay:
    """One direction of the radio: messages queue up, and come a latency later."""

    def __init__(self, sender: tuple[int, int], baud: float, latency_s: float) -> None:
        """Send as MAVLink system and component ``sender``."""
        system, component = sender
        self._mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
        self._parser = mavlink.MAVLink(None)
        self._bytes_s, self._latency_s = baud / BITS_A_BYTE, latency_s
        self._free_s = 0.0
        self._flying: deque[tuple[float, bytes]] = deque()

    def send(self, messages: Messages, now_s: float) -> None:
        """Put messages on the air, one after the other."""
        for message in messages:
            data = message.pack(self._mav)
            self._free_s = max(now_s, self._free_s) + len(data) / self._bytes_s
            self._flying.append((self._free_s + self._latency_s, data))

    def receive(self, now_s: float) -> Messages:
        """Return what has come by now."""
        found: Messages = []
        while self._flying and self._flying[0][0] <= now_s:
            found += self._parser.parse_buffer(self._flying.popleft()[1]) or []
        return found


class Bench:
    """The session and the autopilot at both ends of a radio."""

    def __init__(self, baud: float, latency_s: float, handling_s: float) -> None:
        """Join them; the autopilot takes a message ``handling_s`` after another at the soonest."""
        uav = Uav(autopilot="arduplane", **AUTOPILOTS["arduplane"])  # type: ignore[arg-type]
        self.pilot = SimAutopilot(
            Pose(0.0, 0.0, 0.0),
            speed_mps=20.0,
            uav=uav,
            datum=DATUM,
        )
        self._server = AutopilotServer(self.pilot, DATUM)
        self.session = AutopilotSession(altitude_m=150.0)
        self._up = OneWay((255, 190), baud, latency_s)
        self._down = OneWay((1, 1), baud, latency_s)
        self._handling_s = handling_s
        self._waiting: deque[mavlink.MAVLink_message] = deque()
        self._busy_s = 0.0
        self.now_s = 0.0

    def step(self) -> None:
        """Advance both ends by ``STEP_S``."""
        self.now_s += STEP_S
        now = self.now_s
        self.pilot.step(STEP_S)
        self._down.send(self._server.telemetry(now), now)
        self._waiting.extend(self._up.receive(now))
        if self._waiting and now >= self._busy_s:
            self._busy_s = now + self._handling_s
            self._down.send(self._server.handle(self._waiting.popleft(), now), now)
        for message in self._down.receive(now):
            out, _ = self.session.handle(message, now_s=now, ros_s=now, datum=DATUM)
            self._up.send(out, now)
        self._up.send(self.session.tick(now), now)

    def upload_s(self, points: np.ndarray) -> float:
        """Return how long a list, shape (n, 2), takes until it is flown; infinite if it fails."""
        begun, before = self.now_s, self.session.accepted
        self._up.send(self.session.set_list(points, list_id_at(begun), DATUM, begun), begun)
        while self.session.accepted is before and self.now_s - begun < LONGEST_S:
            self.step()
        return math.inf if self.session.accepted is before else self.now_s - begun


def measure(items: int, baud: float, latency_s: float, handling_s: float) -> tuple[float, float]:
    """Return how long the first list takes, and one that replaces it in flight [s]."""
    bench = Bench(baud, latency_s, handling_s)
    while bench.now_s < CONNECT_S:
        bench.step()
    points = np.column_stack(
        (bench.pilot.motion.x_m + 200.0 + 60.0 * np.arange(items), np.zeros(items))
    )
    first = bench.upload_s(points)
    for _ in range(round(2.0 / STEP_S)):
        bench.step()
    return first, bench.upload_s(points + np.array((10.0, 3.0)))


def main(argv: list[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="upload_benchmark", description=__doc__)
    parser.add_argument("--items", type=int, default=60, help="waypoints of a list, up to 63")
    parser.add_argument("--baud", type=float, default=57600.0)
    parser.add_argument("--latency", type=float, default=0.01, help="each way, s")
    parser.add_argument("--handling", type=float, default=0.02, help="of a message, s")
    args = parser.parse_args(argv)
    if not 2 <= args.items <= 63 or not args.baud > 0.0:
        sys.stderr.write("upload_benchmark: expected --items 2 to 63, --baud above 0\n")
        return 2
    first, update = measure(args.items, args.baud, args.latency, args.handling)
    sys.stdout.write(
        f"{args.items} waypoints, {args.baud:g} baud, {1e3 * args.latency:g} ms each way, "
        f"{1e3 * args.handling:g} ms a message:\n"
        f"first list (with room for three) {first:.2f} s, update in flight {update:.2f} s\n"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
