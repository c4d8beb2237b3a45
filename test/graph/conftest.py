"""Whole-graph tests: the real launcher, real processes, real DDS, real MAVLink sockets."""

import os
import re
import signal
import socket
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE_WAIT_MS = 60_000


class Launch:
    """One run of the installed launcher, in its own ROS domain."""

    def __init__(self, out, environment, *options, before=()):
        self.out = out
        self.environment = dict(environment, PYTHONUNBUFFERED="1")
        program = ROOT / "install" / "sar_sim" / "lib" / "sar_sim" / "launch"
        page = () if "--console-port" in options else ("--no-console",)
        self.process = subprocess.Popen(
            [*before, str(program), "--out", str(out), *page, *options],
            cwd=ROOT,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def wait(self, timeout_s=100.0):
        """Wait for the end; return (exit code, output, errors)."""
        try:
            output, errors = self.process.communicate(timeout=timeout_s)
        except subprocess.TimeoutExpired:
            self.kill()
            raise
        return self.process.returncode, output, errors

    def nodes(self):
        """Return the process numbers of the nodes of this flight that are running, by name."""
        found = {}
        for entry in Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            try:
                words = (entry / "cmdline").read_bytes().decode().split("\0")
            except OSError:
                continue
            if str(self.out / "params.yaml") in words:
                uav = [word.partition("__ns:=/")[2] for word in words if "__ns:=/" in word]
                found["/".join([*uav, Path(words[1]).name])] = int(entry.name)
        return found

    def operator(self, *words):
        """Ask as an operator does; return what came of it."""
        program = ROOT / "install" / "sar_bridge" / "lib" / "sar_bridge" / "operator"
        return subprocess.run(
            [str(program), *words],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    def open_page(self, page):
        """Open the operator's page as soon as it is there."""
        file = self.out / "console.txt"
        ends = time.monotonic() + 60.0
        while True:
            assert time.monotonic() < ends, "no page"
            time.sleep(0.2)
            if not file.exists() or not file.read_text("utf-8").endswith("\n"):
                continue
            address = file.read_text("utf-8").strip()
            port = int(re.search(r":(\d+)/", address).group(1))
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    break
        assert oct(file.stat().st_mode)[-3:] == "600"
        page.goto(address)

    def kill(self):
        """End the launcher and whatever it left, for good."""
        for number in (self.process.pid, *self.nodes().values()):
            try:
                os.kill(number, signal.SIGKILL)
            except ProcessLookupError:
                continue
        self.process.communicate()


@pytest.fixture
def page(browser):
    shown = browser.new_page(viewport={"width": 1280, "height": 800})
    shown.set_default_timeout(PAGE_WAIT_MS)
    yield shown
    shown.close()


@pytest.fixture
def launch(tmp_path, new_environment):
    running = []

    def start(*options, name="run", before=()):
        one = Launch(tmp_path / name, new_environment(), *options, before=before)
        running.append(one)
        return running[-1]

    yield start
    for one in running:
        if one.process.poll() is None:
            one.kill()
        assert one.nodes() == {}, "nodes left running"
