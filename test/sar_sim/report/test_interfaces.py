"""The page of interfaces is what nodes declare."""

from pathlib import Path

from sar_estimator.common.wires import WIRES
from sar_sim.report.interfaces import interfaces_text
from sar_sim.report.interfaces_cli import main

PAGE = Path(__file__).parents[3] / "docs" / "interfaces.md"


def test_the_page_is_up_to_date(capsys):
    assert PAGE.read_text(encoding="utf-8") == interfaces_text()
    assert main([]) == 0
    assert capsys.readouterr().out == interfaces_text()


def test_every_topic_has_a_row_and_somebody_who_gives_it():
    rows = [line for line in interfaces_text().splitlines() if line.startswith("| ")][1:]
    assert len(rows) == len(WIRES)
    assert all(row.count("|") == 7 and "||" not in row for row in rows)
