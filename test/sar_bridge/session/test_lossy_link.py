"""A session over a radio that loses, doubles and reorders messages, both ways."""

import heapq

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_bridge.mavlink.mission_upload import UploadState
from sar_bridge.session.session import AutopilotSession
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.server import AutopilotServer

DATUM = Datum(37.8, -122.8)
STEP_S = 0.05
DOUBLED = 0.05
LATEST_S = 0.3
LIST = np.column_stack((np.linspace(400.0, 6000.0, 60), np.full(60, -250.0)))


class Radio:
    """One direction: bytes in, and out of it what is not lost, some twice, in another order."""

    def __init__(self, loss, seed):
        self.loss = loss
        self.rng = np.random.default_rng(seed)
        self.under_way = []
        self.count = 0

    def put(self, data, now):
        copies = 1 + (self.rng.random() < DOUBLED)
        for _ in range(copies):
            if self.rng.random() >= self.loss:
                self.count += 1
                late = now + self.rng.uniform(0.0, LATEST_S)
                heapq.heappush(self.under_way, (late, self.count, data))

    def get(self, now):
        while self.under_way and self.under_way[0][0] <= now:
            yield heapq.heappop(self.under_way)[2]


class LossyBench:
    def __init__(self, loss, seed):
        self.autopilot = SimAutopilot(Pose(0.0, -250.0, 0.0), speed_mps=20.0, datum=DATUM)
        self.server = AutopilotServer(self.autopilot, DATUM)
        self.session = AutopilotSession(altitude_m=150.0)
        self.up, self.down = Radio(0.0, [seed, 1]), Radio(0.0, [seed, 2])
        self.loss = loss
        self.ground = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
        self.vehicle = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        self.now = 0.0
        self.run(2.0)
        self.up.loss = self.down.loss = loss

    def run(self, seconds, until=lambda: False):
        for _ in range(round(seconds / STEP_S)):
            if until():
                return
            self.now += STEP_S
            self.autopilot.step(STEP_S)
            for message in self.server.telemetry(self.now) + self.server.tick(self.now):
                self.down.put(message.pack(self.vehicle), self.now)
            for data in self.up.get(self.now):
                for message in self.vehicle.parse_buffer(data) or []:
                    for answer in self.server.handle(message, self.now):
                        self.down.put(answer.pack(self.vehicle), self.now)
            out = []
            for data in self.down.get(self.now):
                for message in self.ground.parse_buffer(data) or []:
                    out += self.session.handle(
                        message, now_s=self.now, ros_s=self.now, datum=DATUM
                    )[0]
            for message in out + self.session.tick(self.now):
                self.up.put(message.pack(self.ground), self.now)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("loss", [0.05, 0.2, 0.4])
def test_lists_arrive_whole_whatever_is_lost(loss, seed):
    bench = LossyBench(loss, seed)
    bench.session.set_list(LIST, 1.0, DATUM, bench.now)
    bench.run(400.0, until=lambda: bench.session.accepted is not None)
    assert bench.session.accepted.list_id == 1
    expected = waypoint_items(LIST, DATUM, 150.0)
    assert bench.autopilot.items[1 : len(expected)] == expected[1:]
    bench.run(20.0, until=lambda: bench.autopilot.mode is FlightMode.AUTO)
    assert bench.autopilot.mode is FlightMode.AUTO


@pytest.mark.parametrize("loss", [0.05, 0.2, 0.4])
def test_a_newer_list_supersedes_one_under_way(loss):
    bench = LossyBench(loss, 7)
    bench.session.set_list(LIST, 1.0, DATUM, bench.now)
    bench.run(1.0)
    newer = LIST + np.array((0.0, -40.0))
    bench.session.set_list(newer, 2.0, DATUM, bench.now)
    done = lambda: bench.session.accepted and bench.session.accepted.list_id == 2  # noqa: E731
    bench.run(600.0, until=done)
    assert done()
    points = [waypoint_items(which, DATUM, 150.0)[5:55] for which in (LIST, newer)]
    held = [(i.latitude_e7, i.longitude_e7) for i in bench.autopilot.items]
    wanted = [(i.latitude_e7, i.longitude_e7) for i in points[1]]
    begin = held.index(wanted[0])
    assert held[begin : begin + len(wanted)] == wanted  # whole, nothing of the old one in it


def test_a_link_that_is_dead_is_given_up_and_told_and_tried_again():
    bench = LossyBench(1.0, 1)
    bench.session.set_list(LIST, 1.0, DATUM, bench.now)
    failed = lambda: bench.session.transfer.upload.state is UploadState.FAILED  # noqa: E731
    bench.run(60.0, until=failed)
    assert failed()
    assert bench.autopilot.items == []
    assert bench.autopilot.mode is FlightMode.GUIDED
    assert "heartbeat lost" in bench.session.problem(bench.now)
    bench.up.loss = bench.down.loss = 0.0
    bench.run(120.0, until=lambda: bench.session.accepted is not None)
    assert bench.session.accepted.list_id == 1
