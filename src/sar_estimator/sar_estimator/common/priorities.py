"""Which nodes come first where the processor is wanted by more than it can serve (Linux).

What leads the UAV is raised by nice values, where that is permitted; what records and shows is
lowered, which always is. No real-time scheduling: how much of a core a node takes is not bounded,
and one that never waits must not starve the machine. At ``RAISED`` it takes some 9 of 10 parts of
a core beside a program of no niceness, never all of it.
"""

from __future__ import annotations

import contextlib
import os
import resource
import time
from collections.abc import Mapping
from pathlib import Path

RAISED, LOWERED = -10, 10
RAISED_NODES = frozenset({"gps", "estimator", "planner", "monitor", "bridge", "radio_hub", "sim"})
"""What leads the UAV, and the simulation: the world goes on however busy a laptop is."""
LOWERED_NODES = frozenset({"record", "console"})
OFF = ("SAR_PRIORITIES", "0")
"""The environment's variable, and its value, with which priorities are left alone."""
THREADS = Path("/proc/self/task")
AUTOGROUP = Path("/proc/self/autogroup")
TRIES, AGAIN_S = 8, 0.12
"""The kernel takes one change of an unprivileged user's autogroups in a tenth of a second."""


def set_priority(node: str, environment: Mapping[str, str]) -> str:
    """Raise or lower this process for a node; return what is to be told of it, empty for nothing.

    On Linux each thread has a nice value of its own, which it has from the one that begins it, as
    child processes have theirs: all that run by now get it, and so do those that come.
    """
    name, off = OFF
    if environment.get(name) == off:
        return ""
    if node in LOWERED_NODES:
        _take(max(os.getpriority(os.PRIO_PROCESS, 0), LOWERED))
        return ""
    if node not in RAISED_NODES:
        return ""
    before = os.getpriority(os.PRIO_PROCESS, 0)
    for nice in (RAISED, max(least_permitted(), RAISED)):
        if nice < before and _take(nice):
            return f"priority: nice {nice}"
    if before <= RAISED:
        return f"priority: nice {before}"
    return f"priority: nice {before}, more is not permitted: see docs/laptop.md"


def least_permitted() -> int:
    """Return the lowest nice value that this process' limit permits (RLIMIT_NICE)."""
    soft, _ = resource.getrlimit(resource.RLIMIT_NICE)
    return -20 if soft == resource.RLIM_INFINITY else 20 - soft


def _take(nice: int) -> bool:
    """Give all threads of this process a nice value; return whether that is permitted."""
    try:
        os.setpriority(os.PRIO_PROCESS, 0, nice)
    except OSError:
        return False
    for thread in THREADS.iterdir():
        with contextlib.suppress(OSError):  # one that has ended since
            os.setpriority(os.PRIO_PROCESS, int(thread.name), nice)
    if os.getsid(0) == os.getpid():
        _take_group(nice)
    return True


def _take_group(nice: int) -> None:
    """Give the session of this process the value, where the kernel weighs sessions first.

    Every node is a session of its own: among those nice values count for nothing by themselves
    (sched(7), autogroups).
    """
    for _ in range(TRIES):
        try:
            AUTOGROUP.write_text(str(nice), encoding="utf-8")
        except BlockingIOError:
            time.sleep(AGAIN_S)
        except OSError:
            return
        else:
            return
