"""A planner that leads a UAV about a mark, and what flies beside it."""

import math

import pytest

from sar_estimator.common.reports import UavStatus
from sar_estimator.common.states import LegEstimate, Motion, Phase
from sar_planner.mission_planner import MissionPlanner
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters

V, D = 20.0, 250.0
FLYING = UavStatus("AUTO", armed=True, connected=True, tracking_list=True)


class Bench:
    """A planner, a helicopter on its leg, and a UAV that flies its lists exactly."""

    def __init__(self, **parameters):
        self.plan = MissionPlanner(CornerParameters(), MissionParameters(**parameters))
        self.now = 0.0
        self.helicopter = Motion(0.0, 0.0, 0.0, V, 0.0)
        self.uav = Motion(0.0, 0.0, -D, V, 0.0)
        self.lists = []
        self.plan.set_status(FLYING)
        self.tell()

    def tell(self, phase=Phase.CRUISE):
        plan = self.plan
        plan.situation.set_phase(phase)
        plan.situation.set_helicopter(self.helicopter)
        plan.situation.set_uav(self.uav)
        plan.set_leg(LegEstimate(self.now, self.helicopter.pose, V, 1.0, 0.01, 0.1))

    def fly(self, seconds, *, step=0.5, phase=Phase.CRUISE, helicopter=None):
        """Fly on; both straight, the UAV along its orbit's path where it has one.

        ``helicopter``: its motion at a time, where it flies otherwise.
        """
        least = math.inf
        for _ in range(round(seconds / step)):
            self.now += step
            if helicopter is None:
                self.helicopter = self.helicopter.after(step)._replace(time_s=self.now)
            else:
                self.helicopter = helicopter(self.now)
            state = self.plan.find.orbit.state
            if state is not None and state.path is not None:
                pose = state.path.pose_at(state.flown_m + V * step)
                course = pose.heading_rad
                speeds = V * math.cos(course), V * math.sin(course)
                self.uav = Motion(self.now, pose.x_m, pose.y_m, *speeds)
            else:
                self.uav = self.uav.after(step)._replace(time_s=self.now)
            self.tell(phase)
            found = self.plan.update(self.now)
            if found is not None:
                self.lists.append(found)
            least = min(least, self.plan.situation.separation_m())
        return least


@pytest.fixture
def bench():
    bench = Bench()
    assert bench.plan.engage(0.0) == ""
    bench.fly(2.0)
    return bench


@pytest.fixture
def make_bench():
    return Bench
