"""Asking an autopilot for its home, over a real socket."""

import threading
import time

import pytest

from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.autopilot.home_link import home_of
from sar_sim.autopilot.link import AutopilotLink
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.launch.launch_cli import free_port

DATUM = Datum(47.1, 8.2, 400.0)


def test_home_is_told():
    port = free_port()
    pilot = SimAutopilot(
        Pose(100.0, 200.0, 0.0),
        speed_mps=20.0,
        datum=DATUM,
    )
    link = AutopilotLink(AutopilotServer(pilot, DATUM), port, time.monotonic)
    running = True

    def serve():
        begun = time.monotonic()
        while running:
            link.listen(0.02)
            link.report(time.monotonic() - begun)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        home = home_of(f"udp:127.0.0.1:{port}", patience_s=20.0)
    finally:
        running = False
        thread.join()
        link.close()
    x, y, _ = DATUM.to_local(home.latitude_deg, home.longitude_deg)
    assert (x, y) == pytest.approx((100.0, 200.0), abs=0.1)


def test_silence_is_one_line():
    port = free_port()
    with pytest.raises(ValueError, match=f"udp:127.0.0.1:{port}: expected an autopilot"):
        home_of(f"udp:127.0.0.1:{port}", patience_s=0.3)
