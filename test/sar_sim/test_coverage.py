import math

import numpy as np
import pytest

from sar_sim.coverage import ideal_tracks, measure, swath

STRAIGHT = np.array([[0.0, 0.0], [1000.0, 0.0]])


def test_swath_areas_are_the_closed_forms():
    disc = swath(STRAIGHT, 100.0)
    assert disc.area == pytest.approx(200.0 * 1000.0 + math.pi * 100.0**2, rel=1e-3)
    square = swath(STRAIGHT, 100.0, footprint="square")
    assert square.area == pytest.approx(200.0 * 1200.0, rel=1e-6)


@pytest.mark.parametrize("footprint", ["disc", "square"])
def test_ideal_formation_covers_what_it_claims(footprint):
    corners = np.array([[0.0, 0.0], [0.0, 2000.0], [2000.0, 2000.0], [2000.0, 500.0]])
    ideal = ideal_tracks(corners, spacing_m=250.0, turn_side=1)
    found = measure(*ideal, ideal, radius_m=125.0, footprint=footprint)
    assert found.percent == pytest.approx(100.0, abs=1e-6)
    assert found.gaps.area == pytest.approx(0.0, abs=1.0)


@pytest.mark.parametrize("side", [1, -1])
def test_ideal_uav_flies_inside(side):
    corners = np.array([[0.0, 0.0], [0.0, 1000.0], [side * 1000.0, 1000.0]])
    _, uav = ideal_tracks(corners, spacing_m=250.0, turn_side=side)
    assert uav == pytest.approx(
        np.array([[side * 250.0, 0.0], [side * 250.0, 750.0], [side * 1000.0, 750.0]])
    )


def test_a_missing_uav_halves_the_coverage():
    ideal = (STRAIGHT, STRAIGHT - [0.0, 250.0])
    found = measure(STRAIGHT, STRAIGHT, ideal, radius_m=125.0, footprint="square")
    assert found.percent == pytest.approx(50.0, abs=0.1)
    assert found.overlap_percent == pytest.approx(50.0, abs=0.1)
    assert found.gaps.area == pytest.approx(found.claimed_m2 / 2, rel=1e-3)


def test_no_track_no_swath():
    with pytest.raises(ValueError, match="track of 1 points"):
        swath(STRAIGHT[:1], 100.0)


def test_pattern_that_crosses_itself_has_an_inner_track_in_parts():
    corners = np.array([(0, 0), (0, 900), (700, 900), (700, 300), (-600, 500), (-300, 1500)], float)
    tracks = ideal_tracks(corners, spacing_m=250.0, turn_side=1)
    assert len(tracks) >= 2
    assert all(track.shape[1] == 2 for track in tracks)
    found = measure(tracks[0], tracks[1], tracks, radius_m=125.0, footprint="disc")
    assert 50.0 < found.percent <= 100.0
