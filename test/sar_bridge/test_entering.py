"""Lists flown in advance: as the simulated ArduPlane flies them, and what is chosen by that."""

import numpy as np
import pytest

from sar_bridge.entering import LOOKED_AHEAD_S, STEP_S, Track
from sar_bridge.follower import FollowerTuning
from sar_bridge.mission_banks import MakeCurrent, MissionBanks, Write
from sar_bridge.mission_items import waypoint_items
from sar_estimator.geodesy import Datum
from sar_estimator.plane import Pose
from sar_estimator.states import Motion
from sar_sim.autopilot import FlightMode, SimAutopilot
from sar_sim.presets import parameter_values
from sar_sim.scenario import AUTOPILOTS, Uav

DATUM = Datum(37.8, -122.8)
UAV = Uav(autopilot="arduplane", **AUTOPILOTS["arduplane"])
TUNING = FollowerTuning.read(parameter_values(UAV))
HERE = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
STRAIGHT = np.column_stack((np.arange(60.0, 1000.0, 60.0), np.zeros(16)))
# A right turn as lists have it for this guidance: close together, inside of the way flown.
TURN = np.array(
    [[30.0, -4.0], [52.0, -12.0], [70.0, -26.0], [84.0, -44.0], [92.0, -66.0], [94.0, -90.0],
     [94.0, -150.0], [94.0, -300.0], [94.0, -600.0]]
)  # fmt: skip


def sim(points, first):
    """Return an autopilot that has flown ``STRAIGHT`` and is given item ``first`` of ``points``."""
    pilot = SimAutopilot(Pose(-200.0, 0.0, 0.0), speed_mps=20.0, uav=UAV, datum=DATUM)
    pilot.load(waypoint_items(STRAIGHT, DATUM, 150.0))
    pilot.set_current(1)
    pilot.set_mode(FlightMode.AUTO)
    while pilot.motion.x_m < 0.0 or pilot.current < 2:
        pilot.step(0.05)
    old = tuple(STRAIGHT[pilot.current - 1])
    begun = pilot.motion
    pilot.load(waypoint_items(points + np.array((begun.x_m, begun.y_m)), DATUM, 150.0))
    for seq in first:
        pilot.set_current(seq)
    return pilot, begun, old


def flown(pilot, seconds=LOOKED_AHEAD_S):
    out = []
    for _ in range(round(seconds / STEP_S)):
        pilot.step(0.05)
        pilot.step(0.05)
        out.append((pilot.motion.x_m, pilot.motion.y_m))
    return np.array(out)


@pytest.mark.parametrize("points", [TURN, TURN * (1.0, -1.0), STRAIGHT + np.array((0.0, 15.0))])
@pytest.mark.parametrize("seq", [1, 2, 4])
@pytest.mark.parametrize("twice", [False, True])
def test_what_is_made_current_is_flown_as_foretold(points, seq, twice):
    pilot, begun, old = sim(points, [seq, seq] if twice else [seq])
    track = flown(pilot)
    places = points + np.array((begun.x_m, begun.y_m))
    foretold = Track(places[seq - 1 :], begun, TUNING)
    index, apart_m = foretold.entry(old, tracked=not twice)
    assert apart_m >= 0.0
    if index == 0:
        wanted = float(np.hypot(*(track - foretold._wanted).T).max())
        assert apart_m == pytest.approx(wanted, abs=3.0)


def test_a_list_that_goes_straight_on_is_entered_at_its_begin():
    track = Track(STRAIGHT, HERE, TUNING)
    assert track.entry((60.0, 0.0), tracked=True) == (0, pytest.approx(0.0, abs=0.1))
    assert track.apart_m(STRAIGHT, (0.0, 0.0), frozenset()) == pytest.approx(0.0, abs=0.1)


def test_another_list_is_far_apart():
    track = Track(STRAIGHT, HERE, TUNING)
    assert track.apart_m(STRAIGHT * (-1.0, 1.0), (0.0, 0.0), frozenset()) > 100.0


def test_the_waypoint_chosen_is_flown_nearest_to_the_list():
    track = Track(TURN, HERE, TUNING)
    best, apart_m = track.entry((60.0, 0.0), tracked=True)
    direct = frozenset({1})
    others = [track.apart_m(TURN[i:], (0.0, 0.0), direct) for i in range(len(TURN) - 2)]
    assert apart_m <= min(others) + 1.0
    assert others[best] == pytest.approx(apart_m)


def test_a_jump_is_chosen_where_it_keeps_nearer_and_made_current_where_that_does():
    banks = MissionBanks(altitude_m=150.0)
    banks.whole(STRAIGHT, DATUM)
    start = banks.fill(STRAIGHT + np.array((30.0, 10.0)), DATUM, 1).start
    step = banks.join(1, HERE, within_s=0.5, tuning=TUNING)
    assert isinstance(step, Write)
    assert step.start == 2
    start = banks.fill(TURN, DATUM, 1).start
    step = banks.join(1, HERE, within_s=0.5, tuning=TUNING)
    assert isinstance(step, MakeCurrent)
    assert start <= step.seq < start + len(TURN)


def test_legs_after_one_made_current_are_known_not_to_be_tracked():
    banks = MissionBanks(altitude_m=150.0)
    banks.whole(STRAIGHT, DATUM)
    assert banks._made.next_tracked(1)
    assert banks._made.direct(1) == frozenset({0})
    start = banks.fill(TURN, DATUM, 2).start
    seq = banks.join(2, HERE, within_s=0.5, tuning=TUNING).seq
    assert seq >= start
    made = banks._made
    assert (made.seq, made.tracked) == (seq, True)
    assert not made.next_tracked(seq)
    assert made.direct(seq) == frozenset({1})
    assert made.direct(seq + 1) == frozenset({0})
    assert made.direct(seq + 2) == frozenset()
    banks.fill(TURN * (1.0, -1.0) + (0.0, 30.0), DATUM, seq)
    seq = banks.join(seq, HERE, within_s=0.5, tuning=TUNING).seq
    assert not banks._made.tracked
    assert banks._made.direct(seq) == frozenset({0, 1})
