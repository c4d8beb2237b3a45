"""Signed links: what is refused, and that forgeries lock nobody out."""

import os
import socket
import time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.link import Link
from sar_bridge.mavlink.signing import EPOCH_S, TICKS_PER_S, Signer, VerifyingParser, read_key

KEY = bytes(range(32))
WALL_S = EPOCH_S + 1000.0


def key_file(tmp_path, data=KEY, mode=0o600, name="key"):
    path = tmp_path / name
    path.write_bytes(data)
    path.chmod(mode)
    return path


def sender(key=KEY, timestamp=1000 * TICKS_PER_S, system=1):
    mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=1)
    mav.signing.secret_key = key
    mav.signing.sign_outgoing = key is not None
    mav.signing.timestamp = timestamp
    return mav


def heartbeat(mav):
    return mavlink.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3).pack(mav)


def parser(tmp_path, kind=VerifyingParser):
    found = kind(None)
    found.robust_parsing = True
    found.signing = Signer(key_file(tmp_path), WALL_S).state
    return found


def heard(found, data):
    messages = found.parse_buffer(data) or []
    return [m.get_type() for m in messages if m.get_type() != "BAD_DATA"]


def test_keys_are_raw_or_hex(tmp_path):
    assert read_key(key_file(tmp_path)) == KEY
    assert read_key(key_file(tmp_path, KEY.hex().encode() + b"\n")) == KEY


@pytest.mark.parametrize(
    ("data", "mode", "message"),
    [
        (KEY, 0o644, "mode 644, expected 600"),
        (KEY, 0o660, "mode 660, expected 600"),
        (KEY[:31], 0o600, "31 bytes, expected 32, or 64 hex digits"),
        (b"secret" * 11, 0o600, "66 bytes, expected 32"),
        (b"", 0o600, "0 bytes, expected 32"),
    ],
)
def test_bad_keys_are_refused_without_being_told(tmp_path, data, mode, message):
    with pytest.raises(ValueError, match="signing key") as error:
        read_key(key_file(tmp_path, data, mode))
    assert message in str(error.value)
    assert str(tmp_path / "key") in str(error.value)
    assert "secret" not in str(error.value)
    with pytest.raises(ValueError, match="No such file"):
        read_key(tmp_path / "none")


def test_only_what_is_signed_with_the_key_is_heard(tmp_path):
    found = parser(tmp_path)
    assert heard(found, heartbeat(sender())) == ["HEARTBEAT"]
    assert heard(found, heartbeat(sender(key=None))) == []
    assert heard(found, heartbeat(sender(key=b"x" * 32, timestamp=2000 * TICKS_PER_S))) == []
    assert found.forgeries == 1
    radio = mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7).pack(sender(key=None))
    assert heard(found, radio) == ["RADIO_STATUS"]


def test_a_repeated_packet_is_not_heard_again(tmp_path):
    found = parser(tmp_path)
    packet = heartbeat(sender())
    assert heard(found, packet) == ["HEARTBEAT"]
    assert heard(found, packet) == []


def test_a_forged_packet_from_the_future_locks_nobody_out(tmp_path):
    forged = heartbeat(sender(key=b"x" * 32, timestamp=9000 * TICKS_PER_S))
    for kind, lockout in ((VerifyingParser, False), (mavlink.MAVLink, True)):
        found, real = parser(tmp_path, kind), sender()
        assert heard(found, heartbeat(real)) == ["HEARTBEAT"]
        assert heard(found, forged) == []
        assert (heard(found, heartbeat(real)) == []) is lockout


def test_timestamps_do_not_go_back_over_a_restart_or_with_the_clock(tmp_path):
    path = key_file(tmp_path)
    first = Signer(path, WALL_S)
    first.advance(WALL_S + 30.0)
    used = first.state.timestamp
    again = Signer(path, WALL_S - 500.0)
    assert again.state.timestamp >= used
    (path.parent / "key.timestamp").write_text("nonsense")
    assert Signer(path, WALL_S).state.timestamp == 1000 * TICKS_PER_S


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def exchange(ground, vehicle, seconds=3.0):
    """Return what the ground hears of a vehicle that sends heartbeats."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        vehicle.send([mavlink.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3)])
        messages = ground.receive(0.1)
        if messages:
            return messages
    return []


def test_two_links_with_one_key_hear_each_other_and_others_do_not(tmp_path):
    port = free_port()
    ground = Link(f"udp:127.0.0.1:{port}", signer=Signer(key_file(tmp_path), time.time()))
    other = key_file(tmp_path, name="other")
    try:
        for signer, hears in (
            (Signer(other, time.time()), True),
            (None, False),
            (Signer(key_file(tmp_path, os.urandom(32), name="wrong"), time.time()), False),
        ):
            vehicle = Link(f"udpout:127.0.0.1:{port}", system=1, component=1, signer=signer)
            try:
                assert bool(exchange(ground, vehicle, 3.0 if hears else 0.5)) is hears
            finally:
                vehicle.close()
    finally:
        ground.close()
