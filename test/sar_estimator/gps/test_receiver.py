"""What a receiver speaks is found out, and what is wrong with it is told."""

import pytest

from sar_estimator.gps.framing import Protocol
from sar_estimator.gps.receiver import SILENT_S, Receiver

TPV = b'{"class":"TPV","mode":3,"time":"2026-11-28T10:20:30Z","lat":1,"lon":2}\n'


def test_a_receiver_that_says_nothing_is_silent():
    assert Receiver().problem(100.0) == "receiver silent"


@pytest.mark.parametrize("kind", ["pvt", "gga", "gpsd"])
def test_a_receiver_that_has_fixes_is_well(make, kind):
    receiver = Receiver()
    for second in range(30, 40):
        data = {
            "pvt": make["pvt"](second=second),
            "gga": make["gga"](time=f"10:20:{second}"),
            "gpsd": TPV.replace(b"30Z", b"%dZ" % second),
        }[kind]
        receiver.feed(data, float(second))
    assert receiver.problem(39.5) == ""
    assert receiver.problem(39.5 + SILENT_S) == "receiver silent"


def test_without_a_fix_that_is_told(make):
    receiver = Receiver()
    for second in range(30, 40):
        receiver.feed(make["pvt"](second=second, ok=0), float(second))
    assert receiver.problem(39.5) == "receiver has no fix"


def test_a_wrong_baud_rate_is_guessed():
    receiver = Receiver()
    for second in range(10):
        receiver.feed(bytes(range(128, 255)), float(second))
    assert receiver.problem(9.5) == "bytes of no known protocol: is the baud rate right?"


def test_a_protocol_that_is_not_understood_is_named():
    receiver = Receiver()
    frame = bytes.fromhex("a0a20003010203") + bytes.fromhex("0006") + bytes.fromhex("b0b3")
    for second in range(10):
        receiver.feed(frame, float(second))
    assert receiver.heard == {Protocol.SIRF: 10}
    assert receiver.problem(9.5) == ("receiver speaks SiRF binary: expected NMEA 0183, UBX or gpsd")


def test_of_one_that_speaks_both_each_epoch_comes_once(make):
    receiver, found = Receiver(), []
    for second in range(30, 40):
        data = make["pvt"](second=second) + make["gga"](time=f"10:20:{second}")
        found += receiver.feed(data, float(second))
    assert len(found) == 10
    assert all(reading.velocity_sigma_mps for reading in found)


def test_damage_is_counted(make):
    receiver = Receiver()
    receiver.feed(
        make["gga"]().replace(b"37", b"38", 1) + b"noise" + make["pvt"]()[:-1] + b"x", 0.0
    )
    assert receiver.damaged == 2
    assert receiver.garbage > 5
