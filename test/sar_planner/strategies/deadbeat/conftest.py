"""What an activity of the deadbeat strategy is given: a state, and a tick."""

import numpy as np
import pytest

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.guidance.path_efficiency import PathEfficiency
from sar_planner.guidance.turn_radius import Turns
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.patterns.legs import PatternTerms
from sar_planner.prediction.situation import Situation
from sar_planner.strategies.deadbeat.state import State, Tick

CORNER = CornerEstimate(104.0, Pose(80.0, 0.0, 0.0), 108.0, 20.0, 2.5, np.zeros((2, 2)), 0.0, 0.0)


def situation_of(*, helicopter, uav, leg_mps, corner, slot):
    """A helicopter on a leg east through the origin, at (0, 0) at t = 100 s."""
    known = Situation(CornerParameters(), PatternTerms(side=1), slot)
    known.set_helicopter(helicopter)
    known.set_uav(uav)
    known.set_phase(Phase.CRUISE)
    foot = Pose(helicopter.x_m, 0.0, 0.0)
    known.set_leg(LegEstimate(helicopter.time_s, foot, leg_mps, 0.5, 0.001, 0.02))
    if corner is not None:
        known.set_phase(Phase.DECELERATING)
        known.set_corner(corner)
    return known


@pytest.fixture
def tick_at():
    """Return what makes a tick: the UAV on its slot beside a helicopter on a leg, or otherwise."""

    def make(now_s=100.0, *, x=None, y=-250.0, vy=0.0, corner=None, leg_mps=20.0, **mission):
        east = 20.0 * (now_s - 100.0)
        motion = Motion(now_s, east, 0.0, leg_mps, 0.0)
        uav = Motion(now_s, east if x is None else x, y, 20.0, vy)
        settings = MissionParameters(**mission)
        known = situation_of(
            helicopter=motion, uav=uav, leg_mps=leg_mps, corner=corner, slot=settings.slot
        )
        return Tick(
            now_s,
            known,
            known.forecasts(now_s),
            CornerParameters(),
            settings,
            AirEnvelope(),
            Turns(CornerParameters().turn_radius_m),
        )

    return make


@pytest.fixture
def state():
    """Return a state on a leg."""
    return State(PathEfficiency(0.5), slot=Pose(0.0, -250.0, 0.0))


@pytest.fixture
def corner():
    """Return a corner 80 m after t = 100 s, seen 4 s later."""
    return CORNER
