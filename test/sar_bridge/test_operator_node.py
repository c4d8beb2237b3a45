"""What an operator may write, and what is asked for it."""

import pytest

from sar_bridge.operator_node import arguments


def asked(*words):
    request = arguments(list(words)).request
    values = [(one.name, one.value) for one in request.asked.parameters]
    return request.service, values


def test_a_slot_is_changed_in_one_piece():
    service, (side, tracks) = asked("--uav", "uav2", "slot", "outside", "2")
    assert service == "/uav2/planner/set_parameters_atomically"
    assert (side[0], side[1].string_value) == ("slot_side", "outside")
    assert (tracks[0], tracks[1].integer_value) == ("slot_tracks", 2)
    service, (side, tracks) = asked("slot", "left")
    assert service == "/planner/set_parameters_atomically"
    assert (side[1].string_value, tracks[1].integer_value) == ("left", 1)


def test_the_leg_that_is_flown_is_told():
    _, ((name, value),) = asked("leg", "3")
    assert (name, value.integer_value) == ("pattern_leg", 3)


@pytest.mark.parametrize(
    "words",
    [
        ["slot"],
        ["slot", "above"],
        ["slot", "left", "x"],
        ["slot", "left", "1", "2"],
        ["leg"],
        ["leg", "last"],
        ["engage", "outside"],
        ["dance"],
    ],
)
def test_what_makes_no_sense_is_refused(words, capsys):
    with pytest.raises(SystemExit) as ended:
        arguments(words)
    assert ended.value.code == 2
    assert "operator" in capsys.readouterr().err
