"""The operator of a simulated flight: what he asks for when something is found. Pure."""

from __future__ import annotations

from sar_estimator.common import topics
from sar_sim.scenario.scenario import Find

AGAIN_S = 1.0


class Finder:
    """Says what a scenario's finds ask for, in order, each again until it is granted."""

    def __init__(self, finds: list[Find]) -> None:
        """Find nothing yet."""
        self._steps: list[tuple[float, str, Find]] = []
        for find in sorted(finds, key=lambda one: one.time_s):
            self._steps += [
                (find.time_s, topics.TARGET, find),
                (find.time_s, topics.ORBIT, find),
                (find.time_s + find.orbit_s, topics.RESUME, find),
            ]
        self._asked_s = -AGAIN_S

    def due(self, time_s: float) -> tuple[str, Find] | None:
        """Return what is due at a mission's time [s], once a second: the topic or service."""
        if not self._steps or time_s < self._steps[0][0] or time_s - self._asked_s < AGAIN_S:
            return None
        self._asked_s = time_s
        return self._steps[0][1:]

    def granted(self) -> None:
        """Go on to the next."""
        self._steps.pop(0)
