import json

import numpy as np
import pytest

from sar_planner.cli.corner import main


def run(capsys, *arguments):
    code = main(list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_json_of_a_fixed_curve(capsys):
    code, out, _ = run(capsys, "--rules", "paper", "--lag", "480", "--json")
    values = json.loads(out)
    assert code == 0
    assert values["rule"] == "T2"
    assert values["next_lag_m"] == pytest.approx(458.2006, abs=1e-3)
    assert values["closest_approach_m"] == pytest.approx(23.85, abs=0.01)
    path = np.array(values["path"])
    assert np.hypot(*np.diff(path, axis=0).T).max() <= 5.0
    assert path[0] == pytest.approx((-560.0, -250.0))
    assert path[-1][0] == pytest.approx(-250.0)
    assert sum(part["length_m"] for part in values["segments"]) == pytest.approx(values["length_m"])


def test_what_is_sure_in_the_tube_is_told(capsys):
    _, out, _ = run(capsys, "--lag", "300", "--lead", "60", "--json")
    values = json.loads(out)
    assert 120.0 < values["sure_m"] < values["closest_approach_m"]
    assert 15.0 < values["sure_until_s"] < 20.0
    _, out, _ = run(capsys, "--lag", "300", "--lead", "60")
    assert f"sure in its tube  {values['sure_m']:.1f} m until" in out


def test_left_over_options_reach_the_parameters(capsys, tmp_path):
    params = tmp_path / "corner.yaml"
    params.write_text("convergence: 0.25\n", encoding="utf-8")
    _, out, _ = run(capsys, "--rules", "paper", "--lag", "20", "--json", "--params", str(params))
    assert json.loads(out)["next_lag_m"] == pytest.approx(5.0)
    _, out, _ = run(capsys, "--rules", "paper", "--lag", "20", "--json", "--convergence", "0.75")
    assert json.loads(out)["next_lag_m"] == pytest.approx(15.0)


def test_a_rule_can_be_forced(capsys):
    _, out, _ = run(capsys, "--lag", "-78", "--rule", "T4", "--json")
    assert json.loads(out)["rule"] == "T4"
    assert json.loads(out)["closest_approach_m"] == pytest.approx(15.826, abs=1e-3)


def test_text_and_graph(capsys):
    code, out, _ = run(capsys, "--rules", "paper", "--lag", "0", "--graph")
    assert code == 0
    assert "T4 -> T1" in out
    assert "T3 (convergent)" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--lag", "0", "--separation", "260"), "min_separation_m = 260.0: expected less than"),
        (
            ("--lag", "0", "--rules", "paper", "--accel", "1"),
            "accel_mps2 = 1.0: expected more than",
        ),
        (("--lag", "nan"), "lag nan: expected a finite number"),
        (("--lag", "0", "--params", "/nowhere.yaml"), "/nowhere.yaml"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(capsys, arguments, message):
    code, _, err = run(capsys, *arguments)
    assert code == 2
    assert err.startswith("corner: ")
    assert message in err
    assert err.count("\n") == 1


def test_unknown_parameter_is_named(capsys, tmp_path):
    params = tmp_path / "corner.yaml"
    params.write_text("sped_mps: 20\n", encoding="utf-8")
    code, _, err = run(capsys, "--lag", "0", "--params", str(params))
    assert code == 2
    assert "corner.yaml: sped_mps: unknown" in err


def test_neither_lag_nor_graph_is_refused():
    with pytest.raises(SystemExit) as stop:
        main([])
    assert stop.value.code == 2


@pytest.mark.parametrize(("side", "rule"), [("outside", "O1"), ("over", "O3")])
def test_the_outside_rules_are_printed(side, rule, capsys):
    assert main(["--side", side, "--lag", "0", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["rule"] == rule
    assert found["closest_approach_m"] >= 200.0
    assert main(["--side", side, "--graph"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 1 + 33
    assert lines[9].split()[:2] == ["0", rule]


def test_a_turn_of_another_angle_on_the_inside(capsys):
    assert main(["--turn", "120", "--lag", "100", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["rule"], found["next_lag_m"]) == ("D4", pytest.approx(0.0, abs=0.5))
    assert found["closest_approach_m"] >= 200.0


@pytest.mark.parametrize(
    ("pattern", "side", "corners", "kinds"),
    [
        ("expanding_square", "inside", ["D4"] * 6, 1),
        ("sector", "outside", ["O1"] * 6, 1),
        ("parallel_track", "inside", ["O3", "O1"] * 3, 2),
        ("creeping_line", "left", ["O1", "O1", "D4", "D4", "O1", "O1"], 2),
        ("track_line_return", "inside", ["O3", "O1"], 2),
    ],
)
def test_the_corners_of_a_pattern_are_printed(pattern, side, corners, kinds, capsys):
    """The rule of each for a slot; with --graph, a table for each kind of corner."""
    assert main(["--pattern", pattern, "--side", side]) == 0
    lines = capsys.readouterr().out.splitlines()[1:]
    assert [line.split(": ")[1].split()[0] for line in lines] == corners
    assert main(["--pattern", pattern, "--side", side, "--graph"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1 + len(corners) + kinds * 34


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--side", "right", "--lag", "0"], "--side right: expected with --pattern"),
        (["--side", "over", "--pattern", "sector"], "--side over: expected without --pattern"),
    ],
)
def test_what_does_not_go_together_is_refused(arguments, message, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert message in capsys.readouterr().err


def test_a_turn_without_an_outside_is_refused(capsys):
    assert main(["--side", "outside", "--turn", "170", "--lag", "0"]) == 2
    assert "turn of 170 degrees" in capsys.readouterr().err


def test_a_corner_in_wind_is_planned_with_what_can_be_made_good_in_it(capsys):
    def flown(*options):
        code, out, _ = run(capsys, "--lag", "0", "--lead", "80", *options)
        assert code == 0
        lines = out.splitlines()
        share = float(lines[1].split(",")[1].split()[0])
        return lines[0], share, float(lines[2].split()[2]), float(lines[3].split()[2])

    _, share, next_lag_m, apart_m = flown("--wind", "0,0")
    assert share == 100.0
    assert abs(next_lag_m) < 0.1
    assert apart_m > 200.0
    name, share, next_lag_m, apart_m = flown("--wind", "10,45")
    assert name == "wind 10 m/s from 045, old leg on course 000, airspeed 10 to 30 m/s"
    assert 85.0 < share < 100.0
    assert abs(next_lag_m) < 15.0
    assert apart_m > 190.0
    same = flown("--wind", "10,135", "--course", "90")
    assert same[1:] == (share, next_lag_m, apart_m)


@pytest.mark.parametrize(
    ("options", "error"),
    [
        (("--wind", "10,45", "--side", "outside"), "--wind: expected with the deadbeat rules"),
        (("--wind", "10,45", "--json"), "--wind: expected with the deadbeat rules"),
        (("--wind", "ten"), "'ten': expected two numbers, A,B"),
        (("--wind", "10,45", "--airspeed", "30,10"), "expected MIN less than MAX"),
    ],
)
def test_a_wind_that_cannot_be_shown_is_refused(capsys, options, error):
    with pytest.raises(SystemExit) as ended:
        main(["--lag", "0", *options])
    assert ended.value.code == 2
    assert error in capsys.readouterr().err
