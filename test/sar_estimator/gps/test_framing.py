"""Frames come out whole however the bytes come, and nothing that is damaged comes out at all."""

import itertools

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sar_estimator.gps.framing import LONGEST_LINE, Framer, Protocol

RTCM = bytes.fromhex("d300133ed7d30202980edeef34b4bd62ac0941986f33360b98")
SIRF = bytes.fromhex("a0a20003010203000600b0b3".replace("000600", "0006"))


@pytest.fixture
def stream(make):
    """Frames of every protocol, and the bytes between them."""
    return [
        (Protocol.NMEA, make["gga"]()),
        (Protocol.UBX, make["pvt"]()),
        (Protocol.GPSD, b'{"class":"TPV","mode":1}\n'),
        (Protocol.SIRF, SIRF),
        (Protocol.RTCM, RTCM),
        (Protocol.NMEA, make["rmc"]()),
    ]


def wanted(frames):
    return [(protocol, data.rstrip(b"\r\n")) for protocol, data in frames]


def fed(chunks):
    framer = Framer()
    return framer, [tuple(frame) for chunk in chunks for frame in framer.feed(chunk)]


@pytest.mark.parametrize("size", [1, 2, 3, 7, 16, 1000])
def test_any_chunks_give_the_same_frames(stream, size):
    data = b"".join(frame for _, frame in stream)
    chunks = [data[i : i + size] for i in range(0, len(data), size)]
    framer, found = fed(chunks)
    assert found == wanted(stream)
    assert framer.garbage == 0
    assert not framer.damaged


def test_garbage_between_frames_is_counted_and_loses_none(stream):
    noise = [b"\x00\xff\x80", b"hello\r\n", b"\xb5\x00", b"\xa0\x01", b"\xd3\xff", b"\xfe"]
    data = b"".join(one + frame for one, (_, frame) in zip(noise, stream, strict=True))
    framer, found = fed([data])
    assert found == wanted(stream)
    assert framer.garbage == sum(len(one.strip(b"\r\n")) for one in noise)


def test_a_frame_that_is_cut_off_does_not_take_the_next_one_with_it(make):
    whole, other = make["gga"](), make["pvt"]()
    for cut in range(1, len(whole) - 2):
        framer, found = fed([whole[:cut] + other + whole])
        assert found == wanted([(Protocol.UBX, other), (Protocol.NMEA, whole)])
        assert framer.garbage == cut
    for cut in range(2, len(other)):
        _, found = fed([other[:cut], whole * 40, other])
        assert (Protocol.UBX, other) in found
        assert (Protocol.UBX, other[:cut]) not in found


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.floats(0.0, 1.0, exclude_max=True), st.integers(1, 255))
def test_a_message_with_a_wrong_byte_is_not_handed_on(make, share, bits):
    whole = make["pvt"]()
    wrong = bytearray(whole)
    wrong[int(share * len(whole))] ^= bits
    _, found = fed([bytes(wrong), whole])
    assert (Protocol.UBX, bytes(wrong)) not in found


def test_a_line_without_an_end_is_given_up():
    framer, found = fed([b"$" + b"A" * (3 * LONGEST_LINE), b"\n"])
    assert found == []
    assert framer.damaged[Protocol.NMEA] == 1


def test_random_bytes_are_almost_never_a_frame():
    rng = np.random.default_rng(3)
    framer, found = fed([rng.bytes(50_000) for _ in range(4)])
    # Of lines of text it is the decoder that looks into them.
    assert {protocol for protocol, _ in found} <= {Protocol.NMEA, Protocol.GPSD}
    assert framer.garbage > 50_000


def test_what_waits_for_its_end_is_bounded(make):
    framer = Framer()
    for chunk in itertools.repeat(b"\xb5\x62\x01\x07\xff\x07" + b"\x00" * 50, 400):
        framer.feed(chunk)
    assert len(framer._buffer) < 5000
    assert [frame.protocol for frame in framer.feed(b"\x00" * 2100 + make["gga"]())][-1:] == [
        Protocol.NMEA
    ]
