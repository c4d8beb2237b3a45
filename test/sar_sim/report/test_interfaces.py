"""The page of interfaces is what nodes declare."""

from dataclasses import fields
from pathlib import Path

from sar_estimator.common.wires import WIRES
from sar_sim.report.interfaces import interfaces_text
from sar_sim.report.interfaces_cli import main
from sar_sim.report.parameter_page import NODES, parameters_text

PAGE = Path(__file__).parents[3] / "docs" / "interfaces.md"


def test_the_page_is_up_to_date(capsys):
    assert PAGE.read_text(encoding="utf-8") == interfaces_text()
    assert main([]) == 0
    assert capsys.readouterr().out == interfaces_text()


def test_the_page_of_parameters_is_up_to_date(capsys):
    assert PAGE.with_name("parameters.md").read_text(encoding="utf-8") == parameters_text()
    assert main(["--parameters"]) == 0
    assert capsys.readouterr().out == parameters_text()


def test_every_parameter_has_a_row_with_default_range_and_meaning():
    rows = [line.split(" | ") for line in parameters_text().splitlines() if line[:3] == "| `"]
    wanted = [item.name for kinds in NODES.values() for kind in kinds for item in fields(kind)]
    assert [name.strip("| `") for name, *_ in rows] == wanted
    assert all(len(row) == 4 and row[1].strip() and len(row[3]) > 4 for row in rows)
    assert "| `target_system` | 0 | 0 to 255 |" in parameters_text()


def test_every_topic_has_a_row_and_somebody_who_gives_it():
    rows = [line for line in interfaces_text().splitlines() if line.startswith("| ")][1:]
    assert len(rows) == len(WIRES)
    assert all(row.count("|") == 7 and "||" not in row for row in rows)
