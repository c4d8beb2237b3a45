"""A session against the simulated autopilot's server, without sockets."""

import math

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.autopilot_state import AutopilotState, BootClock
from sar_bridge.mavlink.commands import Command, CommandQueue
from sar_bridge.mavlink.mission_items import waypoint_items
from sar_bridge.mavlink.mission_upload import Address
from sar_bridge.mission.mission_slots import CAPTURE_ITEMS, SLOT_ITEMS, SLOTS
from sar_bridge.session.session import AutopilotSession
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_sim.autopilot.autopilot import FlightMode, SimAutopilot
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.scenario.scenario import Uav, Wind

DATUM = Datum(37.8, -122.8)
LINE = np.array([[300.0, -250.0], [3000.0, -250.0]])


class Bench:
    """A session and an autopilot joined by bytes."""

    def __init__(self, *, uav=None, wind=None, **options):
        self.autopilot = SimAutopilot(
            Pose(0.0, -250.0, 0.0),
            speed_mps=20.0,
            uav=uav or Uav(),
            wind=wind or Wind(),
            datum=DATUM,
        )
        self.server = AutopilotServer(self.autopilot, DATUM)
        self.session = AutopilotSession(altitude_m=150.0, **options)
        self.to_vehicle = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
        self.to_ground = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        self.now = 0.0
        self.trip_s = 0.0  # flown while a message goes out and the answer comes back
        self.sent = []

    def exchange(self, messages, rounds=-1):
        """Deliver messages and the answers, until nobody speaks or so many times."""
        while messages and rounds != 0:
            rounds -= 1
            self.sent += messages
            answers = []
            for message in messages:
                for heard in self.to_ground.parse_buffer(message.pack(self.to_vehicle)) or []:
                    answers += self.server.handle(heard, self.now)
            if self.trip_s > 0.0:
                self.now += self.trip_s
                self.autopilot.step(self.trip_s)
                answers += self.server.telemetry(self.now)
            messages = self.hear(answers)

    def hear(self, answers):
        out = []
        for answer in answers:
            for heard in self.to_vehicle.parse_buffer(answer.pack(self.to_ground)) or []:
                more, _ = self.session.handle(heard, now_s=self.now, ros_s=self.now, datum=DATUM)
                out += more
        return out

    def run(self, seconds):
        for _ in range(round(seconds / 0.05)):
            self.now += 0.05
            self.autopilot.step(0.05)
            self.exchange(self.hear(self.server.telemetry(self.now)))
            self.exchange(self.session.tick(self.now))

    def mode(self, mode):
        self.autopilot.set_mode(mode)
        self.run(1.2)


@pytest.fixture
def bench():
    found = Bench()
    found.run(1.5)
    return found


def command_numbers(bench):
    return [m.command for m in bench.sent if m.get_type() == "COMMAND_LONG"]


def test_hears_the_autopilot_and_is_heard(bench):
    assert bench.session.address == Address(1, 1)
    assert bench.server.gcs_seen
    state = bench.session.state
    assert (state.mode, state.armed, state.ardupilot) == ("GUIDED", True, True)
    motion = state.telemetry.motion
    assert motion.x_m == pytest.approx(20.0 * bench.now, abs=2.5)
    assert motion.y_m == pytest.approx(-250.0, abs=0.1)
    assert (motion.vx_mps, motion.vy_mps) == pytest.approx((20.0, 0.0), abs=0.01)
    assert state.telemetry.yaw_rad == pytest.approx(0.0, abs=1e-3)
    assert state.telemetry.altitude_m == pytest.approx(150.0, abs=0.01)
    assert bench.session.problem(bench.now) == ""


def test_first_list_is_uploaded_made_current_and_flown_from_guided(bench):
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    assert bench.autopilot.mode is FlightMode.AUTO
    assert bench.autopilot.current == 1
    assert len(bench.autopilot.items) == 1 + SLOTS * SLOT_ITEMS
    assert bench.session.accepted.list_id == 1
    bench.run(5.0)
    assert bench.autopilot.state.y_m == pytest.approx(-250.0, abs=0.1)


def test_it_never_arms_nor_takes_off(bench):
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.run(3.0)
    bench.exchange(bench.session.set_list(LINE + 5.0, 2.0, DATUM, bench.now))
    bench.exchange(bench.session.return_home(bench.now))
    bench.run(3.0)
    assert set(command_numbers(bench)) <= {
        mavlink.MAV_CMD_DO_SET_MODE,
        mavlink.MAV_CMD_DO_SET_MISSION_CURRENT,
        mavlink.MAV_CMD_SET_MESSAGE_INTERVAL,
    }


