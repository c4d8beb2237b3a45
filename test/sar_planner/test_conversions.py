"""What the planner publishes for RViz and Foxglove."""

import pytest

from sar_estimator.common.states import Motion
from sar_planner.conversions import TRACK_M, MarkerTracks, status_from_text
from sar_planner.mission_planner import MissionPlanner, UavStatus
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters


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


def test_status_of_an_older_bridge_has_no_airspeed_ratio():
    assert status_from_text('{"mode": "AUTO", "armed": true, "connected": true}') == UavStatus(
        "AUTO", armed=True, connected=True
    )


@pytest.mark.parametrize("ratio", ["0", "-1.0", "NaN", "3", '"one"', "null"])
def test_an_airspeed_ratio_that_cannot_be_is_refused(ratio):
    text = '{"mode": "AUTO", "armed": true, "connected": true, "airspeed_ratio": RATIO}'
    with pytest.raises(ValueError, match=r"airspeed_ratio 0\.5 to 2"):
        status_from_text(text.replace("RATIO", ratio))
