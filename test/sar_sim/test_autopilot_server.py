import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mission_items import waypoint_items
from sar_estimator.geodesy import Datum
from sar_estimator.plane import Pose
from sar_sim.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot_server import AutopilotServer

DATUM = Datum(37.8, -122.8)
GROUND = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)


@pytest.fixture
def server():
    pilot = SimAutopilot(Pose(0, 0, 0), speed_mps=20.0, datum=DATUM)
    return AutopilotServer(pilot, DATUM)


def tell(server, message, now=0.0):
    (heard,) = mavlink.MAVLink(None).parse_buffer(message.pack(GROUND))
    return server.handle(heard, now)


def item(seq, source):
    return mavlink.MAVLink_mission_item_int_message(
        1, 1, seq, source.frame, source.command, 0, 1, 0, 0, 0, 0,
        source.latitude_e7, source.longitude_e7, source.altitude_m,
    )  # fmt: skip


def upload(server, items):
    (asked,) = tell(server, mavlink.MAVLink_mission_count_message(1, 1, len(items)))
    assert server.transferring(0.0)
    for seq, one in enumerate(items):
        assert asked.seq == seq
        (asked,) = tell(server, item(seq, one))
    return asked


def test_upload_and_download_compare_equal(server):
    items = waypoint_items(np.array([[100.0, 5.0], [900.0, -70.0]]), DATUM, 150.0)
    assert upload(server, items).type == mavlink.MAV_MISSION_ACCEPTED
    assert server.transferring(0.1)  # until it is made current, a moment at most
    assert not server.transferring(0.3)
    (count,) = tell(server, mavlink.MAVLink_mission_request_list_message(1, 1))
    assert count.count == len(items)
    for seq, one in enumerate(items):
        (back,) = tell(server, mavlink.MAVLink_mission_request_int_message(1, 1, seq))
        assert (back.x, back.y, back.z, back.command) == (
            one.latitude_e7, one.longitude_e7, one.altitude_m, one.command,
        )  # fmt: skip
    (refused,) = tell(server, mavlink.MAVLink_mission_request_int_message(1, 1, 99))
    assert refused.type == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_missing_item_is_asked_for_again_and_given_up(server):
    tell(server, mavlink.MAVLink_mission_count_message(1, 1, 3))
    answers = [message for t in np.arange(0.05, 10.0, 0.05) for message in server.tick(t)]
    assert [m.get_type() for m in answers[:-1]] == ["MISSION_REQUEST_INT"] * 20
    assert answers[-1].type == mavlink.MAV_MISSION_OPERATION_CANCELLED
    assert server.tick(20.0) == []


def test_wrong_sequence_and_items_out_of_the_blue_are_ignored(server):
    items = waypoint_items(np.array([[100.0, 5.0]]), DATUM, 150.0)
    assert tell(server, item(0, items[0])) == []
    tell(server, mavlink.MAVLink_mission_count_message(1, 1, 3))
    (wrong,) = tell(server, item(2, items[2]))
    assert wrong.type == mavlink.MAV_MISSION_INVALID_SEQUENCE
    assert server.transferring(0.0)


def test_fences_are_not_supported_and_nothing_clears_the_mission(server):
    (refused,) = tell(server, mavlink.MAVLink_mission_count_message(1, 1, 3, 1))
    assert refused.type == mavlink.MAV_MISSION_UNSUPPORTED
    (accepted,) = tell(server, mavlink.MAVLink_mission_count_message(1, 1, 0))
    assert accepted.type == mavlink.MAV_MISSION_ACCEPTED


def command(number, *params):
    params = (*params, *([0.0] * (7 - len(params))))
    return mavlink.MAVLink_command_long_message(1, 1, number, 0, *params)


@pytest.mark.parametrize(
    ("message", "result"),
    [
        (command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, 12.0), mavlink.MAV_RESULT_ACCEPTED),
        (command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, 10.0), mavlink.MAV_RESULT_FAILED),
        (command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, 0.0), mavlink.MAV_RESULT_DENIED),
        (command(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, 3.0), mavlink.MAV_RESULT_DENIED),
        (command(mavlink.MAV_CMD_DO_CHANGE_SPEED, 0.0, 22.0), mavlink.MAV_RESULT_ACCEPTED),
        (command(mavlink.MAV_CMD_NAV_TAKEOFF), mavlink.MAV_RESULT_UNSUPPORTED),
    ],
)
def test_commands_are_acknowledged(server, message, result):
    (answer,) = tell(server, message)
    assert (answer.get_type(), answer.command, answer.result) == (
        "COMMAND_ACK", message.command, result,
    )  # fmt: skip


def test_messages_for_another_system_are_not_answered(server):
    assert tell(server, mavlink.MAVLink_mission_count_message(7, 1, 3)) == []


def test_telemetry_rates(server):
    kinds = [m.get_type() for t in np.arange(0.0, 10.0, 0.05) for m in server.telemetry(t)]
    assert kinds.count("GLOBAL_POSITION_INT") == 100
    assert kinds.count("ATTITUDE") == 100
    assert kinds.count("HEARTBEAT") == 10
    beat = server._heartbeat()
    assert beat.custom_mode == FlightMode.GUIDED
    assert beat.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
