"""The operator of an offline flight: marks what is found, sends the UAV there and back. Pure."""

from __future__ import annotations

from collections.abc import Callable

from sar_estimator.common import topics
from sar_estimator.common.component import Answer, Outputs
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import Target
from sar_sim.scenario.scenario import Find

AGAIN_S = 1.0


class Finder:
    """Asks the planner's services for what a scenario's finds ask for, until it is granted."""

    def __init__(self, finds: list[Find], services: dict[str, Callable[[float], Answer]]) -> None:
        """Find nothing yet."""
        self._steps: list[tuple[float, str, Find]] = []
        for find in sorted(finds, key=lambda one: one.time_s):
            self._steps += [
                (find.time_s, topics.TARGET, find),
                (find.time_s, topics.ORBIT, find),
                (find.time_s + find.orbit_s, topics.RESUME, find),
            ]
        self._services = services
        self._asked_s = -AGAIN_S

    def due(self, time_s: float, now_s: float, place: Callable[[Find], Pose]) -> Outputs:
        """Return what comes of what is due at a mission's time [s]; ``now_s``: by its clock.

        ``place`` is asked where a find is when it is marked.
        """
        if not self._steps or time_s < self._steps[0][0] or time_s - self._asked_s < AGAIN_S:
            return []
        _, what, find = self._steps[0]
        self._asked_s = time_s
        if what == topics.TARGET:
            self._steps.pop(0)
            mark = place(find)
            return [(topics.TARGET, Target(now_s, mark.x_m, mark.y_m))]
        answer = self._services[what](now_s)
        if answer.success:
            self._steps.pop(0)
        return answer.outputs
