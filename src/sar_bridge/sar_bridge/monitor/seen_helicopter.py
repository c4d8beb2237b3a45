"""The helicopter as the monitor sees it: what it was told, and what follows at once."""

from __future__ import annotations

import math

from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase

SURE_COURSE_MPS = 3.0
HOVERS_S = 10.0
FRESH_LEG_S = 10.0
FRESH_CORNER_S = 5.0
SAME_STOP_M = 60.0
EXPECTED_SIGMA_MPS = 1.2
CONTRADICTION = 3.0
CONTRADICTED_LEG = 5.0


class SeenHelicopter:
    """The helicopter as last told of, and the course it had when it last moved.

    ``motion``, ``phase``, ``corner`` and ``leg`` are the estimator's newest. ``cruise_mps``: the
    speed it is expected to cruise at. ``position_sigma_m``, ``velocity_sigma_mps``: along one axis.
    ``sure``: motion and phase when it was seen last.
    """

    def __init__(self, model: HelicopterModel) -> None:
        """Know nothing yet."""
        self.model = model
        self.motion: Motion | None = None
        self.phase = Phase.LOST
        self._stopped_s = math.inf
        self.corner: CornerEstimate | None = None
        self.leg: LegEstimate | None = None
        self.position_sigma_m = 0.0
        self.velocity_sigma_mps = 0.0
        self._course_rad: float | None = None
        self.sure: tuple[Motion, Phase] | None = None
        self.cruise_mps = model.speed_mps

    def set_motion(
        self, motion: Motion, position_sigma_m: float = 0.0, velocity_sigma_mps: float = 0.0
    ) -> None:
        """Take its newest motion and the standard deviations of one axis."""
        if not motion.is_finite():
            return
        self.motion = motion
        if self.phase is not Phase.LOST:
            self.sure = motion, self.phase
        self.position_sigma_m = position_sigma_m
        self.velocity_sigma_mps = velocity_sigma_mps
        if motion.speed_mps > SURE_COURSE_MPS and self.phase is not Phase.STOPPED:
            self._course_rad = motion.course_rad

    def set_phase(self, phase: Phase) -> None:
        """Take its phase; who stands longer than in a corner hovers."""
        if phase is not Phase.STOPPED or self.motion is None:
            self._stopped_s = math.inf
        elif self.phase is not phase:
            self._stopped_s = self.motion.time_s
        self.phase = phase

    def set_leg(self, leg: LegEstimate) -> None:
        """Take the leg being flown; its speed is what the helicopter is expected to cruise at."""
        self.leg = leg
        if leg.speed_mps > SURE_COURSE_MPS and leg.speed_sigma_mps < EXPECTED_SIGMA_MPS:
            self.cruise_mps = leg.speed_mps

    # Where it is and how it goes on ------------------------------------------------------------

    @property
    def has_hovered(self) -> bool:
        """Whether it has stood for longer than in a corner, up to now."""
        return self.motion is not None and self.motion.time_s - self._stopped_s > HOVERS_S

    def velocity(self, motion: Motion) -> tuple[float, float, float]:
        """Return the velocity it goes on with, x and y, and its standard deviation [m/s].

        The better known of odometry and leg, weighed against what is expected after a corner.
        """
        vx, vy = motion.vx_mps, motion.vy_mps
        sigma = max(self.velocity_sigma_mps, 0.05)
        leg = self.leg
        if leg is not None and motion.time_s - leg.time_s < FRESH_LEG_S:
            spread = math.hypot(leg.speed_sigma_mps, leg.speed_mps * leg.heading_sigma_rad)
            lx = leg.speed_mps * math.cos(leg.foot.heading_rad)
            ly = leg.speed_mps * math.sin(leg.foot.heading_rad)
            same = math.hypot(lx - vx, ly - vy) < CONTRADICTED_LEG * math.hypot(sigma, spread)
            if same and spread < sigma:
                vx, vy, sigma = lx, ly, spread
        if self.corner is None:
            return vx, vy, sigma
        course = self.inside(self.corner).heading_rad
        ex, ey = self.cruise_mps * math.cos(course), self.cruise_mps * math.sin(course)
        if math.hypot(ex - vx, ey - vy) > CONTRADICTION * math.hypot(sigma, EXPECTED_SIGMA_MPS):
            return vx, vy, sigma
        weight = sigma**2 / (sigma**2 + EXPECTED_SIGMA_MPS**2)
        fused = sigma * math.sqrt(1.0 - weight)
        return vx + weight * (ex - vx), vy + weight * (ey - vy), fused

    def here(self, motion: Motion, ahead_s: float) -> Pose:
        """Return where it is now, heading as it last surely moved."""
        sure = motion.speed_mps > SURE_COURSE_MPS or self._course_rad is None
        return Pose(
            motion.x_m + motion.vx_mps * ahead_s,
            motion.y_m + motion.vy_mps * ahead_s,
            motion.course_rad if sure else float(self._course_rad or 0.0),
        )

    def inside(self, corner: CornerEstimate) -> Pose:
        """Return how a corner is left when it is turned to the pattern's side."""
        stop = corner.stop
        return Pose(stop.x_m, stop.y_m, stop.heading_rad + self.model.inside_rad)

    def this_corner(self, here: Pose, now_s: float) -> CornerEstimate | None:
        """Return the corner it slows or stands for; None where the last one told of is another."""
        corner = self.corner
        if corner is None or now_s - corner.time_s < FRESH_CORNER_S:
            return corner
        away = math.hypot(here.x_m - corner.stop.x_m, here.y_m - corner.stop.y_m)
        return corner if away < SAME_STOP_M else None
