"""Lists over a slow radio, on a simulated clock."""

import pytest

from sar_sim.trials.radio_cli import Bench, OneWay, main, measure


def test_sixty_waypoints_over_57600_baud_take_less_than_three_seconds():
    first, update = measure(60, 57600.0, 0.01, 0.02)
    assert update <= 3.0
    assert first < 10.0


def test_a_slower_radio_takes_longer():
    quick, slow = (measure(20, baud, 0.01, 0.02)[1] for baud in (115200.0, 19200.0))
    assert quick < slow < 10.0


def test_bytes_come_one_after_the_other_and_late():
    bench = Bench(57600.0, 0.05, 0.0)
    way = OneWay((1, 1), 1000.0, 0.05)
    beat = bench.session.tick(0.0)
    way.send([*beat, *beat], 0.0)
    size = len(beat[0].pack(way._mav)) / 100.0
    assert way.receive(size + 0.04) == []
    assert len(way.receive(size + 0.06)) == 1
    assert len(way.receive(2.0 * size + 0.06)) == 1


def test_command_line(capsys):
    assert main(["--items", "10"]) == 0
    assert "update in flight" in capsys.readouterr().out
    assert main(["--items", "64"]) == 2
    assert "expected --items 2 to 63" in capsys.readouterr().err


@pytest.mark.parametrize("latency", [0.0, 0.05])
def test_latency_counts_for_every_waypoint(latency):
    update = measure(30, 1e6, latency, 0.0)[1]
    assert update == pytest.approx(2.0 * latency * 32, abs=0.8)