def test_list_from_before_the_session_does_not_change_the_mode(bench):
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now, may_engage=False))
    bench.run(1.0)
    assert bench.autopilot.mode is FlightMode.GUIDED
    assert len(bench.autopilot.items) == 1 + SLOTS * SLOT_ITEMS


def test_waypoints_passed_during_the_upload_are_skipped(bench):
    points = np.array([[10.0, -250.0], [200.0, -250.0], [900.0, -250.0]])
    bench.exchange(bench.session.set_list(points, 1.0, DATUM, bench.now))
    assert bench.autopilot.current == 2


def test_a_human_changing_the_mode_is_never_fought(bench):
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.run(1.5)
    bench.mode(FlightMode.LOITER)
    assert bench.session.guard.released
    assert "mode LOITER" in bench.session.problem(bench.now)
    before = len(bench.sent)
    bench.exchange(bench.session.set_list(LINE + 50.0, 2.0, DATUM, bench.now))
    bench.run(5.0)
    assert bench.autopilot.mode is FlightMode.LOITER
    assert {m.get_type() for m in bench.sent[before:]} <= {"HEARTBEAT", "PARAM_REQUEST_READ"}
    # The planner withdraws its list, and the human goes on to another mode: told all the same.
    bench.exchange(bench.session.set_list(np.empty((0, 2)), 3.0, DATUM, bench.now))
    bench.mode(FlightMode.RTL)
    assert "mode LOITER" in bench.session.problem(bench.now)


def test_a_new_engagement_after_a_release(bench):
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.run(1.5)
    bench.mode(FlightMode.GUIDED)
    assert bench.session.guard.released
    bench.exchange(bench.session.set_list(np.empty((0, 2)), 2.0, DATUM, bench.now))
    bench.exchange(bench.session.set_list(LINE, 3.0, DATUM, bench.now))
    assert bench.autopilot.mode is FlightMode.AUTO
    assert not bench.session.guard.released
    assert bench.session.problem(bench.now) == ""


def test_return_home_is_not_overridden_by_a_planner_that_goes_on(bench):
    bench.session.set_list(LINE, 1.0, DATUM, bench.now)  # the upload is under way
    bench.exchange(bench.session.return_home(bench.now))
    assert bench.autopilot.mode is FlightMode.RTL
    bench.exchange(bench.session.set_list(LINE, 2.0, DATUM, bench.now))
    bench.run(5.0)
    assert bench.autopilot.mode is FlightMode.RTL
    assert bench.autopilot.items == []


def test_lost_ack_of_auto_is_not_repeated_against_a_human(bench):
    messages = bench.session.set_list(LINE, 1.0, DATUM, bench.now)
    real, bench.server._set_mode = bench.server._set_mode, lambda _number: 4  # nothing happens
    bench.exchange(messages)
    bench.server._set_mode = real
    bench.mode(FlightMode.LOITER)
    assert bench.session.guard.released
    bench.run(8.0)
    assert bench.autopilot.mode is FlightMode.LOITER


def test_disengaging_withdraws_a_command_under_way(bench):
    bench.session.set_list(LINE, 1.0, DATUM, bench.now)
    bench.session._commands.send(Command(mavlink.MAV_CMD_DO_SET_MODE, (1.0, 10.0)), bench.now)
    bench.session.set_list(np.empty((0, 2)), 2.0, DATUM, bench.now)
    assert bench.session._commands.tick(bench.now + 50.0) == []


def test_telemetry_is_asked_for_again_when_it_stops(bench):
    def asked():
        return sum(n == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL for n in command_numbers(bench))

    before = asked()
    bench.run(5.0)
    assert asked() == before
    bench.session.state.position_s = -math.inf
    bench.server._next_position_s = math.inf  # the autopilot has forgotten its streams
    bench.run(5.0)
    assert asked() >= before + 6


def test_quadplanes_fly_arduplanes_modes():
    state = AutopilotState()
    state._vehicle = mavlink.MAV_TYPE_VTOL_TILTROTOR
    assert state.mode_number("RTL") == FlightMode.RTL


def test_list_given_before_the_autopilot_is_heard_goes_out_when_it_is():
    bench = Bench()
    assert bench.session.set_list(LINE, 1.0, DATUM, 0.0) == []
    assert bench.session.problem(0.0) == "no autopilot heard"
    bench.run(1.5)
    assert bench.autopilot.mode is FlightMode.AUTO


