"""``enclosure`` as a user runs it."""

import math

import pytest

from sar_sim.trials.enclosure.corner_pieces import RULES
from sar_sim.trials.enclosure_cli import main, outwards


def test_a_table_is_printed_for_each_box(capsys):
    assert main(["--box", "0", "0.5", "--tolerance", "0.5"]) == 0
    first, second = capsys.readouterr().out.strip().split("\n\n")
    for text, percent in ((first, "+- 0 %"), (second, "+- 0.5 %")):
        lines = text.splitlines()
        assert percent in lines[0]
        assert [line.split()[0] for line in lines[2:6]] == [str(rule) for rule in RULES]
        assert lines[-1].endswith(" s")
        for line in lines[2:6]:
            low, high = (float(word) for word in line.split()[1:3])
            assert low <= high <= low + 0.5


def test_bounds_that_stay_apart_are_told(capsys):
    assert main(["--box", "1", "--tolerance", "0.01", "--boxes", "9"]) == 0
    assert "more than 0.01 m apart" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (["--speed", "nan"], "speed_mps"),
        (["--speed", "24"], "(12)"),
        (["--box", "100"], "box = 100.0: expected"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(options, what, capsys):
    assert main(options) == 2
    error = capsys.readouterr().err
    assert what in error
    assert error.count("\n") == 1


def test_a_tolerance_of_nothing_is_refused(capsys):
    with pytest.raises(SystemExit):
        main(["--tolerance", "0"])
    assert "--tolerance 0" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("bounds", "text"),
    [
        ((249.99999985, 250.0000001), "249.999 250.001"),
        ((-80.0004, -0.0001), "-80.001 -0.000"),
        ((17.25, 17.25), "17.250 17.250"),
        ((-math.inf, math.inf), "-Infinity Infinity"),
    ],
)
def test_bounds_are_not_rounded_inwards(bounds, text):
    assert " ".join(outwards(bounds).split()) == text
