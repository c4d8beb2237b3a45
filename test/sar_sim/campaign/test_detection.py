import math

import numpy as np
import pytest

from sar_sim.campaign.detection import (
    corner_flight,
    matched,
    pilot_of,
    receiver_of,
    straight_flight,
)
from sar_sim.campaign.detection_cli import main
from sar_sim.scenario.scenario import Pattern, Pilot
from sar_sim.world.helicopter import PatternHelicopter


def test_what_is_seen_is_matched_with_the_corners():
    corners = PatternHelicopter(Pattern(corners=2), Pilot(), 20.0, 2.5).corners
    first, second = (corner.onset_time_s for corner in corners)
    delays, alarms = matched(corners, [first - 30.0, first + 2.0, first + 8.0])
    assert delays == pytest.approx([2.0, math.inf])
    assert alarms == 1
    assert matched(corners, [first + 1.0, second + 3.0]) == (pytest.approx([1.0, 3.0]), 0)


def test_delays_count_from_the_true_onset():
    seen = corner_flight(pilot_of("robot", 1), receiver_of("modern", 1))
    assert len(seen.delays_s) == 8
    assert all(0.0 < delay < 3.0 for delay in seen.delays_s)
    assert (seen.alarms, seen.withdrawn, seen.unled_s) == (0, 0, 0.0)


@pytest.mark.parametrize(
    ("doppler", "median_s", "late_s"),
    [(True, 2.0, 2.8), (False, 4.5, 6.0)],
    ids=["with", "without"],
)
@pytest.mark.parametrize("pilot", ["human", "rolled"])
def test_a_humans_corners_are_seen_soon(pilot, doppler, median_s, late_s):
    flights = [
        corner_flight(pilot_of(pilot, seed), receiver_of("modern", seed, doppler=doppler))
        for seed in range(4)
    ]
    delays = np.array([flight.delays_s for flight in flights])
    assert np.isfinite(delays).all()
    assert np.median(delays) <= median_s
    assert np.percentile(delays, 95) <= late_s
    assert sum(flight.unled_s for flight in flights) == 0.0


def test_a_human_who_flies_straight_on_is_believed():
    flown = straight_flight(pilot_of("human", 1), receiver_of("modern", 1), 1.0)
    assert (flown.alarms, flown.unled_s) == (0, 0.0)


def test_the_study_prints_its_table(capsys):
    options = ["--squares", "1", "--hours", "1", "--pilots", "human", "--receivers", "modern"]
    assert main([*options, "--jobs", "1"]) == 0
    head, row = capsys.readouterr().out.splitlines()
    assert head.split()[:3] == ["pilot", "receiver", "corners"]
    assert row.split()[:3] == ["human", "modern", "8"]
    assert row.split()[-3:-1] == ["0/1", "h"]
