"""Mutated MAVLink input: nothing crashes, and nothing is sent that is not sent otherwise.

``SAR_FUZZ_INPUTS`` inputs of each kind, seeded.
"""

import os

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.signing import VerifyingParser
from sar_bridge.session.session import AutopilotSession
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.autopilot.server import AutopilotServer

INPUTS = int(os.environ.get("SAR_FUZZ_INPUTS", "4000"))
DATUM = Datum(37.8, -122.8)
LINE = np.array([[300.0, -250.0], [3000.0, -250.0]])
ALLOWED = {
    mavlink.MAV_CMD_DO_SET_MODE,
    mavlink.MAV_CMD_DO_SET_MISSION_CURRENT,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL,
    mavlink.MAV_CMD_DO_CHANGE_SPEED,
}
MODES = {10.0}  # AUTO; RTL only when an operator asks for it


def conversation():
    """Return what an autopilot says over a mission upload and some flying."""
    autopilot = SimAutopilot(Pose(0.0, -250.0, 0.0), speed_mps=20.0, datum=DATUM)
    server, session = AutopilotServer(autopilot, DATUM), AutopilotSession(altitude_m=150.0)
    said, out = [], []
    for i in range(200):
        now = 0.05 * i
        autopilot.step(0.05)
        answers = server.telemetry(now)
        for message in out:
            answers += server.handle(message, now)
        out = session.tick(now)
        for message in answers:
            said.append(message)
            out += session.handle(message, now_s=now, ros_s=now, datum=DATUM)[0]
        if i == 40:
            out += session.set_list(LINE, 1.0, DATUM, now)
    return said


SAID = conversation()


def packed(messages):
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    return [message.pack(mav) for message in messages]


class Target:
    """A session that flies a list, and what it sends."""

    def __init__(self):
        self.parser = VerifyingParser(None)
        self.parser.robust_parsing = True
        self.session = AutopilotSession(altitude_m=150.0)
        self.now = 0.0
        for data in packed(SAID[:60]):
            self.take(data)
        self.check(self.session.set_list(LINE, 1.0, DATUM, self.now))

    def take(self, data):
        self.now += 0.01
        for message in self.parser.parse_buffer(data) or []:
            if message.get_type() != "BAD_DATA":
                out, _ = self.session.handle(message, now_s=self.now, ros_s=self.now, datum=DATUM)
                self.check(out)
        self.check(self.session.tick(self.now))
        assert isinstance(self.session.problem(self.now), str)

    def check(self, sent):
        for message in sent:
            if message.get_type() == "COMMAND_LONG":
                assert message.command in ALLOWED
                if message.command == mavlink.MAV_CMD_DO_SET_MODE:
                    assert message.param2 in MODES
            message.pack(mavlink.MAVLink(None, srcSystem=255, srcComponent=190))


def test_bytes_turned_lost_and_inserted(mangle):
    rng, target, packets = np.random.default_rng(1), Target(), packed(SAID)
    for _ in range(INPUTS):
        target.take(mangle(rng, packets[rng.integers(len(packets))]))


EXTREMES = (0, 1, -1, 2**31 - 1, -(2**31), 2**16 - 1, 255, float("nan"), float("inf"), 1e30, "x")


@pytest.mark.parametrize("seed", [1, 2])
def test_fields_with_values_nobody_expects(seed):
    """Packets that are whole and sound, but for what they say."""
    rng, target = np.random.default_rng(seed), Target()
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    packets = 0
    for _ in range(INPUTS):
        source = SAID[rng.integers(len(SAID))]
        values = [getattr(source, name) for name in source.ordered_fieldnames]
        values = dict(zip(source.ordered_fieldnames, values, strict=True))
        name = source.ordered_fieldnames[rng.integers(len(values))]
        values[name] = EXTREMES[rng.integers(len(EXTREMES))]
        try:
            data = type(source)(*(values[field] for field in source.fieldnames)).pack(mav)
        except (TypeError, ValueError, OverflowError, mavlink.struct.error, AttributeError):
            continue  # a value that the field cannot carry
        packets += 1
        target.take(data)
    assert packets > 0.2 * INPUTS
