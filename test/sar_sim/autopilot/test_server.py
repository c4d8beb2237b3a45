import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import waypoint_items
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_sim.autopilot import telemetry
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav

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


def test_wrong_sequence_and_items_out_of_the_blue_are_answered_as_ardupilot_does(server):
    items = waypoint_items(np.array([[100.0, 5.0]]), DATUM, 150.0)
    (unasked,) = tell(server, item(0, items[0]))
    assert unasked.type == mavlink.MAV_MISSION_ERROR
    tell(server, mavlink.MAVLink_mission_count_message(1, 1, 3))
    (denied,) = tell(server, mavlink.MAVLink_mission_request_int_message(1, 1, 0))
    assert denied.type == mavlink.MAV_MISSION_DENIED
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
    beat = telemetry.heartbeat(server._autopilot)
    assert beat.custom_mode == FlightMode.GUIDED
    assert beat.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED


def arduplane():
    uav = Uav(autopilot="arduplane", **AUTOPILOTS["arduplane"])
    pilot = SimAutopilot(Pose(0, 0, 0), speed_mps=20.0, uav=uav, datum=DATUM)
    server = AutopilotServer(pilot, DATUM)
    upload(server, waypoint_items(np.array([[100.0, 5.0], [9000.0, -70.0]]), DATUM, 150.0))
    pilot.set_mode(FlightMode.AUTO)
    return pilot, server


def heartbeat(server, now):
    beat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 0, 3)
    tell(server, beat, now)


def test_a_ground_station_that_falls_silent_sends_arduplane_home():
    pilot, server = arduplane()
    server.tick(100.0)
    assert pilot.mode is FlightMode.AUTO  # none was ever heard
    for now in range(100, 130):
        heartbeat(server, float(now))
        server.tick(now + 0.9)
    server.tick(129.0 + 9.9)
    assert pilot.mode is FlightMode.AUTO
    server.tick(129.0 + 10.1)
    assert pilot.mode is FlightMode.RTL


def test_a_human_who_has_taken_the_mode_keeps_it():
    pilot, server = arduplane()
    heartbeat(server, 0.0)
    server.take()
    assert pilot.mode is FlightMode.LOITER
    server.tick(60.0)
    assert pilot.mode is FlightMode.LOITER


def test_an_autopilot_that_boots_keeps_mission_and_mode_and_forgets_a_transfer():
    pilot, server = arduplane()
    tell(server, mavlink.MAVLink_mission_count_message(1, 1, 4))
    held = len(pilot.items)
    server.restart(500.0)
    assert not server.transferring(0.0)
    assert (pilot.mode, len(pilot.items)) == (FlightMode.AUTO, held)
    (position,) = [m for m in server.telemetry(501.5) if m.get_type() == "GLOBAL_POSITION_INT"]
    assert position.time_boot_ms == 1500
    assert tell(server, item(0, waypoint_items(np.zeros((1, 2)), DATUM, 1.0)[0]))[0].type == (
        mavlink.MAV_MISSION_ERROR
    )


def test_the_heartbeat_is_repeated_while_time_stands_until_somebody_answers(server):
    def heartbeats(time_s):
        return sum(one.get_type() == "HEARTBEAT" for one in server.telemetry(time_s))

    assert [heartbeats(0.0) for _ in range(4)] == [1, 1, 1, 1]
    tell(server, mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    assert [heartbeats(0.0) for _ in range(4)] == [0, 0, 0, 0]
    assert sum(heartbeats(0.05 * i) for i in range(1, 41)) == 2
