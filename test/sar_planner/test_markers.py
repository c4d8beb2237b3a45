"""What the planner shows in RViz and Foxglove."""

import numpy as np

from sar_estimator.common.states import Motion
from sar_planner.markers import KEPT_STRETCHES, STRETCH, TRACK_M, Markers, TrackMarker

NOTHING = np.empty((0, 2))


def shown(markers, time_s, x=0.0, plan=None, pattern=NOTHING):
    uav = Motion(time_s, x, 0.0, 5.0, 0.0)
    message = markers.message(
        time_s, helicopter=None, uav=uav, plan=plan, pattern=pattern, text="leg"
    )
    return {(marker.ns, marker.id): marker for marker in message.markers}


def test_a_track_is_drawn_coarsely_in_stretches_that_join():
    track, told = TrackMarker("uav"), {}
    for second in range(1000):
        track.add(Motion(second, 5.0 * second, 0.0, 5.0, 0.0))
        for marker in track.news(float(second)):
            told[marker.id] = [point.x for point in marker.points]
    xs = [x for number in sorted(told) for x in told[number]]
    assert sorted(set(xs)) == [TRACK_M * i for i in range(250)]
    assert [told[i][-1] for i in range(len(told) - 1)] == [
        told[i + 1][0] for i in range(len(told) - 1)
    ]
    assert max(len(points) for points in told.values()) == STRETCH + 1


def test_what_has_been_shown_is_not_sent_again():
    """An hour's flight is a few points a second, whatever was flown before."""
    markers, points = Markers(), 0
    plan = np.array([[0.0, 0.0], [100.0, 0.0]])
    for second in range(3600):
        found = shown(markers, float(second), x=20.0 * second, plan=plan)
        points += sum(len(marker.points) for marker in found.values())
    assert points / 3600 < STRETCH


def test_numbers_are_used_again_when_a_track_is_long():
    track, numbers = TrackMarker("uav"), set()
    for i in range(3 * KEPT_STRETCHES * STRETCH):
        track.add(Motion(float(i), TRACK_M * i, 0.0, 20.0, 0.0))
        numbers |= {marker.id for marker in track.news(float(i))}
    assert numbers == set(range(KEPT_STRETCHES))


def test_an_aircraft_never_seen_has_no_track_and_a_withdrawn_list_no_line():
    markers = Markers()
    plan = np.array([[0.0, 0.0], [100.0, 0.0]])
    first = shown(markers, 1.0, plan=plan)
    assert ("helicopter", 0) not in first
    assert len(first["plan", 0].points) == 2
    assert ("plan", 0) not in shown(markers, 2.0, plan=plan)
    assert len(shown(markers, 3.0, plan=None)["plan", 0].points) == 0


def test_the_pattern_ahead_is_a_thinner_line_and_sent_when_it_is_new():
    markers = Markers()
    pattern = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 50.0]])
    first = shown(markers, 1.0, plan=pattern[:2], pattern=pattern)
    assert len(first["pattern", 0].points) == 3
    assert first["pattern", 0].scale.x < first["plan", 0].scale.x
    assert ("pattern", 0) not in shown(markers, 2.0, plan=pattern[:2], pattern=pattern)
