"""Lists flown in advance: as the simulated ArduPlane flies them, and what is chosen by that."""

import numpy as np
import pytest

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.arduplane.list_entry import entry_of
from sar_bridge.mavlink.mission_items import waypoint_items
from sar_bridge.mission.mission_slots import CaptureWaypoints, MissionSlots, Write
from sar_bridge.mission.transition_check import LOOKED_BEHIND_S, STEP_S, Track
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.autopilot.presets import parameter_values
from sar_sim.flight.upload import load_list
from sar_sim.scenario.presets import AUTOPILOTS
from sar_sim.scenario.scenario import Uav

DATUM = Datum(37.8, -122.8)
UAV = Uav(autopilot="arduplane", **AUTOPILOTS["arduplane"])
TUNING = FollowerTuning.read(parameter_values(UAV))
HERE = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
STRAIGHT = np.column_stack((np.arange(60.0, 1000.0, 60.0), np.zeros(16)))
# A right turn as lists have it for this guidance: close together, inside of the way flown.
TURN = np.array(
    [[0.0, -1.0], [15.8, -9.7], [36.0, -24.0], [51.5, -40.5], [62.5, -58.8], [68.8, -78.2],
     [70.2, -98.0], [66.9, -117.1], [59.0, -134.5], [47.1, -149.2], [31.8, -160.2], [12.0, -179.3]]
)  # fmt: skip
ASIDE = np.vstack(((0.0, 15.0), STRAIGHT + np.array((0.0, 15.0))))


def flying():
    """Return an autopilot on the first list, ``STRAIGHT``, and the slots that hold it."""
    pilot = SimAutopilot(Pose(-200.0, 0.0, 0.0), speed_mps=20.0, uav=UAV, datum=DATUM)
    slots = MissionSlots(altitude_m=150.0)
    load_list(pilot, slots, STRAIGHT, DATUM)
    while pilot.motion.x_m < 0.0 or pilot.current < 2:
        pilot.step(0.05)
    return pilot, slots


def flown(pilot, seconds=LOOKED_BEHIND_S):
    out = []
    for _ in range(round(seconds / STEP_S)):
        pilot.step(0.05)
        pilot.step(0.05)
        out.append((pilot.motion.x_m, pilot.motion.y_m))
    return np.array(out)


@pytest.mark.parametrize("points", [TURN, TURN * (1.0, -1.0), ASIDE, TURN[2:] - TURN[2]])
@pytest.mark.parametrize("again", [False, True])
def test_a_list_is_flown_leg_by_leg_from_where_it_is_entered(points, again):
    """Run-ins lead onto the leg itself: no leg is begun where the UAV is, or only headed for."""
    pilot, slots = flying()
    here = pilot.motion
    places = points + np.array((here.x_m, here.y_m))
    entry = entry_of(places, here)
    predicted = Track(places[entry.at :], entry.begin, here, TUNING, until_m=0.0)
    for _ in range(1 + again):
        load_list(pilot, slots, places, DATUM)
    assert np.hypot(*(flown(pilot) - predicted.flown).T).max() < 8.0


def test_without_a_run_in_a_turn_is_flown_far_aside():
    """What capture waypoints are for: an item of the list that is simply made current."""
    pilot, _ = flying()
    here = pilot.motion
    places = TURN + np.array((here.x_m, here.y_m))
    entry = entry_of(places, here)
    predicted = Track(places[entry.at :], entry.begin, here, TUNING, until_m=0.0)
    pilot.load(waypoint_items(places, DATUM, 150.0))
    pilot.set_current(1 + entry.at)
    pilot.set_current(1 + entry.at)
    assert np.hypot(*(flown(pilot) - predicted.flown).T).max() > 15.0


def test_a_list_flown_alike_is_not_apart_and_another_is():
    track = Track(STRAIGHT, (0.0, 0.0), HERE, TUNING, until_m=0.0)
    assert track.apart_m(STRAIGHT, (0.0, 0.0)) == pytest.approx(0.0, abs=1e-9)
    assert track.apart_m(STRAIGHT * (-1.0, 1.0), (0.0, 0.0)) > 100.0


def test_a_jump_is_chosen_where_it_keeps_to_the_list_and_a_run_in_elsewhere():
    pilot, slots = flying()
    here = np.array((pilot.motion.x_m, pilot.motion.y_m))
    args = {"within_s": 0.5, "tuning": TUNING}
    slots.fill(STRAIGHT + here * (1.0, 0.0) + np.array((5.0, 1.0)), DATUM, pilot.current)
    step = slots.join(pilot.current, pilot.motion, DATUM, **args)
    assert isinstance(step, Write)
    assert not isinstance(step, CaptureWaypoints)
    assert step.start == pilot.current + 1
    slots.fill(TURN + here, DATUM, pilot.current)
    assert isinstance(slots.join(pilot.current, pilot.motion, DATUM, **args), CaptureWaypoints)


def test_a_jump_behind_a_far_waypoint_that_lies_beyond_the_new_lists_turn_is_not_chosen():
    """The last list's turn was predicted farther out: joined there, the UAV would turn too late."""
    pilot, slots = flying()
    here = np.array((pilot.motion.x_m, pilot.motion.y_m))
    turn = TURN + here + np.array((220.0, 0.0))
    load_list(pilot, slots, np.vstack((here, turn)), DATUM)
    for _ in range(20):
        pilot.step(0.05)
    at = np.array((pilot.motion.x_m, pilot.motion.y_m))
    for sooner_m, is_jump in ((37.0, False), (0.0, True)):
        slots.fill(np.vstack((at, turn - (sooner_m, 0.0))), DATUM, pilot.current)
        step = slots.join(pilot.current, pilot.motion, DATUM, within_s=0.5, tuning=TUNING)
        assert isinstance(step, CaptureWaypoints) is not is_jump
