import math

import numpy as np
import pytest

from sar_sim.report.coverage import PIECE_POINTS, IdealSlot, ideal_tracks, measure, swath

STRAIGHT = np.array([[0.0, 0.0], [1000.0, 0.0]])


def test_swath_areas_are_the_closed_forms():
    disc = swath(STRAIGHT, 100.0)
    assert disc.area == pytest.approx(200.0 * 1000.0 + math.pi * 100.0**2, rel=1e-3)
    square = swath(STRAIGHT, 100.0, footprint="square")
    assert square.area == pytest.approx(200.0 * 1200.0, rel=1e-6)


@pytest.mark.parametrize("footprint", ["disc", "square"])
def test_ideal_formation_covers_what_it_claims(footprint):
    corners = np.array([[0.0, 0.0], [0.0, 2000.0], [2000.0, 2000.0], [2000.0, 500.0]])
    ideal = ideal_tracks(corners, [IdealSlot([250.0] * (len(corners) - 1))])
    found = measure(ideal[0], ideal[1:], ideal, radius_m=125.0, footprint=footprint)
    assert found.percent == pytest.approx(100.0, abs=1e-6)
    assert found.gaps.area == pytest.approx(0.0, abs=1.0)


@pytest.mark.parametrize("side", [1, -1])
def test_ideal_uav_flies_inside(side):
    corners = np.array([[0.0, 0.0], [0.0, 1000.0], [side * 1000.0, 1000.0]])
    _, uav = ideal_tracks(corners, [IdealSlot([side * 250.0] * (len(corners) - 1))])
    assert uav == pytest.approx(
        np.array([[side * 250.0, 0.0], [side * 250.0, 750.0], [side * 1000.0, 750.0]])
    )


def test_a_missing_uav_halves_the_coverage():
    ideal = (STRAIGHT, STRAIGHT - [0.0, 250.0])
    found = measure(STRAIGHT, [STRAIGHT], ideal, radius_m=125.0, footprint="square")
    assert found.percent == pytest.approx(50.0, abs=0.1)
    assert found.overlap_percent == pytest.approx(50.0, abs=0.1)
    assert found.gaps.area == pytest.approx(found.claimed_m2 / 2, rel=1e-3)


def test_a_long_track_is_swept_as_in_one_piece():
    turns = np.linspace(0.0, 40.0 * math.pi, 20 * PIECE_POINTS + 1)
    track = 500.0 * np.column_stack((np.cos(turns), np.sin(turns)))
    ring = math.pi * (600.0**2 - 400.0**2)
    assert swath(track, 100.0).area == pytest.approx(ring, rel=1e-3)
    assert swath(track[: PIECE_POINTS + 2], 100.0).area == pytest.approx(
        swath(track[: PIECE_POINTS + 1], 100.0).area, rel=0.01
    )


def test_no_track_no_swath():
    with pytest.raises(ValueError, match="track of 1 points"):
        swath(STRAIGHT[:1], 100.0)


def expanding_square(first_m, spacing_m, corners):
    """Return start, corners and end of a square that turns right."""
    points, length = [np.zeros(2)], first_m
    for leg in range(corners + 1):
        heading = math.pi / 2.0 - leg * math.pi / 2.0
        way = np.array((math.cos(heading), math.sin(heading)))
        points.append(points[-1] + length * way)
        length += 2.0 * spacing_m * (leg % 2)
    return np.array(points)


def test_strips_of_an_expanding_square_lie_side_by_side():
    """Of both aircraft, and of neighbouring rounds: what is claimed is the sum of the strips."""
    points = expanding_square(1500.0, 250.0, 12)
    helicopter, uav = ideal_tracks(points, [IdealSlot([250.0] * (len(points) - 1))])
    assert len(uav) == len(points)
    # Legs at right angles to those of the helicopter, shorter by d at either corner.
    legs = np.hypot(*np.diff(uav, axis=0).T)
    wanted = np.hypot(*np.diff(points, axis=0).T) - 500.0
    wanted[[0, -1]] += 250.0
    assert legs == pytest.approx(wanted)
    found = measure(helicopter, [uav], (helicopter, uav), radius_m=125.0, footprint="disc")
    assert found.percent == pytest.approx(100.0, abs=1e-6)
    strips = 250.0 * (np.hypot(*np.diff(points, axis=0).T).sum() + legs.sum())
    assert found.claimed_m2 == pytest.approx(strips, rel=0.01)


def test_a_pattern_that_crosses_itself_and_stops_twice_has_an_inner_track():
    corners = np.array(
        [(0, 0), (0, 900), (0, 900), (700, 900), (700, 300), (-600, 500), (-300, 1500)], float
    )
    tracks = ideal_tracks(corners, [IdealSlot([250.0] * (len(corners) - 1))])
    assert [track.shape for track in tracks] == [(6, 2), (6, 2)]
    assert np.isfinite(tracks[1]).all()
    found = measure(tracks[0], tracks[1:], tracks, radius_m=125.0, footprint="disc")
    assert found.percent == pytest.approx(100.0, abs=1e-6)


def test_a_way_back_has_no_endless_mitre():
    there_and_back = np.array([(0.0, 0.0), (1000.0, 0.0), (0.0, 10.0)])
    _, uav = ideal_tracks(there_and_back, [IdealSlot([250.0] * (len(there_and_back) - 1))])
    assert np.abs(uav).max() < 4000.0


def test_beside_legs_that_lead_back_and_forth_it_flies_round_a_u_turn():
    """North, east, south: inside, beyond the cross leg, and beside the tracks to come."""
    corners = np.array([[0.0, 0.0], [0.0, 4000.0], [500.0, 4000.0], [500.0, 0.0]])
    _, uav = ideal_tracks(corners, [IdealSlot([250.0, -350.0, -250.0])])
    expected = [[250, 0], [250, 4350], [750, 4350], [750, 0]]
    assert uav == pytest.approx(np.array(expected, dtype=float))


def test_three_aircraft_see_what_they_claim_and_none_of_it_twice():
    corners = np.array([[0.0, 0.0], [0.0, 3000.0], [3000.0, 3000.0]])
    ideal = ideal_tracks(corners, [IdealSlot([250.0] * 2), IdealSlot([-250.0] * 2)])
    assert len(ideal) == 3
    found = measure(ideal[0], ideal[1:], ideal, radius_m=125.0, footprint="square")
    assert found.percent == pytest.approx(100.0, abs=1e-6)
    assert found.overlap_percent < 2.0
