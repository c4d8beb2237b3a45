"""The tool: from a bag to a file, in one line; bad input in one line too."""

import json
from pathlib import Path

import gpxpy
import pytest

from sar_sim.export.export_cli import main
from sar_sim.export.flight_export import FORMATS

BAG = Path(__file__).parents[1] / "flight" / "bags" / "one_corner"


@pytest.mark.parametrize("name", FORMATS)
def test_a_recorded_flight_is_exported(name, tmp_path, capsys):
    out = tmp_path / f"flight.{name}"
    assert main([str(BAG), "--format", name, "--out", str(out)]) == 0
    assert capsys.readouterr().out == f"{out}\n"
    text = out.read_text("utf-8")
    if name == "gpx":
        assert len(gpxpy.parse(text).tracks) == 2
    elif name == "kml":
        assert "<kml" in text
    else:
        assert json.loads(text)


def test_what_is_no_bag_is_one_line(tmp_path, capsys):
    assert main([str(tmp_path / "nothing"), "--format", "gpx"]) == 2
    assert capsys.readouterr().err.startswith(f"export: {tmp_path / 'nothing'}: ")
