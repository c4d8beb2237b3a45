"""The operator of a flight whose helicopter is simulated, in the graph: marks, orbits, resumes."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node

from sar_estimator.common import topics
from sar_estimator.common.node_support import Persistent
from sar_sim.scenario.scenario import Find
from sar_sim.world.detour import found_beside
from sar_sim.world.finder import Finder
from sar_sim.world.helicopter import Helicopter

UNANSWERED_S = 5.0
"""What is granted must not be asked again: a second resume is refused."""


class FindCaller:
    """Does what a scenario's finds ask for, each again until it is granted."""

    def __init__(
        self,
        node: Node,
        finds: list[Find],
        helicopter: Helicopter | None,
        mark: Callable[[float, float], None],
        again_s: float,
        *,
        uav: str = "",
    ) -> None:
        """Find nothing yet; nothing at all where the helicopter is not simulated.

        ``mark``: tells of a place [m]. ``again_s``: between two requests, by a real clock. ``uav``:
        the name of the one that orbits.
        """
        self._uav = uav
        self._node, self._helicopter, self._mark = node, helicopter, mark
        self._finder = Finder(finds if helicopter is not None else [])
        self._again_s = again_s
        self._asking: Persistent | None = None

    def ask(self, time_s: float) -> None:
        """Do what is due at a mission's time [s]."""
        due = self._finder.due(time_s)
        if due is None:
            return
        what, find = due
        if what == topics.TARGET:
            assert self._helicopter is not None
            place = found_beside(self._helicopter, find)
            self._mark(place.x_m, place.y_m)
            self._finder.granted()
            return
        if self._asking is None:
            service = topics.name_of(topics.of_uav(what, self._uav))
            self._asking = Persistent(self._node, service, self._again_s, UNANSWERED_S)
        told = self._asking.ask()
        if told:
            self._node.get_logger().info(f"{what}: {told}")
        if self._asking.done:
            self._asking = None
            self._finder.granted()
