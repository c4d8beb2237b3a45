"""Waypoint lists: a path onto the slot track, and the track itself, renewed when it is due."""

from __future__ import annotations

import numpy as np

from sar_estimator.plane import Pose
from sar_estimator.states import Motion
from sar_planner.geometry import FlightPath, FloatArray
from sar_planner.mission_parameters import MissionParameters
from sar_planner.waypoints import path_waypoints, thinned

Listed = tuple[str, FloatArray]
LEAST_GAP_M = 5.0


def path_list(
    path: FlightPath, parameters: MissionParameters, *, from_m: float = 0.0
) -> FloatArray:
    """Return the waypoints of a path in the map from ``from_m`` [m] on, and the track beyond."""
    points = path_waypoints(path, parameters.arc_spacing_m, from_m=from_m)
    beyond = path.end.offset(parameters.horizon_m)
    return thinned(np.vstack((points, (beyond.x_m, beyond.y_m))), LEAST_GAP_M)


class SlotTrack:
    """Knows which slot track was listed last."""

    def __init__(self, parameters: MissionParameters) -> None:
        """Nothing is listed yet."""
        self._p = parameters
        self._listed: Pose | None = None

    def forget(self) -> None:
        """Something else was listed since."""
        self._listed = None

    def points(self, slot: Pose, uav: Motion) -> FloatArray | None:
        """Return the waypoints, shape (2, 2) [m], of a list that is due; None when none is."""
        here = slot.offset(slot.along(uav.x_m, uav.y_m))
        if self._listed is not None:
            far = here.offset(1000.0)
            shift = max(
                abs(self._listed.across(here.x_m, here.y_m)),
                0.5 * abs(self._listed.across(far.x_m, far.y_m)),
            )
            left = self._p.horizon_m - self._listed.along(uav.x_m, uav.y_m)
            if shift < self._p.slot_tolerance_m and left > 0.4 * self._p.horizon_m:
                return None
        self._listed = here
        ahead = [here.offset(x) for x in (self._p.capture_m, self._p.horizon_m)]
        return np.array([(pose.x_m, pose.y_m) for pose in ahead])
