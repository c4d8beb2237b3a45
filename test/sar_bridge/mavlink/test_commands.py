"""Commands are repeated until they are acknowledged, a kind at a time, and given up aloud."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.commands import RETRIES, TIMEOUT_S, Command, CommandQueue

MODE, SPEED = mavlink.MAV_CMD_DO_SET_MODE, mavlink.MAV_CMD_DO_CHANGE_SPEED


def ack(number, result=mavlink.MAV_RESULT_ACCEPTED):
    return mavlink.MAVLink_command_ack_message(number, result)


@pytest.fixture
def queue():
    return CommandQueue(Address(7, 1))


def test_a_command_is_sent_to_its_target_and_repeated_with_a_count(queue):
    (first,) = queue.send(Command(MODE, (1.0, 10.0)), 0.0)
    assert (first.target_system, first.command, first.confirmation) == (7, MODE, 0)
    assert (first.param2, first.param7) == (10.0, 0.0)
    assert queue.tick(TIMEOUT_S - 0.01) == []
    counts = [
        message.confirmation
        for i in range(1, RETRIES + 3)
        for message in queue.tick(i * (TIMEOUT_S + 0.01))
    ]
    assert counts == list(range(1, RETRIES + 1))
    assert queue.refusal == f"command {MODE}: no answer after {RETRIES} retries"


def test_an_acknowledged_command_is_not_repeated(queue):
    queue.send(Command(MODE), 0.0)
    queue.handle(ack(MODE))
    assert queue.tick(10.0) == []
    assert queue.refusal == ""


def test_one_in_progress_is_waited_for(queue):
    queue.send(Command(MODE), 0.0)
    queue.handle(ack(MODE, mavlink.MAV_RESULT_IN_PROGRESS))
    assert len(queue.tick(2.0)) == 1


@pytest.mark.parametrize(
    ("result", "text"), [(mavlink.MAV_RESULT_DENIED, "MAV_RESULT_DENIED"), (77, "77")]
)
def test_a_refusal_is_told(queue, result, text):
    queue.send(Command(MODE), 0.0)
    queue.handle(ack(MODE, result))
    assert queue.refusal == f"command {MODE}: {text}"


def test_a_newer_command_of_its_kind_replaces_the_older(queue):
    queue.send(Command(SPEED, (0.0, 20.0)), 0.0)
    queue.send(Command(SPEED, (0.0, 22.0)), 0.5)
    queue.send(Command(MODE), 0.5)
    repeated = queue.tick(2.0)
    assert [message.command for message in repeated] == [SPEED, MODE]
    assert repeated[0].param2 == 22.0
    queue.cancel(SPEED)
    assert [message.command for message in queue.tick(4.0)] == [MODE]
    queue.clear()
    assert queue.tick(6.0) == []


@given(st.lists(st.tuples(st.sampled_from([MODE, SPEED, 99]), st.integers(0, 6)), max_size=20))
def test_answers_to_what_was_not_asked_change_nothing(answers):
    queue = CommandQueue(Address(7, 1))
    for number, result in answers:
        queue.handle(ack(number, result))
    assert queue.refusal == ""
    assert queue.tick(100.0) == []
