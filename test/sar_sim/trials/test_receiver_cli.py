"""A scenario's helicopter at a pseudo-terminal is read as any receiver."""

import subprocess
import sys
import time

import pytest

from sar_estimator.gps.receiver import Receiver
from sar_estimator.gps.source import Source
from sar_sim.trials.receiver_cli import main

pytestmark = pytest.mark.timeout(60)


@pytest.mark.parametrize("protocol", ["ubx", "nmea"])
def test_it_speaks_at_a_link_of_its_own(protocol, tmp_path):
    link = tmp_path / "gps"
    command = [sys.executable, "-m", "sar_sim.trials.receiver_cli", "--scenario", "short"]
    with subprocess.Popen(
        [*command, "--protocol", protocol, "--link", str(link)], stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout.readline() == f"{link}\n"
            source, receiver, found = Source(f"{link},115200"), Receiver(), []
            ends = time.monotonic() + 30.0
            while len(found) < 3 and time.monotonic() < ends:
                found += receiver.feed(source.read(0.1), time.monotonic())
            source.close()
        finally:
            process.kill()
    assert len(found) >= 3
    for reading in found:
        assert reading.is_valid
        assert reading.velocity_mps == pytest.approx((0.0, 20.0), abs=1.0)
        assert abs(reading.utc_s - time.time()) < 60.0


def test_an_unknown_scenario_is_one_line(capsys):
    assert main(["--scenario", "nowhere"]) == 2
    assert capsys.readouterr().err.startswith("receiver: ")
