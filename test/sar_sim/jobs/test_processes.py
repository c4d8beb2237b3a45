"""Pools: no fork of a process with threads, and nobody is left when the parent dies."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sar_sim.jobs.pool import Workers
from sar_sim.jobs.processes import spawning_pool

# A parent that works with a pool for a minute, and says which processes it has.
PARENT = """
import os, sys, time
from sar_sim.jobs.processes import spawning_pool
if __name__ == "__main__":
    with spawning_pool(2) as pool:
        work = [pool.submit(time.sleep, 60.0) for _ in range(2)]
        while len(pool._processes) < 2:
            time.sleep(0.05)
        time.sleep(float(sys.argv[1]))
        print(*pool._processes, flush=True)
        time.sleep(60.0)
"""


def alive(number):
    """Whether a process is there, and not only waited for."""
    try:
        state = Path(f"/proc/{number}/stat").read_text(encoding="utf-8")
    except OSError:
        return False
    return state.rsplit(")", 1)[1].split()[0] not in ("Z", "X")


@pytest.mark.parametrize("busy_s", [0.0, 3.0], ids=["starting", "at work"])
def test_a_pools_processes_end_with_their_parent_however_it_dies(tmp_path, busy_s):
    script = tmp_path / "parent.py"
    script.write_text(PARENT, encoding="utf-8")
    parent = subprocess.Popen(
        [sys.executable, str(script), str(busy_s)], stdout=subprocess.PIPE, text=True
    )
    children = [int(number) for number in parent.stdout.readline().split()]
    assert len(children) == 2
    parent.send_signal(signal.SIGKILL)
    parent.wait(timeout=10.0)
    deadline = time.monotonic() + 20.0
    while any(alive(child) for child in children):
        assert time.monotonic() < deadline, "a child outlives its parent"
        time.sleep(0.1)
    parent.stdout.close()


def test_a_pools_processes_are_new_interpreters():
    with spawning_pool(1) as pool:
        assert pool._mp_context.get_start_method() == "spawn"
        assert pool.submit(os.getppid).result(timeout=30.0) == os.getpid()


def test_work_is_done_in_such_a_pool():
    with Workers(1) as workers:
        assert list(workers.map(abs, [-1, 2])) == [1, 2]
        assert workers._mp_context.get_start_method() == "spawn"
