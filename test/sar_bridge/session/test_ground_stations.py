"""Ground stations beside: no two transfers mix, nothing keeps the failsafe from acting."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address, Addressed
from sar_bridge.session.ground_stations import (
    GIVEN_UP_S,
    STALLED_S,
    Bridge,
    GroundStations,
)

UAV, OWN = Address(1, 1), Address(255, 240)
FIRST, SECOND = Address(255, 190), Address(254, 190)
FREE = Bridge(UAV)
FLOWN = Bridge(UAV, flown=True)
BUSY = Bridge(UAV, flown=True, busy=True)
SILENT = Bridge(UAV, flown=True, silent=True)
COUNT = mavlink.MAVLink_mission_count_message(1, 1, 3, 0)
LIST = mavlink.MAVLink_mission_request_list_message(1, 1, 0)
CLEAR = mavlink.MAVLink_mission_clear_all_message(1, 1, 0)
ITEM = mavlink.MAVLink_mission_item_int_message(1, 1, 0, 3, 16, 0, 1, 0, 0, 0, 0, 1, 2, 100.0, 0)
ARM = mavlink.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
MODE = mavlink.MAVLink_command_long_message(1, 1, 176, 0, 1, 12, 0, 0, 0, 0, 0)
JUMP = mavlink.MAVLink_command_long_message(1, 1, 224, 0, 3, 0, 0, 0, 0, 0, 0)
RATE = mavlink.MAVLink_command_long_message(1, 1, 511, 0, 33, 1e6, 0, 0, 0, 0, 0)
BEAT = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
STICK = mavlink.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0)
KEY = mavlink.MAVLink_setup_signing_message(1, 1, [7] * 32, 1)
DONE = mavlink.MAVLink_mission_ack_message(1, 1, 0, 0)
FENCE = mavlink.MAVLink_mission_count_message(1, 1, 3, mavlink.MAV_MISSION_TYPE_FENCE)
GO_THERE = mavlink.MAVLink_mission_item_int_message(
    1, 1, 0, 3, 16, 2, 1, 0, 0, 0, 0, 1, 2, 100.0, 0
)


def sent(message, sender):
    """Return a message as it is received from a sender."""
    packet = message.pack(
        mavlink.MAVLink(None, srcSystem=sender.system, srcComponent=sender.component)
    )
    (received,) = mavlink.MAVLink(None).parse_buffer(packet)
    return received


def from_uav(message, to=FIRST):
    if to is not None:
        message.target_system, message.target_component = to.system, to.component
    return sent(message, UAV)


def take(stations, message, sender=FIRST, *, at=0.0, bridge=FREE, number=0):
    return stations.take(number, sent(message, sender), at, bridge)


@pytest.fixture
def stations():
    return GroundStations(OWN, 2)


@pytest.mark.parametrize("message", [ARM, MODE, JUMP, RATE, STICK, FENCE, GO_THERE])
@pytest.mark.parametrize("bridge", [FREE, FLOWN, BUSY])
def test_what_is_commanded_passes_unchanged(stations, message, bridge):
    traffic = take(stations, message, bridge=bridge)
    assert traffic.to_autopilot == [bytes(sent(message, FIRST).get_msgbuf())]
    assert traffic.to_stations == []
    assert traffic.item_chosen is (message is JUMP)
    assert traffic.rates_changed is (message is RATE)


@pytest.mark.parametrize("message", [BEAT, KEY])
@pytest.mark.parametrize("bridge", [FREE, FLOWN, BUSY, SILENT])
def test_signs_of_life_and_keys_never_pass(stations, message, bridge):
    assert take(stations, message, bridge=bridge).to_autopilot == []


def test_sticks_do_not_keep_an_autopilot_alive_whose_leader_is_silent(stations):
    assert take(stations, STICK, bridge=SILENT).to_autopilot == []
    assert take(stations, MODE, bridge=SILENT).to_autopilot != []


@pytest.mark.parametrize("message", [COUNT, CLEAR])
def test_no_mission_is_written_while_a_list_is_flown_and_the_reason_is_told(stations, message):
    traffic = take(stations, message, bridge=FLOWN)
    assert traffic.to_autopilot == []
    (first, ack), (second, text) = traffic.to_stations
    assert first == second == 0
    assert isinstance(ack, Addressed)
    assert ack.sender == UAV
    assert ack.message.type == mavlink.MAV_MISSION_DENIED
    assert text.sender.system == UAV.system
    assert "disengage" in text.message.text
    assert not stations.writing


def test_a_mission_written_is_told_of_and_keeps_ours_back_until_it_is_there(stations):
    assert take(stations, COUNT).mission_changed
    assert stations.writing
    assert take(stations, ITEM, at=0.1).to_autopilot
    packet = from_uav(mavlink.MAVLink_mission_ack_message(0, 0, 0, 0))
    assert [station for station, _ in stations.pass_on(packet, 0.2, busy=False)] == [0]
    assert not stations.writing


def test_a_transfer_that_stands_still_is_forgotten(stations):
    take(stations, COUNT)
    stations.tick(STALLED_S - 0.1, FREE)
    assert stations.writing
    stations.tick(STALLED_S + 0.1, FREE)
    assert not stations.writing


@pytest.mark.parametrize("message", [LIST, COUNT])
def test_a_transfer_begun_during_ours_waits_for_it(stations, message):
    busy = Bridge(UAV, busy=True)
    assert take(stations, message, bridge=busy).to_autopilot == []
    assert stations.tick(0.5, busy) == []
    (traffic,) = stations.tick(1.0, FREE)
    assert traffic.to_autopilot == [bytes(sent(message, FIRST).get_msgbuf())]
    assert stations.tick(1.1, FREE) == []


def test_one_that_has_waited_too_long_is_not_begun_any_more(stations):
    take(stations, LIST, bridge=BUSY)
    assert stations.tick(GIVEN_UP_S + 0.1, FREE) == []


def test_two_stations_take_turns(stations):
    take(stations, LIST)
    assert take(stations, LIST, SECOND, number=1, at=0.1).to_autopilot == []
    assert take(stations, ITEM, SECOND, number=1, at=0.1).to_autopilot == []
    assert stations.tick(0.2, FREE) == []
    take(stations, DONE, at=0.3)
    (traffic,) = stations.tick(0.4, FREE)
    assert traffic.to_autopilot == [bytes(sent(LIST, SECOND).get_msgbuf())]


def test_what_is_read_makes_way_for_a_list_of_ours(stations):
    take(stations, LIST)
    traffic = stations.make_way(FLOWN)
    assert traffic.to_stations[0][1].message.type == mavlink.MAV_MISSION_OPERATION_CANCELLED
    assert stations.make_way(FLOWN).to_stations == []
    take(stations, COUNT)
    assert stations.make_way(FREE).to_stations == []  # what is written is let finish


def test_answers_go_to_whom_they_are_meant_for_and_telemetry_to_all(stations):
    take(stations, BEAT)
    take(stations, BEAT, SECOND, number=1)
    answer = mavlink.MAVLink_command_ack_message(400, 0)
    to = {
        station: from_uav(answer, address)
        for station, address in ((0, FIRST), (1, SECOND), (None, OWN))
    }
    for station, message in to.items():
        found = [number for number, _ in stations.pass_on(message, 0.0, busy=False)]
        assert found == ([] if station is None else [station])
        assert stations.is_ours(message) is (station is None)
    beat = from_uav(BEAT, None)
    assert [number for number, _ in stations.pass_on(beat, 0.0, busy=True)] == [0, 1]
    assert stations.is_ours(beat)


@pytest.mark.parametrize("in_transfer", [True, False])
def test_of_an_autopilot_that_names_nobody_the_transfer_tells(stations, in_transfer):
    if in_transfer:
        take(stations, COUNT)
    asked = from_uav(mavlink.MAVLink_mission_request_int_message(0, 0, 0, 0), Address(0, 0))
    assert stations.is_ours(asked) is not in_transfer
    found = [number for number, _ in stations.pass_on(asked, 0.1, busy=not in_transfer)]
    assert found == ([0] if in_transfer else [])


def test_a_station_with_the_bridges_own_address_is_told_of_and_not_heard(stations):
    assert take(stations, ARM, OWN).to_autopilot == []
    assert stations.same_address


def test_what_is_for_another_vehicle_is_not_sent_to_this_one(stations):
    other = mavlink.MAVLink_command_long_message(7, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    assert take(stations, other).to_autopilot == []


def test_how_many_are_there_is_known(stations):
    take(stations, BEAT)
    assert stations.heard(1.0) == 1
    assert stations.heard(10.0) == 0


EVENTS = list(
    itertools.product(
        (COUNT, LIST, CLEAR, ITEM, DONE, BEAT, STICK, MODE),
        ((0, FIRST), (1, SECOND)),
        (FREE, FLOWN, BUSY, SILENT),
    )
)


@settings(max_examples=300)
@given(st.lists(st.tuples(st.sampled_from(EVENTS), st.floats(0.0, 4.0)), max_size=40))
def test_whatever_is_sent_one_transfer_is_under_way_and_none_while_ours_is(events):
    stations, now = GroundStations(OWN, 2), 0.0
    writer = None
    for (message, (number, sender), bridge), later in events:
        now += later
        passed = [
            *stations.tick(now, bridge),
            take(stations, message, sender, at=now, bridge=bridge, number=number),
        ]
        for traffic in passed:
            for packet in traffic.to_autopilot:
                (heard,) = mavlink.MAVLink(None).parse_buffer(packet)
                kind = heard.get_type()
                assert kind != "HEARTBEAT"
                assert not (kind == "MANUAL_CONTROL" and bridge.silent)
                begins = kind in ("MISSION_COUNT", "MISSION_REQUEST_LIST", "MISSION_CLEAR_ALL")
                assert not (begins and bridge.busy)
                assert not (kind in ("MISSION_COUNT", "MISSION_CLEAR_ALL") and bridge.flown)
                if kind == "MISSION_COUNT":
                    writer = heard.get_srcSystem()
                if kind == "MISSION_ITEM_INT":
                    assert heard.get_srcSystem() == writer or not stations.writing
