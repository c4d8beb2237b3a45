"""Ground stations that send anything: nothing crashes, and what must not pass never does.

``SAR_FUZZ_INPUTS`` inputs of each kind, seeded.
"""

import os
import re

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.signing import VerifyingParser
from sar_bridge.session.component import LINK, BridgeComponent
from sar_bridge.session.ground_stations import NEVER, STICKS
from sar_estimator.common import topics
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import WaypointList
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.autopilot.server import AutopilotServer

INPUTS = int(os.environ.get("SAR_FUZZ_INPUTS", "4000"))
DATUM = Datum(37.8, -122.8)
LINE = np.array([[300.0, -250.0], [3000.0, -250.0]])
STATIONS = (Address(255, 190), Address(254, 190))
REALS = (0.0, 1.0, -1.0, 1e30, float("nan"), float("inf"), 37.8, 150.0)
MISSION_WRITES = ("MISSION_COUNT", "MISSION_CLEAR_ALL", "MISSION_WRITE_PARTIAL_LIST")
OURS = (mavlink.MAV_MISSION_TYPE_MISSION, mavlink.MAV_MISSION_TYPE_ALL)
KINDS = sorted(
    (kind for kind in mavlink.mavlink_map.values() if kind.msgname != "BAD_DATA"),
    key=lambda kind: kind.id,
)
USUAL = [
    kind
    for kind in KINDS
    if kind.msgname.startswith(("MISSION_", "PARAM_", "COMMAND_", "SET_", "RC_", "MANUAL_"))
    or kind.msgname
    in ("HEARTBEAT", "SETUP_SIGNING", "REQUEST_DATA_STREAM", "FILE_TRANSFER_PROTOCOL")
]


def value_of(rng, of_type):
    """Return a value that a field of a type can carry, an extreme one half of the time."""
    if of_type == "char":
        return b"x"
    if of_type in ("float", "double"):
        return REALS[rng.integers(len(REALS))]
    bits = int(re.search(r"\d+", of_type).group())
    low, high = (0, 2**bits) if of_type.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1))
    return (low, high - 1, 0, 1, int(rng.integers(max(low, -100), min(high, 256))))[rng.integers(5)]


def anything(rng, mav):
    """Return a packet of any message there is; one in two of those that stations do send."""
    kinds = USUAL if rng.random() < 0.5 else KINDS
    kind = kinds[rng.integers(len(kinds))]
    values = []
    for name, of_type, length in zip(kind.fieldnames, kind.fieldtypes, _lengths(kind), strict=True):
        if name == "target_system":
            values.append(int(rng.integers(3)))
        elif of_type == "char":
            values.append(rng.bytes(max(length, 1)).replace(b"\0", b"x"))
        elif length:
            values.append([value_of(rng, of_type) for _ in range(length)])
        else:
            values.append(value_of(rng, of_type))
    return kind(*values).pack(mav)


def _lengths(kind):
    by_name = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    return [by_name[name] for name in kind.fieldnames]


class Bench:
    """A bridge with an autopilot and two stations; what goes to the autopilot is looked at."""

    def __init__(self):
        self.pilot = SimAutopilot(Pose(0.0, -250.0, 0.0), speed_mps=20.0, datum=DATUM)
        self.server = AutopilotServer(self.pilot, DATUM)
        self.bridge = BridgeComponent(altitude_m=150.0, stations=len(STATIONS))
        self.parsers = [VerifyingParser(None) for _ in STATIONS]
        for parser in self.parsers:
            parser.robust_parsing = True
        self.now = 10.0
        self.passed = 0
        for _ in range(40):
            self.step()
        self.look(self.bridge.handle(topics.DATUM, DATUM, self.now))
        flown = WaypointList(int(1e9), 1e6, LINE)
        self.look(self.bridge.handle(topics.CLEARED, flown, self.now))
        for _ in range(60):
            self.step()

    def step(self):
        self.now += 0.05
        self.bridge.ros_s = 1e6 + self.now
        self.pilot.step(0.05)
        for message in self.server.telemetry(self.now) + self.server.tick(self.now):
            self.hear(message)
        self.look(self.bridge.tick(self.now))

    def hear(self, message):
        message._header.srcSystem = message._header.srcComponent = 1
        self.look(self.bridge.receive(message, self.now))

    def station(self, number, data):
        for message in self.parsers[number].parse_buffer(data) or []:
            self.look(self.bridge.receive_station(number, message, self.now))

    def look(self, outputs):
        """Check what goes to the autopilot; a station's own packets are bytes."""
        session = self.bridge.session
        for topic, value in outputs:
            if topic != LINK:
                continue
            for one in value:
                if not isinstance(one, bytes):
                    continue
                self.passed += 1
                (message,) = mavlink.MAVLink(None).parse_buffer(one)
                kind = message.get_type()
                assert kind not in NEVER
                if session.leading and session.heartbeats.silent:
                    assert kind not in STICKS
                if session.leading and kind in MISSION_WRITES:
                    assert message.mission_type not in OURS


def test_any_message_there_is_from_two_stations():
    rng, bench = np.random.default_rng(31), Bench()
    mavs = [mavlink.MAVLink(None, srcSystem=s.system, srcComponent=s.component) for s in STATIONS]
    passed = leading = 0
    for i in range(INPUTS):
        number = int(rng.integers(len(STATIONS)))
        bench.station(number, anything(rng, mavs[number]))
        if i % 50 == 0:
            bench.step()
        leading += bench.bridge.session.leading
        if i % 200 == 199 and not bench.bridge.session.leading:  # it was taken: begin anew
            passed, bench = passed + bench.passed, Bench()
    assert passed + bench.passed > 0.05 * INPUTS
    assert leading > 0.1 * INPUTS


def test_packets_with_bytes_turned_lost_and_inserted(mangle):
    rng, bench = np.random.default_rng(32), Bench()
    mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    packets = [anything(rng, mav) for _ in range(300)]
    for i in range(INPUTS):
        bench.station(0, mangle(rng, packets[rng.integers(len(packets))]))
        if i % 50 == 0:
            bench.step()
