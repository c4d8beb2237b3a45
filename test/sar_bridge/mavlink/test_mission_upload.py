"""The upload's state machine against a scripted autopilot, with loss and with nonsense."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.mission_items import MissionItem
from sar_bridge.mavlink.mission_upload import MissionUpload, UploadState

TARGET = Address(1, 1)


def items(n, base=0):
    return [MissionItem(mavlink.MAV_CMD_NAV_WAYPOINT, base + i, -i, 150.0) for i in range(n)]


def request(seq):
    return mavlink.MAVLink_mission_request_int_message(255, 190, seq)


def ack(result=mavlink.MAV_MISSION_ACCEPTED, mission_type=0):
    return mavlink.MAVLink_mission_ack_message(255, 190, result, mission_type)


def test_whole_transfer():
    upload = MissionUpload(TARGET)
    (count,) = upload.start(items(3), 7.5, 0.0)
    assert (count.get_type(), count.count) == ("MISSION_COUNT", 3)
    for seq in range(3):
        (item,) = upload.handle(request(seq), 0.1)
        assert (item.seq, item.x, item.y) == (seq, seq, -seq)
        assert (item.target_system, item.target_component) == (1, 1)
    assert upload.handle(ack(), 0.2) == []
    assert upload.state is UploadState.ACCEPTED
    assert upload.token == 7.5


def test_no_response_is_repeated_eight_times_and_given_up():
    upload = MissionUpload(TARGET)
    upload.start(items(3), None, 0.0)
    now, sent = 0.0, 0
    while upload.active:
        now += 0.05
        sent += len(upload.tick(now))
    assert sent == 8
    assert now == pytest.approx(9 * 1.5, abs=0.5)
    assert upload.failure == "no answer after 8 retries in state counting"


def test_where_the_first_request_is_lost_the_count_is_repeated():
    upload = MissionUpload(TARGET)
    (count,) = upload.start(items(3), 1.0, 0.0)
    assert upload.tick(1.6) == [count]
    (item,) = upload.handle(request(0), 1.7)
    assert item.seq == 0


def test_item_is_repeated_after_a_quarter_of_a_second():
    upload = MissionUpload(TARGET)
    upload.start(items(3), None, 0.0)
    upload.handle(request(0), 0.0)
    assert upload.tick(0.2) == []
    (again,) = upload.tick(0.26)
    assert again.seq == 0


def test_last_item_waits_longer_for_the_final_ack():
    upload = MissionUpload(TARGET)
    upload.start(items(1), None, 0.0)
    upload.handle(request(0), 0.0)
    assert upload.tick(0.5) == []
    assert len(upload.tick(1.6)) == 1


def missing_final_ack():
    upload = MissionUpload(TARGET)
    upload.start(items(3), None, 0.0)
    for seq in range(3):
        upload.handle(request(seq), 0.0)
    (again,) = upload.tick(1.6)
    assert (again.get_type(), again.seq) == ("MISSION_ITEM_INT", 2)
    (asked,) = upload.handle(ack(mavlink.MAV_MISSION_ERROR), 1.7)
    assert (asked.get_type(), asked.seq) == ("MISSION_REQUEST_INT", 2)
    return upload


def held(x=2, y=-2, z=150.0, seq=2, param1=0.0):
    params = (param1, 0.0, 0.0, 0.0)
    return mavlink.MAVLink_mission_item_int_message(255, 190, seq, 6, 16, 0, 1, *params, x, y, z)


def test_a_missing_final_ack_is_made_up_for_by_asking_for_the_last_item():
    upload = missing_final_ack()
    assert upload.handle(ack(mavlink.MAV_MISSION_ERROR), 1.75) == []
    assert upload.handle(held(seq=1), 1.75) == []
    assert upload.active
    upload.handle(held(), 1.8)
    assert upload.state is UploadState.ACCEPTED
    upload = missing_final_ack()
    assert upload.tick(3.5)[0].get_type() == "MISSION_REQUEST_INT"
    upload.handle(ack(), 3.6)
    assert upload.state is UploadState.ACCEPTED


@pytest.mark.parametrize("other", [{"x": 3}, {"y": 0}, {"z": 151.0}, {"param1": 7.0}])
def test_a_last_item_that_is_another_is_a_failure(other):
    upload = missing_final_ack()
    upload.handle(held(**other), 1.8)
    assert (upload.state, upload.failure) == (UploadState.FAILED, "item 2 is not the one sent")


def test_an_autopilot_that_still_expects_the_last_item_gets_it():
    upload = missing_final_ack()
    assert upload.handle(ack(mavlink.MAV_MISSION_DENIED), 1.8) == []
    (item,) = upload.handle(request(2), 1.9)
    assert (item.get_type(), item.seq) == ("MISSION_ITEM_INT", 2)
    assert upload.handle(held(), 2.0) == []
    assert upload.active
    upload.handle(ack(), 2.1)
    assert upload.state is UploadState.ACCEPTED


def test_repeated_requests_are_served_and_those_from_nowhere_are_not():
    upload = MissionUpload(TARGET)
    upload.start(items(4), None, 0.0)
    assert upload.handle(request(2), 0.1) == []
    assert [upload.handle(request(s), 0.1)[0].seq for s in (0, 0, 1, 0, 2)] == [0, 0, 1, 0, 2]
    assert upload.handle(request(9), 0.1) == []
    assert upload.state is UploadState.SENDING


def test_early_ack_of_an_older_upload_is_not_taken():
    upload = MissionUpload(TARGET)
    upload.start(items(3), None, 0.0)
    upload.handle(ack(), 0.1)
    upload.handle(request(0), 0.1)
    upload.handle(ack(mavlink.MAV_MISSION_OPERATION_CANCELLED), 0.1)
    upload.handle(ack(mavlink.MAV_MISSION_INVALID_SEQUENCE), 0.1)
    assert upload.active


@pytest.mark.parametrize("delay", [0.1, 0.4, 0.6])
def test_slow_radio(delay):
    """Round trips longer than the item time-out: repeats meet INVALID_SEQUENCE and go on."""
    upload = MissionUpload(TARGET)
    now, wanted = 0.0, 0
    up = [(delay, message) for message in upload.start(items(12), None, 0.0)]
    down = []
    while upload.active and now < 60.0:
        now += 0.05
        for at, message in [entry for entry in up if entry[0] <= now]:
            up.remove((at, message))
            if message.get_type() == "MISSION_COUNT" or message.seq == wanted:
                wanted += message.get_type() != "MISSION_COUNT"
                down.append((now + delay, ack() if wanted == 12 else request(wanted)))
            else:
                down.append((now + delay, ack(mavlink.MAV_MISSION_INVALID_SEQUENCE)))
        for at, message in [entry for entry in down if entry[0] <= now]:
            down.remove((at, message))
            up += [(now + delay, answer) for answer in upload.handle(message, now)]
        up += [(now + delay, message) for message in upload.tick(now)]
    assert upload.state is UploadState.ACCEPTED
    assert wanted == 12


def test_error_ack_ends_with_its_name():
    upload = MissionUpload(TARGET)
    upload.start(items(3), None, 0.0)
    upload.handle(request(0), 0.1)
    upload.handle(ack(mavlink.MAV_MISSION_NO_SPACE), 0.2)
    assert upload.state is UploadState.FAILED
    assert upload.failure == "autopilot refused: MAV_MISSION_NO_SPACE"


def test_other_mission_types_are_not_ours():
    upload = MissionUpload(TARGET)
    upload.start(items(1), None, 0.0)
    fence = mavlink.MAVLink_mission_request_int_message(255, 190, 0, 1)
    assert upload.handle(fence, 0.0) == []
    upload.handle(request(0), 0.0)
    upload.handle(ack(mission_type=1), 0.0)
    assert upload.active


def test_newer_list_supersedes():
    upload = MissionUpload(TARGET)
    upload.start(items(5), 1.0, 0.0)
    upload.handle(request(0), 0.1)
    upload.start(items(2, base=100), 2.0, 0.2)
    assert upload.handle(request(3), 0.25) == []  # the autopilot still asks for the old list
    assert upload.handle(request(0), 0.3)[0].x == 100
    upload.handle(request(1), 0.3)
    upload.handle(ack(), 0.4)
    assert (upload.state, upload.token) == (UploadState.ACCEPTED, 2.0)


def test_cancelled_upload_is_silent():
    upload = MissionUpload(TARGET)
    upload.start(items(5), None, 0.0)
    upload.cancel()
    assert upload.handle(request(0), 0.1) == upload.tick(10.0) == []


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.0, 0.25), st.integers(1, 40))
def test_lossy_link_delivers_every_item_or_says_that_it_failed(seed, loss, n):  # noqa: C901
    """An autopilot that asks again is simulated; both ways lose messages at random."""
    rng = np.random.default_rng(seed)
    upload = MissionUpload(TARGET)
    sent = items(n)
    to_autopilot = upload.start(sent, None, 0.0)
    got, expected, asked_at, now = {}, None, 0.0, 0.0
    while upload.active and now < 120.0:
        now += 0.05
        back = []
        for message in to_autopilot:
            if rng.random() < loss:
                continue
            if message.get_type() == "MISSION_COUNT" and not got:
                expected = message.count
                back.append(request(0))
            elif message.get_type() == "MISSION_ITEM_INT" and message.seq == len(got):
                got[message.seq] = message.x
                back.append(ack() if len(got) == expected else request(len(got)))
            elif message.get_type() == "MISSION_ITEM_INT" and len(got) == expected:
                back.append(ack())
            asked_at = now
        if expected is not None and len(got) < expected and now - asked_at > 0.3:
            back.append(request(len(got)))
            asked_at = now
        to_autopilot = upload.tick(now)
        for message in back:
            if rng.random() >= loss:
                to_autopilot += upload.handle(message, now)
    if upload.state is UploadState.ACCEPTED:
        assert got == {i: item.latitude_e7 for i, item in enumerate(sent)}
    else:
        assert upload.state is UploadState.FAILED
        assert upload.failure
