"""What a wind allows, as it is printed."""

import pytest

from sar_planner.cli.envelope import main


def lines_of(capsys, *arguments):
    assert main(list(arguments)) == 0
    return capsys.readouterr().out.splitlines()


def test_in_a_breeze_a_place_is_kept_on_all_courses(capsys):
    lines = lines_of(capsys, "--wind", "6,0")
    assert len(lines) == 1 + 8 + 1
    assert not any("not kept" in line for line in lines)
    # 10 + 6 and 30 - 6 m/s, and gusts of a tenth of the wind.
    assert lines[-1] == "kept on all courses, in gusts too: V from 16.6 to 23.4 m/s"


def test_in_a_strong_wind_it_says_where_it_is_lost(capsys):
    """12 m/s from the north: against it 18 m/s at most, with it 22 at least."""
    lines = lines_of(capsys, "--wind", "12,0", "--leg", "1000")
    assert [line[:3] for line in lines if "20 m/s not kept" in line] == ["000", "180"]
    north, south = lines[1].split(), lines[5].split()
    assert (float(north[3]), float(south[1])) == (18.0, 22.0)
    assert float(north[4]) < -100.0
    assert float(south[4]) > 100.0
    assert lines[-1].startswith("no V is kept on all courses in gusts: expected 23.2 m/s or more")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--wind", "6"], "'6': expected two numbers, A,B"),
        (["--wind", "-6,0"], "'-6,0': expected finite numbers, the first 0 or more"),
        (["--wind", "6,0", "--airspeed", "30,10"], "--airspeed (30.0, 10.0): expected"),
        (["--wind", "6,0", "--speed", "0"], "--speed 0.0: expected"),
        (["--wind", "6,0", "--leg", "nan"], "--leg nan: expected"),
    ],
)
def test_bad_input_is_told(capsys, arguments, message):
    with pytest.raises(SystemExit) as stop:
        main([arguments[0] + "=" + arguments[1], *arguments[2:]])
    assert stop.value.code == 2
    assert message in capsys.readouterr().err
