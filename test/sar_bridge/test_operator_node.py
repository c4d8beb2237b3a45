"""What an operator may write, and what is asked for it."""

import pytest

from sar_bridge.operator_node import arguments, slot_change, trigger
from sar_bridge.services import SERVICES


@pytest.mark.parametrize("action", SERVICES)
@pytest.mark.parametrize("uav", ["", "uav2"])
def test_services_are_asked_of_the_uav_named(action, uav):
    prefix = f"/{uav}" if uav else ""
    assert trigger(action, uav).service == prefix + SERVICES[action]


def test_a_slot_is_changed_in_one_piece():
    request = slot_change("outside", 2, "uav2")
    assert request.service == "/uav2/planner/set_parameters_atomically"
    side, tracks = request.asked.parameters
    assert (side.name, side.value.string_value) == ("slot_side", "outside")
    assert (tracks.name, tracks.value.integer_value) == ("slot_tracks", 2)
    assert slot_change("left", 1, "").service == "/planner/set_parameters_atomically"


@pytest.mark.parametrize(
    "words", [["slot"], ["slot", "above"], ["engage", "outside"], ["dance"], ["slot", "left", "x"]]
)
def test_what_makes_no_sense_is_refused(words, capsys):
    with pytest.raises(SystemExit) as ended:
        arguments(words)
    assert ended.value.code == 2
    assert "operator" in capsys.readouterr().err


def test_a_slot_is_one_track_away_where_nothing_else_is_said():
    args = arguments(["--uav", "uav2", "slot", "right"])
    assert (args.uav, args.side, args.tracks) == ("uav2", "right", 1)
