"""What a receiver sends, at a pseudo-terminal: read there, or by a real gpsd that has it."""

from __future__ import annotations

import contextlib
import os
import pty
import subprocess
import threading
import time
import tty
from collections.abc import Iterator
from pathlib import Path

from sar_estimator.gps.reading import Reading
from sar_estimator.gps.receiver import Receiver
from sar_estimator.gps.source import Source
from sar_sim.trials.receiver_logs import Comparison, answers, compare, log_bytes

BAUD = 38_400
CHUNK = 64
PAUSE_S = 0.004
QUIET_S = 2.0
LONGEST_S = 120.0


@contextlib.contextmanager
def terminal() -> Iterator[tuple[int, str]]:
    """Open a pseudo-terminal: what the receiver writes to, and the device that is read."""
    controller, device = pty.openpty()
    tty.setraw(device)
    name = os.ttyname(device)
    Path(name).chmod(0o666)  # gpsd gives up root's rights
    try:
        yield controller, name
    finally:
        os.close(controller)
        os.close(device)


def read_through(source: Source, controller: int, data: bytes) -> tuple[list[Reading], str]:
    """Send a log, and return what is read meanwhile, and what the receiver is said to be."""
    receiver, found = Receiver(), list[Reading]()
    sent = threading.Event()

    def send() -> None:
        for i in range(0, len(data), CHUNK):
            os.write(controller, data[i : i + CHUNK])
            time.sleep(PAUSE_S)
        sent.set()

    source.read(0.1)
    threading.Thread(target=send, daemon=True).start()
    begun = heard = time.monotonic()
    problem = receiver.problem(begun)
    while time.monotonic() - begun < LONGEST_S:
        read = source.read(0.1)
        now = time.monotonic()
        heard = now if read else heard
        found += receiver.feed(read, now)
        if receiver.heard:
            problem = receiver.problem(now) if now - heard < 0.5 else problem
        if sent.is_set() and now - heard > QUIET_S:
            break
    return found, problem


def by_port(log: Path) -> Comparison:
    """Read a log at a pseudo-terminal."""
    with terminal() as (controller, device):
        source = Source(f"{device},{BAUD}")
        try:
            found, problem = read_through(source, controller, log_bytes(log))
        finally:
            source.close()
    return compare(log.stem, found, answers(log), problem)


def by_gpsd(log: Path, gpsd: str, port: int) -> Comparison:
    """Read a log through a real gpsd that has the pseudo-terminal."""
    with terminal() as (controller, device):
        command = [gpsd, "-N", "-n", "-b", "-S", str(port), device]
        with subprocess.Popen(  # noqa: S603
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as process:
            source = Source(f"gpsd:127.0.0.1:{port}")
            try:
                ends = time.monotonic() + 10.0
                while source.failure and time.monotonic() < ends:
                    source.read(0.2)
                found, problem = read_through(source, controller, log_bytes(log))
            finally:
                source.close()
                process.kill()
    return compare(log.stem, found, answers(log), problem)
