"""The graph with an autopilot that is not its own: nothing is flown before an operator engages."""

import subprocess
import threading
import time
from pathlib import Path

import pytest

from sar_bridge.mission_banks import BANK_ITEMS, BANKS
from sar_estimator.geodesy import Datum
from sar_estimator.plane import Pose
from sar_sim.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot_link import AutopilotLink
from sar_sim.autopilot_server import AutopilotServer
from sar_sim.launch_cli import free_port
from sar_sim.scenario import Scenario, Uav, Wind

pytestmark = [pytest.mark.graph, pytest.mark.timeout(150)]
ROOT = Path(__file__).parents[2]


class Vehicle(threading.Thread):
    """An airborne autopilot in real time, in this process, on the bridge's UDP port."""

    def __init__(self, port):
        super().__init__(daemon=True)
        scenario = Scenario()
        self.autopilot = SimAutopilot(
            Pose(250.0, -500.0, 1.5708),
            speed_mps=20.0,
            uav=Uav(),
            wind=Wind(),
            datum=Datum(scenario.datum.latitude_deg, scenario.datum.longitude_deg),
            altitude_m=150.0,
        )
        self.link = AutopilotLink(
            AutopilotServer(self.autopilot, scenario.datum), port, time.monotonic
        )
        self.running = True

    def run(self):
        begun, steps = time.monotonic(), 0
        while self.running:
            self.link.listen(max(0.0, begun + 0.05 * steps - time.monotonic()))
            if time.monotonic() - begun >= 0.05 * steps:
                self.autopilot.step(0.05)
                steps += 1
                self.link.report(0.05 * steps)
        self.link.close()


def operator(flight, action):
    program = str(ROOT / "install/sar_bridge/lib/sar_bridge/operator")
    done = subprocess.run(
        [program, action], env=flight.environment, capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip
    return done.returncode, done.stdout


def await_true(condition, timeout_s=40.0):
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.1)


def test_engage_release_engage_and_return_home(launch):
    port = free_port()
    vehicle = Vehicle(port)
    pilot = vehicle.autopilot
    flight = launch("--autopilot", f"udp:127.0.0.1:{port}")
    vehicle.start()
    try:
        await_true(lambda: vehicle.link.heard)
        time.sleep(12.0)  # the planner may be ready by now, and must not engage by itself
        assert pilot.mode is FlightMode.GUIDED
        assert pilot.items == []

        await_true(lambda: operator(flight, "engage") == (0, "engage: engaged\n"))
        await_true(lambda: pilot.mode is FlightMode.AUTO)
        assert len(pilot.items) == 1 + BANKS * BANK_ITEMS

        pilot.set_mode(FlightMode.LOITER)  # the pilot takes it back
        time.sleep(4.0)
        assert pilot.mode is FlightMode.LOITER
        code, text = operator(flight, "engage")
        assert code == 1
        assert "UAV in mode LOITER: expected AUTO or GUIDED" in text

        pilot.set_mode(FlightMode.GUIDED)
        await_true(lambda: operator(flight, "engage")[0] == 0)
        await_true(lambda: pilot.mode is FlightMode.AUTO)

        assert operator(flight, "return_home")[0] == 0
        await_true(lambda: pilot.mode is FlightMode.RTL)
        time.sleep(3.0)
        assert pilot.mode is FlightMode.RTL
        assert operator(flight, "disengage") == (0, "disengage: disengaged\n")
    finally:
        vehicle.running = False
        vehicle.join(timeout=5.0)
    flight.process.terminate()
    code, _, errors = flight.wait()
    assert (code, errors) == (0, "")