def test_only_the_configured_system_is_obeyed():
    bench = Bench(target_system=7)
    bench.run(2.0)
    assert bench.session.address is None


def test_another_system_is_not_listened_to(bench):
    intruder = mavlink.MAVLink(None, srcSystem=9, srcComponent=1)
    beat = mavlink.MAVLink_heartbeat_message(1, 3, 0, 11, 4, 3)
    for heard in bench.to_vehicle.parse_buffer(beat.pack(intruder)):
        assert bench.session.handle(heard, now_s=2.0, ros_s=2.0, datum=DATUM) == ([], False)
    assert bench.session.state.mode == "GUIDED"


def test_lost_link_is_a_problem(bench):
    assert bench.session.problem(bench.now + 5.0) == "autopilot's heartbeat lost"


def test_failed_upload_is_told_and_tried_again(bench):
    bench.session.set_list(LINE, 1.0, DATUM, bench.now)
    failed_at = bench.now
    while not bench.session.problem(failed_at).startswith("mission upload: no answer"):
        failed_at += 0.1
        bench.session.tick(failed_at)
        bench.session.state.heartbeat_s = failed_at
    bench.now = failed_at
    bench.run(3.0)
    assert bench.autopilot.mode is FlightMode.AUTO


def test_commands_are_repeated_and_given_up():
    queue = CommandQueue(Address(1, 1))
    (first,) = queue.send(Command(mavlink.MAV_CMD_DO_SET_MODE, (1.0, 10.0)), 0.0)
    assert (first.param2, first.confirmation) == (10.0, 0)
    times = [t for t in np.arange(0.1, 9.0, 0.1) if queue.tick(t)]
    assert times == pytest.approx([1.0, 2.0, 3.0, 4.0], abs=0.11)
    assert queue.refusal == "command 176: no answer after 4 retries"


def test_refused_command_is_named():
    queue = CommandQueue(Address(1, 1))
    queue.send(Command(mavlink.MAV_CMD_DO_SET_MODE), 0.0)
    queue.handle(mavlink.MAVLink_command_ack_message(176, mavlink.MAV_RESULT_IN_PROGRESS))
    assert queue.refusal == ""
    queue.handle(mavlink.MAVLink_command_ack_message(176, mavlink.MAV_RESULT_DENIED))
    assert queue.refusal == "command 176: MAV_RESULT_DENIED"
    assert queue.tick(50.0) == []


def test_boot_clock_takes_the_usual_delay_and_notices_a_reboot():
    clock = BootClock()
    rng = np.random.default_rng(1)
    stamps = [clock.stamp(10.0 + i, 1010.0 + i + 0.3 * rng.random()) for i in range(50)]
    assert stamps[-1] == pytest.approx(1059.15, abs=0.05)
    assert clock.stamp(0.5, 1070.0) == pytest.approx(1070.0)
    assert clock.reboots == 1
    assert clock.stamp(1.5, 2000.0) == pytest.approx(2000.0)  # the receiver's clock was stepped


def test_positions_that_are_none_are_not_used():
    state = AutopilotState()
    for latitude, longitude in ((0, 0), (2_000_000_000, 0)):
        message = mavlink.MAVLink_global_position_int_message(
            0, latitude, longitude, 0, 0, 0, 0, 0, 0
        )
        assert not state.handle(message, monotonic_s=0.0, ros_s=0.0, datum=DATUM)
    assert state.telemetry is None
    unknown = mavlink.MAVLink_global_position_int_message(
        0, 378000000, -1228000000, 0, 0, 0, 500, 0, 65535
    )
    assert state.handle(unknown, monotonic_s=0.0, ros_s=0.0, datum=DATUM)
    assert state.telemetry.yaw_rad == pytest.approx(0.0)
    assert math.isclose(state.telemetry.motion.vx_mps, 5.0)


def test_speed_is_asked_for_while_a_list_is_flown_and_not_too_often(bench):
    asked = bench.session.set_speed(21.0, bench.now)
    assert asked == []  # nothing is flown yet
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.run(2.0)
    bench.exchange(bench.session.set_speed(21.5, bench.now))
    assert bench.autopilot.airspeed_mps == pytest.approx(21.5)
    before = command_numbers(bench).count(mavlink.MAV_CMD_DO_CHANGE_SPEED)
    bench.exchange(bench.session.set_speed(21.6, bench.now))
    bench.exchange(bench.session.set_speed(19.0, bench.now))
    assert command_numbers(bench).count(mavlink.MAV_CMD_DO_CHANGE_SPEED) == before
    bench.run(1.5)  # the newest wish goes out when it may
    assert bench.autopilot.airspeed_mps == pytest.approx(19.0)


