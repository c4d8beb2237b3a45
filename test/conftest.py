"""Settings of all tests."""

import fcntl
import os
import shutil
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings

# How long an example takes is measured in benchmarks, never in a test. Every run draws the same
# examples; to search on: --hypothesis-profile explore.
settings.register_profile("explore", deadline=None)
settings.register_profile("seeded", deadline=None, derandomize=True)
settings.load_profile("seeded")

DOMAINS = range(100, 220)
HELD = []

CHROMIUM_OPTIONS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--autoplay-policy=no-user-gesture-required",
]


def free_domain():
    """Return a ROS domain that no other test of this machine has, in whatever process.

    Held by a lock until this process ends: DDS remembers participants for a while.
    """
    for domain in DOMAINS:
        lock = (Path(tempfile.gettempdir()) / f"sar_test_domain_{domain}").open("w")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            continue
        HELD.append(lock)
        return domain
    raise RuntimeError(f"no ROS domain of {DOMAINS} is free")


@pytest.fixture
def new_environment():
    """A function that gives the environment of processes in a ROS domain of their own."""

    def make():
        # NiceGUI serves otherwise where it believes itself under test.
        plain = {key: value for key, value in os.environ.items() if key != "PYTEST_CURRENT_TEST"}
        return dict(
            plain,
            ROS_DOMAIN_ID=str(free_domain()),
            ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST",
            SAR_PRIORITIES="0",  # what is tested is no more urgent than its tests
        )

    return make


@pytest.fixture
def own_domain(new_environment):
    """The environment of processes in a ROS domain of their own."""
    return new_environment()


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium; where there is none, what needs it is skipped."""
    sync_api = pytest.importorskip("playwright.sync_api")
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("Chromium is not installed")
    with sync_api.sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=CHROMIUM_OPTIONS)
        yield running
        running.close()
