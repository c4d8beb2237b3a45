"""Child processes that end with their parent, one log file each."""

from __future__ import annotations

import ctypes
import importlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

PR_SET_PDEATHSIG = 1
LAST_LINES = 15
PATIENCE_S = 600.0
SELDOM_COMPUTES = ("bridge", "sim")


def _die_with_parent() -> None:
    """Have the kernel end this process when its parent dies, however that happens (Linux)."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def end_with(parent: int) -> None:
    """Have this process end when its parent does; at once where that has ended already.

    What a pool's processes begin with: they would otherwise wait for work for ever.
    """
    _die_with_parent()
    if os.getppid() != parent:
        os._exit(1)


def spawning_pool(jobs: int | None) -> ProcessPoolExecutor:
    """Return a pool of new interpreters that end with this process.

    A fork would copy locks that this process' threads hold, and its open pipes.
    """
    return ProcessPoolExecutor(
        jobs, mp_context=get_context("spawn"), initializer=end_with, initargs=(os.getpid(),)
    )


def run_apart(target: str, *given: Any) -> Any:
    """Run ``module:function`` in a process of its own; return what it returns.

    What it imports does not stay in this one's memory. Raises what it raises, and
    ``BrokenProcessPool`` (a ``RuntimeError``) where its process dies.
    """
    with spawning_pool(1) as pool:
        return pool.submit(_run, target, given).result()


def _run(target: str, given: tuple[Any, ...]) -> Any:
    module, name = target.split(":")
    return getattr(importlib.import_module(module), name)(*given)


class NodeProcess:
    """One running node."""

    def __init__(self, name: str, command: Sequence[str], log: Path) -> None:
        """Start it, away from the terminal's signals: the launcher passes them on in order."""
        self.name, self.log = name, log
        self._begun_s = time.monotonic()
        environment = dict(os.environ, PYTHONUNBUFFERED="1", OPENBLAS_NUM_THREADS="1")
        if name in SELDOM_COMPUTES:
            environment.setdefault("SAR_COMPILE", "0")
        with log.open("ab") as stream:
            self._process = subprocess.Popen(  # noqa: S603
                list(command),
                stdin=subprocess.DEVNULL,
                stdout=stream,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env=environment,
                preexec_fn=_die_with_parent,  # noqa: PLW1509
            )

    @property
    def exit_code(self) -> int | None:
        """The exit code, None while it runs."""
        return self._process.poll()

    @property
    def age_s(self) -> float:
        """How long ago it was started [s]."""
        return time.monotonic() - self._begun_s

    def last_lines(self) -> str:
        """Return the end of its log."""
        text = self.log.read_text(encoding="utf-8", errors="replace")
        return "\n".join(text.splitlines()[-LAST_LINES:])

    def signal(self, number: signal.Signals) -> None:
        """Send it a signal, if it still runs."""
        if self._process.poll() is None:
            self._process.send_signal(number)

    def kill(self) -> None:
        """End it at once."""
        self._process.kill()
        self._process.wait()

    def stop(self, patience_s: float = 10.0) -> bool:
        """Ask it to end, then make it; return whether it ended by itself."""
        if self._process.poll() is not None:
            return True
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(timeout=patience_s)
        except subprocess.TimeoutExpired:
            self.kill()
            return False
        return True


def launch_command(out: Path, *options: str) -> list[str]:
    """Return what flies the whole graph into a folder, as ``launch.sh`` does.

    Without the operator's page, unless ``--console-port`` is among the options.
    """
    page = () if "--console-port" in options else ("--no-console",)
    return [sys.executable, "-m", "sar_sim.launch.launch_cli", "--out", str(out), *page, *options]


def start_flight(out: Path, *options: str) -> subprocess.Popen[str]:
    """Start ``launch_command``; what goes wrong is told by ``end_flight``."""
    return subprocess.Popen(  # noqa: S603
        launch_command(out, *options), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )


def end_flight(flight: subprocess.Popen[str]) -> None:
    """End a flight, where it has not ended by itself. Raises ``OSError`` where it failed."""
    flight.terminate()
    _, errors = flight.communicate(timeout=PATIENCE_S)
    if flight.returncode != 0:
        raise OSError(f"the flight failed: {errors}")


def folder_bytes(folder: Path) -> int:
    """Return the size of the files in a folder, 0 when it is not there."""
    if not folder.is_dir():
        return 0
    return sum(item.stat().st_size for item in folder.iterdir() if item.is_file())