def test_speed_is_not_asked_for_once_a_human_has_taken_the_mode(bench):
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.run(2.0)
    bench.mode(FlightMode.LOITER)
    sent = command_numbers(bench).count(mavlink.MAV_CMD_DO_CHANGE_SPEED)
    bench.exchange(bench.session.set_speed(18.0, bench.now))
    bench.run(2.0)
    assert command_numbers(bench).count(mavlink.MAV_CMD_DO_CHANGE_SPEED) == sent


ARDUPLANE = Uav(autopilot="arduplane", roll_lag_s=0.35, l1_period_s=12.0)


def bench_place(bench):
    return np.array((bench.autopilot.state.x_m, bench.autopilot.state.y_m))


def kinds(bench, since=0):
    return [m.get_type() for m in bench.sent[since:]]


def test_list_in_flight_goes_into_a_bank_and_is_joined_without_beginning_a_leg_anew():
    bench = Bench(uav=ARDUPLANE)
    bench.run(1.5)
    line = np.column_stack((np.arange(200.0, 2000.0, 200.0), np.full(9, -250.0)))
    bench.exchange(bench.session.set_list(line, 1.0, DATUM, bench.now))
    bench.run(2.0)
    before, current = len(bench.sent), bench.autopilot.current
    bench.exchange(bench.session.set_list(line + np.array((50.0, 0.5)), 2.0, DATUM, bench.now))
    assert kinds(bench, before).count("MISSION_WRITE_PARTIAL_LIST") == 2
    assert "COMMAND_LONG" not in kinds(bench, before)
    assert "MISSION_COUNT" not in kinds(bench, before)
    assert bench.autopilot.current == current
    assert bench.session.accepted.list_id == 2
    bench.run(20.0)
    assert bench.autopilot.current > SLOT_ITEMS
    assert bench.autopilot.state.y_m == pytest.approx(-249.5, abs=0.3)


def test_list_that_leads_elsewhere_is_made_current():
    bench = Bench(uav=ARDUPLANE)
    bench.run(1.5)
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.run(2.0)
    turn = np.array([[250.0, -350.0], [250.0, -1000.0]])
    bench.exchange(bench.session.set_list(turn, 2.0, DATUM, bench.now))
    assert bench.autopilot.current == 1 + 2 * SLOT_ITEMS - CAPTURE_ITEMS
    assert command_numbers(bench)[-1] == mavlink.MAV_CMD_DO_SET_MISSION_CURRENT


@pytest.mark.parametrize("trip_s", [0.0, 0.05, 0.15])
def test_corrected_lists_in_a_turn_do_not_bend_the_uavs_way(trip_s):
    bench = Bench(uav=ARDUPLANE)
    bench.run(8.0)
    turn = np.linspace(-0.5 * math.pi, math.pi, 24)
    x = bench.autopilot.motion.x_m + 60.0
    circle = np.column_stack((x + 120.0 * np.cos(turn), -130.0 + 120.0 * np.sin(turn)))
    bench.exchange(bench.session.set_list(circle, 1.0, DATUM, bench.now))
    bench.run(6.0)
    bench.trip_s = trip_s
    rates = []
    for number in range(5):
        aside = np.array((3.0 * (-1) ** number, 0.0))
        told = circle[np.hypot(*(circle - bench_place(bench)).T).argmin() :] + aside
        bench.exchange(bench.session.set_list(told, 2.0 + number, DATUM, bench.now))
        for _ in range(10):
            bench.run(0.1)
            rates.append(bench.autopilot.state.turn_rate_radps)
    assert min(rates) > -0.1
    assert max(rates) < 0.4  # the limit is 0.6 rad/s


def test_list_that_comes_while_a_part_is_written_waits_for_it():
    bench = Bench()
    bench.run(1.5)
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.run(1.2)
    first = bench.session.set_list(LINE + 1.0, 2.0, DATUM, bench.now)
    assert [m.get_type() for m in first] == ["MISSION_WRITE_PARTIAL_LIST"]
    assert bench.session.set_list(LINE + 2.0, 3.0, DATUM, bench.now) == []
    bench.exchange(first)
    assert bench.session.accepted.list_id == 3
    assert bench.session.problem(bench.now) == ""


