"""A path onto a slot while it is flown: how far it is, where and with what lag it will end.

Everything here is in the frame of the slot the path leads to (x along the slot track, the track
on y = 0).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from sar_estimator.common.pose import Pose, wrap_angle
from sar_planner.paths.flight_path import Arc, CornerFrame, FlightPath
from sar_planner.prediction.forecast import Forecast

BACK_M = 15.0
AHEAD_FACTOR = 1.5
ON_TRACK_M = 40.0
ON_HEADING_RAD = math.radians(25.0)
FRAME_SHIFT_M = 20.0
FRAME_TURN_RAD = math.radians(4.0)


@dataclass(frozen=True)
class TrackedPath:
    """A path, in the slot's frame, begun at ``begun_s`` and flown at ``speed_mps``.

    ``flown_m``: how far along it the UAV was when it was last looked at.
    """

    frame: CornerFrame
    path: FlightPath
    begun_s: float
    speed_mps: float
    flown_m: float = 0.0

    @property
    def is_flown(self) -> bool:
        """Whether the UAV is at the path's end."""
        return self.flown_m >= self.path.length_m - 1.0

    def followed(self, uav: Pose, moved_m: float) -> TrackedPath:
        """Return it once the UAV, in the frame, is at ``uav``.

        ``moved_m``: how far it can have flown since it was last looked at.
        """
        low, high = self.flown_m - BACK_M, self.flown_m + AHEAD_FACTOR * moved_m + BACK_M
        at = self.path.nearest_m(uav.x_m, uav.y_m, max(0.0, low), high)
        return TrackedPath(self.frame, self.path, self.begun_s, self.speed_mps, max(0.0, at))

    def timed(
        self,
        rest: FlightPath,
        forecast: Forecast,
        now_s: float,
        speeds_mps: tuple[float, float],
        share: float = 1.0,
    ) -> TrackedPath:
        """Return it at the speed with which the UAV arrives together with its slot.

        ``rest``: what is left of the path; ``speeds_mps``: the slowest and the fastest; ``share``:
        what of the speed is made good.
        """
        v = forecast.speed_mps
        left_s = forecast.zero_s - now_s + (rest.end.x_m - forecast.leg.x_m) / v
        wanted = rest.length_m / (left_s * share) if left_s > 1.0 else math.inf
        slowest, fastest = speeds_mps
        speed = min(max(wanted, slowest), fastest)
        begun = now_s - (self.path.length_m - rest.length_m) / speed
        return TrackedPath(self.frame, self.path, begun, speed, self.flown_m)

    def end_in(self, frame: CornerFrame) -> Pose:
        """Return where the path ends, in another slot's frame."""
        return frame.to_frame(self.frame.pose_to_map(self.path.end))

    def misses(self, frame: CornerFrame, left_m: float, far_tolerance: float) -> bool:
        """Whether the path's end is beside, or across, the slot track as it is known now.

        What is far off need not be met so well yet: a young leg's direction is not known well.
        """
        end = self.end_in(frame)
        shift = max(FRAME_SHIFT_M, far_tolerance * left_m)
        return abs(end.y_m) > shift or abs(end.heading_rad) > FRAME_TURN_RAD * shift / FRAME_SHIFT_M

    def carried_on(self, uav: Pose, to_m: float) -> Pose:
        """Return the pose of a UAV that flies on from ``uav`` as the path does, to ``to_m`` [m]."""
        there, then = (
            self.path.pose_at(min(at, self.path.length_m)) for at in (self.flown_m, to_m)
        )
        moved = uav.offset(there.along(then.x_m, then.y_m), there.across(then.x_m, then.y_m))
        turned = then.heading_rad - there.heading_rad
        return Pose(moved.x_m, moved.y_m, wrap_angle(uav.heading_rad + turned))


def is_on_track(pose: Pose) -> bool:
    """Whether a pose in a slot's frame is about on the slot track."""
    return abs(pose.y_m) < ON_TRACK_M and abs(pose.heading_rad) < ON_HEADING_RAD


def total_turn_rad(path: FlightPath) -> float:
    """Return the sum of all turns, whatever their side [rad]."""
    return math.fsum(abs(part.turn_rad) for part in path.segments if isinstance(part, Arc))


def final_lag_m(path: FlightPath, forecast: Forecast, *, start_s: float, speed_mps: float) -> float:
    """Return the lag on the slot [m] after a path begun at ``start_s``, at equal speeds then."""
    arrival_s = start_s + path.length_m / speed_mps
    return forecast.slot_x_m(arrival_s) - path.end.x_m
