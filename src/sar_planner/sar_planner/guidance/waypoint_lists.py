"""Waypoint lists: along a path, and along the slot track, renewed when it is due."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.states import Motion
from sar_planner.guidance.l1_waypoints import Guide, L1Tuning, make_guide
from sar_planner.guidance.path_waypoints import path_waypoints, thinned
from sar_planner.guidance.wind_triangle import AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import FlightPath, FloatArray, Straight

Listed = tuple[str, FloatArray]
"""What a list is for, and its waypoints, shape (n, 2) [m] in the map."""
LEAST_GAP_M = 5.0
LOITER_AHEAD_M = 300.0
GUIDE_GAP_M = 10.0
SETTLING_L1 = 4.0
TOLERANCE_HALF_LIFE_M = 550.0
LEAST_TOLERANCE_SHARE = 0.3
FAR_M, FAR_SHARE = 500.0, 0.5
SAME_PATH_M = 50.0
SAME_HEADING_RAD = 1.0


@dataclass(frozen=True, slots=True)
class PathListing:
    """A path, in the map, that is to be listed.

    ``mode``: what it is for. ``speed_mps``: over ground. ``from_m``: where along it the UAV is.
    ``spacing_m``: between waypoints on arcs, None for the usual one.
    """

    mode: str
    path: FlightPath
    speed_mps: float
    from_m: float = 0.0
    spacing_m: float | None = None


@dataclass(frozen=True, slots=True)
class SlotListing:
    """A slot track that is to be listed, when that is due."""

    mode: str
    slot: Pose


@dataclass(frozen=True, slots=True)
class HoldListing:
    """A circle ahead of a pose that is to be listed."""

    mode: str
    pose: Pose


Listing = PathListing | SlotListing | HoldListing


class WaypointLists:
    """Makes lists for the autopilot that flies them, and knows which slot track was listed last.

    ``tuning``: of an L1-guided autopilot's guidance; None for one that flies the waypoints'
    polygon. ``air``: the UAV's airspeeds and the wind. ``side``: of the helicopter on which the UAV
    has its place, 1 right, -1 left.
    """

    def __init__(self, corner: CornerParameters, parameters: MissionParameters) -> None:
        """Nothing is listed yet."""
        self._p = parameters
        self.set_corner(corner)
        self.side: int = parameters.turn_side
        self.tuning: L1Tuning | None = None
        self.air = AirEnvelope()
        self._listed: Pose | None = None
        self._guide: Guide | None = None

    def set_corner(self, corner: CornerParameters) -> None:
        """Take how far away the slot is."""
        apart = corner.separation_m + self._p.loiter_radius_m + self._p.separation_margin_m
        self._aside_m = max(0.0, apart - corner.spacing_m)

    def make(self, listing: Listing, uav: Motion) -> Listed | None:
        """Return what is to be listed; None where a slot track's list is not due."""
        if isinstance(listing, SlotListing):
            points = self.track(listing.slot, uav)
            return None if points is None else (listing.mode, points)
        self.forget()
        if isinstance(listing, HoldListing):
            ahead = self.loiter(listing.pose, self._p.capture_m)
            return listing.mode, np.array([ahead])
        points = self.along(
            listing.path, listing.speed_mps, from_m=listing.from_m, spacing_m=listing.spacing_m
        )
        return listing.mode, points

    def forget(self) -> None:
        """Something else was listed since."""
        self._listed = None

    def loiter(self, track: Pose, along_m: float) -> tuple[float, float]:
        """Return where a list ends: ``along_m`` [m] down a slot track, away from the helicopter.

        A UAV that hears nothing more circles there, apart from a helicopter that flies on.
        """
        there = track.offset(along_m, -self.side * self._aside_m)
        return there.x_m, there.y_m

    def along(
        self,
        path: FlightPath,
        speed_mps: float,
        *,
        from_m: float = 0.0,
        spacing_m: float | None = None,
    ) -> FloatArray:
        """Return the waypoints of a path in the map, and of the track beyond.

        ``from_m``: distance along it [m] where the UAV is. ``speed_mps``: over ground. The first
        one is where the leg begins on which the UAV is then: the bridge leads it onto that leg.
        ``spacing_m``: between waypoints on arcs, None for the usual one.
        """
        from_m = min(from_m, path.length_m)
        beyond = path.end.offset(self._p.horizon_m)
        far = (beyond.x_m, beyond.y_m), self.loiter(path.end, self._p.horizon_m + LOITER_AHEAD_M)
        if self.tuning is None:
            begin = path.pose_at(from_m)
            points = path_waypoints(path, spacing_m or self._p.arc_spacing_m, from_m=from_m)
            return thinned(np.vstack(((begin.x_m, begin.y_m), points, *far)), LEAST_GAP_M)
        settling = Straight(SETTLING_L1 * self.tuning.l1_m(speed_mps))
        whole = path.then(FlightPath.of(path.end, (settling,)))
        offset = self._offset_at(path.start)
        self._guide = make_guide(whole, self.tuning, speed_mps, air=self.air, offset_m=offset)
        begin = self._guide.place_at(from_m)
        points = self._guide.waypoints(spacing_m or self._p.guide_spacing_m, from_m=from_m)
        return thinned(np.vstack(((begin.x_m, begin.y_m), points, *far)), GUIDE_GAP_M)

    def _offset_at(self, pose: Pose) -> float:
        """Return how far to the left of a new path's start the guide is that is flown now.

        0 where none is: a UAV that flies straight on is on its leg. The new guide goes on from
        there; one that began elsewhere would be a bend in the list that no path asks for.
        """
        if self._guide is None:
            return 0.0
        old = self._guide.path
        at = old.nearest_m(pose.x_m, pose.y_m, 0.0, old.length_m)
        there = old.pose_at(at)
        if abs(wrap_angle(there.heading_rad - pose.heading_rad)) > SAME_HEADING_RAD:
            return 0.0
        point = there.offset(0.0, self._guide.offset_at(at))
        off = pose.across(point.x_m, point.y_m)
        return off if abs(off) < SAME_PATH_M else 0.0

    def track(self, slot: Pose, uav: Motion) -> FloatArray | None:
        """Return the waypoints, shape (3, 2) [m], of a slot track's list that is due, or None.

        The line of a leg that a human flies is known the better the longer it is flown: what is
        tolerated of a shift grows less with what has been flown on the list.
        """
        here = slot.offset(slot.along(uav.x_m, uav.y_m))
        if self._listed is not None:
            far = here.offset(FAR_M)
            shift = max(
                abs(self._listed.across(here.x_m, here.y_m)),
                FAR_SHARE * abs(self._listed.across(far.x_m, far.y_m)),
            )
            flown = self._listed.along(uav.x_m, uav.y_m)
            left = 0.5 ** (max(flown, 0.0) / TOLERANCE_HALF_LIFE_M)
            tolerance = self._p.slot_tolerance_m * max(left, LEAST_TOLERANCE_SHARE)
            if shift < tolerance and flown < 0.6 * self._p.horizon_m:
                return None
        self._listed = here
        self._guide = None
        ahead = [here.offset(x) for x in (self._p.capture_m, self._p.horizon_m)]
        end = self.loiter(here, self._p.horizon_m + LOITER_AHEAD_M)
        return np.array([*((pose.x_m, pose.y_m) for pose in ahead), end])
