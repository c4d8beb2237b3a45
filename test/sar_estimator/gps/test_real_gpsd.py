"""A real gpsd between a receiver at a pseudo-terminal and us: the same fixes."""

import os
import pty
import shutil
import socket
import subprocess
import time
import tty
from pathlib import Path

import pytest

from sar_estimator.gps.receiver import Receiver
from sar_estimator.gps.source import Source
from sar_sim.launch.launch_cli import free_port

GPSD = shutil.which("gpsd") or shutil.which("gpsd", path="/usr/sbin")
pytestmark = [
    pytest.mark.timeout(90),
    pytest.mark.skipif(GPSD is None, reason="gpsd is not installed"),
]
EPOCHS, WANTED = 200, 15


def sentences(make, epoch):
    """Return what a receiver says in a second, and where it is then."""
    latitude, longitude = 37.5 + 1e-4 * epoch, -122.5 - 2e-4 * epoch
    common = {
        "lat": latitude,
        "lon": longitude,
        "time": f"10:{epoch // 60 % 60:02d}:{epoch % 60:02d}",
    }
    gsa = make["sentence"](
        "GSA", opMode="A", navMode=3, svid_01=1, svid_02=2, svid_03=3, svid_04=4,
        PDOP=1.8, HDOP=0.9, VDOP=1.5,
    )  # fmt: skip
    data = make["rmc"](spd=20.0, cog=300.0, **common) + make["gga"](**common) + gsa
    return data, (latitude, longitude)


def test_its_fixes_are_the_receivers(make):
    controller, device = pty.openpty()
    tty.setraw(device)
    name = os.ttyname(device)
    Path(name).chmod(0o666)  # it gives up root's rights
    port = free_port(socket.SOCK_STREAM)
    gpsd = subprocess.Popen(
        [GPSD, "-N", "-n", "-S", str(port), name],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    source, receiver = Source(f"gpsd:127.0.0.1:{port}"), Receiver()
    sent, found = {}, []
    try:
        ends = time.monotonic() + 60.0
        for epoch in range(EPOCHS):
            data, place = sentences(make, epoch)
            sent[epoch] = place
            os.write(controller, data)
            begun = time.monotonic()
            while time.monotonic() - begun < 0.2:
                found += receiver.feed(source.read(0.05), time.monotonic())
            if len([one for one in found if one.is_valid]) >= WANTED or time.monotonic() > ends:
                break
    finally:
        gpsd.kill()
        gpsd.wait()
        source.close()
        os.close(controller)
        os.close(device)
    valid = [one for one in found if one.is_valid]
    assert len(valid) >= WANTED
    for one in valid:
        nearest = min(abs(one.latitude_deg - latitude) for latitude, _ in sent.values())
        assert nearest < 1e-6
        assert one.longitude_deg == pytest.approx(
            -122.5 - 2.0 * (one.latitude_deg - 37.5), abs=2e-6
        )
    moving = [one for one in valid if one.velocity_mps is not None]
    assert moving
    speed = 20.0 * 1852.0 / 3600.0
    assert (moving[-1].velocity_mps[0] ** 2 + moving[-1].velocity_mps[1] ** 2) ** 0.5 == (
        pytest.approx(speed, abs=0.05)
    )