def test_part_that_is_refused_is_followed_by_the_whole():
    bench = Bench()
    bench.run(1.5)
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.run(1.2)
    bench.autopilot.truncate(2)
    before = len(bench.sent)
    bench.exchange(bench.session.set_list(LINE + 1.0, 2.0, DATUM, bench.now))
    assert "refused" in bench.session.problem(bench.now)
    bench.run(2.0)
    assert "MISSION_COUNT" in kinds(bench, before)
    assert bench.session.accepted.list_id == 2
    assert bench.session.problem(bench.now) == ""


def test_nothing_is_counted_on_after_a_reboot():
    bench = Bench()
    bench.run(6.0)
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    bench.server._next_position_s = 0.0
    bench.exchange(bench.hear(bench.server.telemetry(0.0)))
    assert bench.session.state.clock.reboots == 1
    before = len(bench.sent)
    bench.exchange(bench.session.set_list(LINE + 1.0, 2.0, DATUM, bench.now))
    assert "MISSION_COUNT" in kinds(bench, before)


def _place(item):
    return item.latitude_e7, item.longitude_e7


@pytest.mark.parametrize("partial", [False, True])
def test_an_autopilot_that_restarts_half_way_has_the_whole_list_at_last(partial):
    bench = Bench()
    bench.run(1.5)
    if partial:
        bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
        bench.run(1.2)
    bench.exchange(bench.session.set_list(LINE + 1.0, 2.0, DATUM, bench.now), rounds=3)
    assert bench.server.transferring(bench.now)
    bench.server.restart(bench.now)
    bench.run(12.0)
    assert bench.session.accepted.list_id == 2
    assert bench.session.problem(bench.now) == ""
    wanted = [_place(item) for item in waypoint_items(LINE + 1.0, DATUM, 150.0)[1:]]
    held = [_place(item) for item in bench.autopilot.items]
    assert any(held[at : at + len(wanted)] == wanted for at in range(len(held)))


def test_parameters_and_wind_are_learnt():
    bench = Bench(uav=ARDUPLANE, wind=Wind(6.0, 270.0))
    bench.run(3.0)
    assert bench.session.parameters_complete
    assert bench.session.parameters["NAVL1_PERIOD"] == 12.0
    assert bench.session.parameters["ROLL_LIMIT_DEG"] == 65.0
    assert bench.session.state.wind.vector_mps == pytest.approx((6.0, 0.0), abs=1e-4)


def test_an_autopilot_that_tells_no_parameters_is_not_asked_for_ever():
    bench = Bench()
    bench.run(20.0)
    assert bench.session.parameters_complete
    assert bench.session.parameters == {}
    before = len(bench.sent)
    bench.run(5.0)
    assert "PARAM_REQUEST_READ" not in kinds(bench, before)


def test_a_list_may_be_flown_higher(bench):
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    away = np.array([[500.0, -1500.0]])
    bench.exchange(bench.session.set_list(away, 2.0, DATUM, bench.now, climb_m=40.0))
    item = bench.autopilot.items[bench.autopilot.current]
    assert item.altitude_m == 190.0
    bench.run(20.0)
    assert bench.autopilot.motion.vy_mps < -15.0  # at once, not behind the old list's waypoint
    bench.exchange(bench.session.set_list(LINE, 3.0, DATUM, bench.now))
    assert bench.autopilot.items[bench.autopilot.current].altitude_m == 150.0


def heartbeats(bench, seconds):
    """Return how many heartbeats are sent in the seconds to come."""
    before = len(bench.sent)
    bench.run(seconds)
    return sum(message.get_type() == "HEARTBEAT" for message in bench.sent[before:])


def test_heartbeats_stop_while_a_list_is_flown_that_nobody_watches_over(bench):
    assert heartbeats(bench, 3.0) == 3
    bench.session.heartbeats.silent = "planner"
    assert heartbeats(bench, 3.0) == 3  # nothing is led: its failsafe is not ours to call
    bench.exchange(bench.session.set_list(LINE, 1.0, DATUM, bench.now))
    assert heartbeats(bench, 3.0) == 0
    assert bench.session.problem(bench.now) == (
        "no heartbeats to the autopilot: node planner is silent"
    )
    bench.session.heartbeats.silent = ""
    assert heartbeats(bench, 3.0) == 3
    bench.session.heartbeats.silent = "monitor"
    bench.mode(FlightMode.LOITER)  # a human took it
    assert bench.session.guard.released
    assert heartbeats(bench, 3.0) == 3
