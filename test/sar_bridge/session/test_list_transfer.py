"""Lists on their way to an autopilot that answers as it should: the newest wins."""

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.autopilot_state import AutopilotState
from sar_bridge.mavlink.commands import CommandQueue
from sar_bridge.mavlink.mission_upload import MissionUpload
from sar_bridge.session.list_transfer import ListTransfer, Wanted
from sar_estimator.common.geodesy import Datum

DATUM = Datum(37.8, -122.8)
LISTS = {
    number: np.array([[1000.0 * number, 0.0], [1000.0 * number, 500.0], [0.0, 500.0 * number]])
    for number in (1, 2, 3)
}


class Bench:
    """A transfer, and an autopilot that takes missions whole (not an ArduPilot)."""

    def __init__(self):
        state = AutopilotState()
        state.ardupilot = False
        self.transfer = ListTransfer(state, altitude_m=150.0)
        self.now, self.items, self.taken = 0.0, [], []
        self.target = Address(1, 1)

    def connect(self):
        upload, commands = MissionUpload(self.target), CommandQueue(self.target)
        return self.transfer.connect(upload, commands, self.now)

    def want(self, number):
        return self.transfer.want(Wanted(LISTS[number], number, DATUM), self.now)

    def answer(self, messages, *, until=60):
        """Answer messages, and what comes of the answers, as an autopilot does."""
        waiting = list(messages)
        while waiting and until:
            until -= 1
            self.now += 0.05
            sent = waiting.pop(0)
            kind = sent.get_type()
            if kind == "MISSION_COUNT":
                self.items, self.count = [], sent.count
                reply = mavlink.MAVLink_mission_request_int_message(255, 190, 0)
            elif kind == "MISSION_ITEM_INT":
                self.items.append(sent)
                if len(self.items) < self.count:
                    reply = mavlink.MAVLink_mission_request_int_message(255, 190, len(self.items))
                else:
                    reply = mavlink.MAVLink_mission_ack_message(
                        255, 190, mavlink.MAV_MISSION_ACCEPTED
                    )
            else:
                continue
            out, taken = self.transfer.handle(reply, {}, self.now)
            if taken:
                self.taken.append(self.transfer.accepted.list_id)
                out += self.transfer.start_later(self.now)
            waiting += out


def test_a_list_that_came_before_the_autopilot_is_uploaded_when_it_is_heard():
    bench = Bench()
    assert bench.want(1) == []
    bench.answer(bench.connect())
    assert bench.taken == [1]
    assert bench.transfer.accepted.items == 3
    assert bench.transfer.accepted.duration_s > 0.0


def test_of_lists_that_come_while_one_is_under_way_the_newest_follows():
    bench = Bench()
    bench.connect()
    first = bench.want(1)
    assert bench.want(2) == []
    assert bench.want(3) == []
    bench.answer(first)
    assert bench.taken == [1, 3]


def test_a_list_that_is_forgotten_is_broken_off():
    bench = Bench()
    bench.connect()
    first = bench.want(1)
    bench.transfer.forget()
    bench.answer(first)
    assert bench.taken == []
    assert bench.transfer.accepted is None
    assert bench.transfer.tick(bench.now + 100.0) == []


def test_a_list_that_failed_is_sent_again():
    bench = Bench()
    bench.connect()
    bench.want(1)
    again = []
    for second in range(60):
        again = bench.transfer.tick(float(second))
        if bench.transfer.failure:
            break
    assert bench.transfer.failure
    again = bench.transfer.tick(second + 2.0)
    assert [message.get_type() for message in again] == ["MISSION_COUNT"]
    bench.answer(again)
    assert bench.taken == [1]
    assert bench.transfer.failure == ""


@pytest.mark.parametrize("number", [1, 2, 3])
def test_items_carry_the_waypoints(number):
    bench = Bench()
    bench.connect()
    bench.answer(bench.want(number))
    places = [DATUM.to_local(item.x / 1e7, item.y / 1e7)[:2] for item in bench.items]
    assert np.array(places[:3]) == pytest.approx(LISTS[number], abs=0.02)
    assert places[3] == pytest.approx(LISTS[number][-1], abs=0.02)  # where it circles
