"""What the planner publishes for RViz and Foxglove."""

from sar_estimator.states import Motion
from sar_planner.messages import TRACK_M, MarkerTracks
from sar_planner.mission import MissionPlanner
from sar_planner.mission_parameters import MissionParameters
from sar_planner.parameters import CornerParameters


def shown(tracks):
    message = tracks.message(MissionPlanner(CornerParameters(), MissionParameters()), 3.0)
    return {marker.ns: marker for marker in message.markers}


def test_a_track_is_drawn_coarsely_and_forgets_its_beginning():
    tracks = MarkerTracks(keep=100)
    for second in range(1000):
        tracks.add("uav", Motion(second, 5.0 * second, 0.0, 5.0, 0.0))
    points = shown(tracks)["uav"].points
    assert len(points) == 100
    assert points[-1].x == 4980.0
    assert points[-1].x - points[-2].x == TRACK_M


def test_an_aircraft_never_seen_has_no_track():
    tracks = MarkerTracks()
    tracks.add("helicopter", None)
    assert shown(tracks)["helicopter"].points == []
