"""Logs at a pseudo-terminal: read, compared, told as a table."""

import json
from datetime import UTC, datetime

import pytest

from sar_estimator.common.gps_fix import Fix
from sar_sim.trials.receiver_logs import log_bytes
from sar_sim.trials.receiver_logs_cli import main
from sar_sim.trials.receiver_speech import ubx
from sar_sim.trials.receiver_terminal import by_port
from sar_sim.world.gps import Reception, Velocity

pytestmark = pytest.mark.timeout(60)
UTC_S, OFF_DEG = 1_795_000_000.0, 3e-5


@pytest.fixture
def log(tmp_path):
    """Write a log of ten epochs, and answers of which the fourth is elsewhere and slower."""
    data, reports = b"# somebody's\n", []
    for i in range(10):
        place = 37.8 + 1e-4 * i, -122.8
        data += ubx(Reception(Fix(float(i), *place, 5.0), Velocity(3.0, 4.0)), UTC_S + i, 1.0, 0.1)
        reports.append(
            {
                "class": "TPV",
                "mode": 3,
                "time": datetime.fromtimestamp(UTC_S + i, UTC).isoformat(),
                "lat": place[0] + (OFF_DEG if i == 3 else 0.0),
                "lon": place[1],
                "speed": 4.5 if i == 3 else 5.0,
            }
        )
    lines = (json.dumps(one, separators=(",", ":")) for one in reports)
    (tmp_path / "one.log").write_bytes(data)
    (tmp_path / "one.log.chk").write_text("\n".join(lines), encoding="utf-8")
    return tmp_path / "one.log"


def test_what_is_elsewhere_is_seen(log):
    assert not log_bytes(log).startswith(b"#")
    found = by_port(log)
    assert (found.fixes, found.compared, found.otherwise) == (10, 10, 0)
    assert found.worst_deg == pytest.approx(OFF_DEG, rel=0.01)
    assert found.worst_mps == pytest.approx(0.5, abs=0.01)


def test_the_table_has_a_row_for_each(log, capsys):
    assert main([str(log.parent), "--no-gpsd"]) == 0
    head, row = capsys.readouterr().out.splitlines()
    assert head.startswith("log")
    assert row.split()[:4] == ["one", "port", "10", "10"]


def test_a_folder_without_logs_is_one_line(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert capsys.readouterr().err == (
        f"receiver_logs: {tmp_path}: expected NAME.log and NAME.log.chk\n"
    )
