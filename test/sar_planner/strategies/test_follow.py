"""The planner that chases its slot point, to be compared with."""

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import UavStatus
from sar_estimator.common.states import LegEstimate, Motion, Phase
from sar_planner.mission_planner import MissionPlanner
from sar_planner.parameters.corner import CornerParameters, ParameterError
from sar_planner.parameters.mission import MissionParameters
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.follow import AHEAD_S, PERIOD_S

LEG = LegEstimate(10.0, Pose(0.0, 0.0, 0.0), 20.0, 1.0, 0.001, 0.1)


def engaged(helicopter, uav, turn_side=1):
    mission = MissionParameters(rules="follow", turn_side=turn_side)
    planner = MissionPlanner(CornerParameters(), mission)
    planner.set_status(UavStatus("AUTO", armed=True, connected=True))
    planner.situation.set_helicopter(helicopter)
    planner.situation.set_uav(uav)
    planner.situation.set_phase(Phase.CRUISE)
    planner.set_leg(LEG)
    assert planner.engage(10.0) == ""
    return planner


@pytest.mark.parametrize("side", [1, -1])
def test_a_list_every_second_ahead_of_the_slot_point(side):
    slot_y = -side * 250.0
    planner = engaged(
        Motion(10.0, 0.0, 0.0, 20.0, 0.0), Motion(10.0, -30.0, slot_y, 20.0, 0.0), side
    )
    made = [planner.update(10.0 + 0.1 * i) for i in range(21)]
    due = [i for i, listed in enumerate(made) if listed is not None]
    assert due == [0, round(PERIOD_S / 0.1), round(2.0 * PERIOD_S / 0.1)]
    first = made[0].points
    assert first[0] == pytest.approx((20.0 * AHEAD_S, slot_y))
    assert first[1, 0] > first[0, 0]
    assert planner.speed_mps == pytest.approx(22.0)  # 30 m behind: as fast as may be
    assert planner.mode is Mode.LEG
    assert planner.lag_m() == pytest.approx(30.0)


def test_while_the_helicopter_stands_the_slot_stays_where_it_was():
    planner = engaged(Motion(10.0, 0.0, 0.0, 0.0, 20.0), Motion(10.0, 250.0, 0.0, 0.0, 20.0))
    before = planner.update(10.0).points
    planner.situation.set_helicopter(Motion(12.0, 0.0, 0.0, 0.5, -0.3))
    planner.situation.set_uav(Motion(12.0, 250.0, 40.0, 0.0, 20.0))
    standing = planner.update(12.0).points
    assert np.hypot(*(standing - before).T).max() < 2.0
    assert planner.speed_mps == pytest.approx(18.0)


def test_a_helicopter_that_never_moved_has_no_slot():
    planner = engaged(Motion(10.0, 0.0, 0.0, 0.0, 0.0), Motion(10.0, 250.0, 0.0, 0.0, 20.0))
    assert planner.update(10.0) is None
    assert planner.problem == "helicopter's course not known: it stands"
    planner.set_clock_back()
    planner.disengage()
    assert planner.speed_mps is None


def test_an_unknown_planner_is_refused():
    with pytest.raises(ParameterError, match="rules = chase: expected one of deadbeat, paper, fol"):
        MissionPlanner(CornerParameters(), MissionParameters(rules="chase"))
