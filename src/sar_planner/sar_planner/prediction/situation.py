"""What the planner has been told of the two aircraft: the newest of everything."""

from __future__ import annotations

import math

import numpy as np

from sar_estimator.common.other_uavs import OtherUav, OtherUavs
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import CornerEstimate, FloatArray, LegEstimate, Motion, Phase
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.patterns.ahead import corners_ahead
from sar_planner.patterns.legs import SQUARE, PatternTerms, inside_of
from sar_planner.patterns.progress import Progress
from sar_planner.patterns.slot import INSIDE, Slot
from sar_planner.prediction.corner_cost import CornerCost
from sar_planner.prediction.forecast import Forecast, along_lists
from sar_planner.prediction.helicopter_predictor import HelicopterPredictor
from sar_planner.prediction.turning import has_turned, surely_leaves

CLOCK_STEP_S = 1.0
SAME_CORNER_S = 10.0
STRAY_SIGMAS = 2.0
OTHERS_STALE_S = 15.0
HOVER_MPS, HOVERS_S = 5.0, 10.0


class Situation:
    """The newest of everything: motions, phase, leg, corner.

    ``corners_seen`` counts the corners told of. ``went_on``: the helicopter had slowed and sped
    up again without having stopped. ``slot``: the slot track of the leg flown last. ``strays_m``:
    by how much it may be beside where it is predicted: the newest leg's line is the less sure the
    more its pilot wanders. ``others``: UAVs that have the right of way, kept apart from unless
    ``layer_m`` of altitude does; ``altitude_m``: one's own.
    """

    def __init__(
        self,
        corner: CornerParameters,
        terms: PatternTerms = SQUARE,
        slot: Slot = INSIDE,
    ) -> None:
        """Know nothing yet."""
        self.corner = corner
        self.others, self.layer_m = OtherUavs(()), 0.0
        self.altitude_m = math.nan
        self.progress = Progress(terms, slot)
        self._turn_rad = self.progress.here.turn_rad
        self.helicopter: Motion | None = None
        self._velocity_sigma_mps = 0.0
        self.uav: Motion | None = None
        self.phase = Phase.LOST
        self._stopped_s = math.inf
        self.leg: LegEstimate | None = None
        self.estimate: CornerEstimate | None = None
        self.corners_seen = 0
        self.went_on = False
        self._is_predicted = False
        self._told: CornerEstimate | None = None
        self._cost = CornerCost()
        self.strays_m = 0.0

    # Events ------------------------------------------------------------------------------------

    def set_helicopter(self, motion: Motion, velocity_sigma_mps: float = 0.0) -> None:
        """Take the helicopter's newest motion; ``velocity_sigma_mps``: along one axis."""
        if motion.is_finite():
            self.helicopter, self._velocity_sigma_mps = motion, velocity_sigma_mps
            self.progress.see(motion.x_m, motion.y_m)

    def set_uav(self, motion: Motion) -> None:
        """Take the UAV's newest motion."""
        if motion.is_finite():
            self.uav = motion

    def set_leg(self, leg: LegEstimate) -> None:
        """Take the leg being flown; the first one after a corner tells what the corner cost."""
        if math.isfinite(leg.foot.x_m + leg.foot.y_m + leg.foot.heading_rad):
            self.leg = leg
            self.progress.fly(leg.foot)
            self.strays_m = leg.position_sigma_m
            if self._told is not None and not self.went_on:
                self._cost = self._cost.learnt(self.corners_seen, self._told, leg)

    def set_phase(self, phase: Phase) -> None:
        """Take the helicopter's phase."""
        if phase is Phase.DECELERATING and self.phase is not phase:
            self._is_predicted = False
        if self.phase is Phase.DECELERATING and phase in (Phase.CRUISE, Phase.ACCELERATING):
            self.went_on = not has_turned(self.helicopter, self.estimate)
        if phase is not Phase.STOPPED or self.helicopter is None:
            self._stopped_s = math.inf
        elif self.phase is not phase:
            self._stopped_s = self.helicopter.time_s
        self.phase = phase

    @property
    def has_left(self) -> bool:
        """Whether it is told to slow, but surely flies along the next leg already."""
        if self.phase is not Phase.DECELERATING or not self._is_predicted or self.went_on:
            return False
        sigma_mps = self._velocity_sigma_mps
        return surely_leaves(self.helicopter, self.estimate, self._turn_rad, sigma_mps)

    @property
    def slows(self) -> bool:
        """Whether it is taken to come to a stop at the corner."""
        return self.phase is Phase.DECELERATING and not self.has_left

    def set_corner(self, estimate: CornerEstimate) -> bool:
        """Take a prediction, or a refinement, of the corner ahead; return whether it is new.

        It may come before the phase that goes with it, or after it.
        """
        known = self._told
        if known is not None and estimate.time_s == known.time_s and not self.went_on:
            return False
        new = known is None or self.went_on or estimate.time_s < known.time_s - CLOCK_STEP_S
        if known is not None and estimate.onset_time_s > max(
            known.stop_time_s, known.time_s, known.onset_time_s + SAME_CORNER_S
        ):
            new = True
        if new:
            self.corners_seen += 1
            self._turn_rad = self.progress.here.turn_rad
            self.went_on = False
            if self.phase is not Phase.STOPPED:
                self.phase = Phase.DECELERATING
        self._is_predicted = True
        self._told = estimate
        motion = self.helicopter
        self.estimate = (
            estimate if motion is None else self._cost.expected(estimate, motion.speed_mps)
        )
        return new

    def set_clock_back(self) -> None:
        """Forget what belongs to a time that has not come yet."""
        self.estimate = self._told = self.helicopter = self.uav = self.leg = None

    @property
    def has_hovered(self) -> bool:
        """Whether the helicopter was told to stand for longer than in a corner, up to now."""
        seen = self.helicopter
        return seen is not None and seen.time_s - self._stopped_s > HOVERS_S

    @property
    def hovers(self) -> bool:
        """Whether it has hovered, and is not seen to leave."""
        seen = self.helicopter
        return seen is not None and self.has_hovered and seen.speed_mps < HOVER_MPS

    # Derived -----------------------------------------------------------------------------------

    def slot_of(self, leg: Pose) -> Pose:
        """Return the slot track beside a leg, where the UAV has its place."""
        return self.slot_frame(leg).origin

    def slot_frame(self, leg: Pose) -> CornerFrame:
        """Return the frame of the slot track beside a leg, the helicopter on y > 0."""
        across = self.progress.across(leg.heading_rad)
        slot = leg.offset(0.0, -across * self.corner.spacing_m)
        return CornerFrame(slot, 1 if across > 0.0 else -1)

    @property
    def places_m(self) -> tuple[float, float] | None:
        """The slot's distances before and after the corner ahead [m], inside of its turn positive.

        None where no corner is known.
        """
        stop = self.estimate
        if stop is None:
            return None
        heading, scale = stop.stop.heading_rad, self.turn_side * self.corner.spacing_m
        before, after = (self.progress.across(h) for h in (heading, heading + self._turn_rad))
        return before * scale, after * scale

    @property
    def turn_rad(self) -> float:
        """The turn that is expected at the corner ahead, left positive [rad]."""
        return self._turn_rad

    @property
    def turn_side(self) -> int:
        """To which side the corner ahead is expected to be turned, 1 right, -1 left."""
        return inside_of(self._turn_rad)

    @property
    def slot(self) -> Pose | None:
        """The slot track of the newest leg, abeam the helicopter's foot on it."""
        return None if self.leg is None else self.slot_of(self.leg.foot)

    def left_m(self, heading_rad: float) -> float:
        """Return how much is left of the leg of a heading [m]; 0 where its length is not known."""
        progress = self.progress
        leg = progress.leg_on(heading_rad)
        length_m = progress.terms.length_of(leg)
        begun, helicopter = progress.begun, self.helicopter
        if leg != progress.leg or begun is None or helicopter is None:
            return length_m
        return max(0.0, length_m - begun.along(helicopter.x_m, helicopter.y_m))

    @property
    def pattern_ahead(self) -> FloatArray:
        """The corners of the pattern that are still expected, shape (n, 2) [m]; none where unknown.

        The first is where the leg being flown ends. See ``corners_ahead``.
        """
        begun, leg, corner = self.progress.begun, self.leg, self.estimate
        if begun is None or leg is None:
            return np.empty((0, 2))
        is_ahead = corner is not None and not self.went_on and leg.time_s <= corner.stop_time_s
        return corners_ahead(
            self.progress.terms,
            self.progress.leg,
            begun,
            flown_m=begun.along(*leg.foot[:2]),
            stop_m=begun.along(*corner.stop[:2]) if is_ahead and corner is not None else None,
        )

    def margin_m(self, mission: MissionParameters) -> float:
        """Return what is planned beyond the least separation [m]: more behind one who wanders."""
        return max(mission.separation_margin_m, STRAY_SIGMAS * self.strays_m)

    def lag_m(self, slot: Pose | None) -> float | None:
        """Return how far the UAV is behind the helicopter along a slot track, or the leg's [m]."""
        slot = slot or self.slot
        if self.uav is None or self.helicopter is None or slot is None:
            return None
        ahead = slot.along(self.helicopter.x_m, self.helicopter.y_m)
        behind = slot.along(self.uav.x_m, self.uav.y_m)
        return ahead - behind - self.uav.speed_mps * (self.helicopter.time_s - self.uav.time_s)

    def separation_m(self) -> float | None:
        """Return the horizontal distance between the aircraft [m]."""
        if self.uav is None or self.helicopter is None:
            return None
        return math.hypot(self.uav.x_m - self.helicopter.x_m, self.uav.y_m - self.helicopter.y_m)

    def forecasts(self, now_s: float) -> tuple[Forecast, ...]:
        """Return the motion to come, and others that must be kept apart from too; or nothing.

        See ``HelicopterPredictor.forecasts``.
        """
        if self.helicopter is None:
            return ()
        helicopter = HelicopterPredictor(
            corner=self.corner,
            turn_rad=self._turn_rad,
            helicopter=self.helicopter,
            phase=Phase.ACCELERATING if self.has_left else self.phase,
            leg=self.leg,
            estimate=self.estimate,
            is_predicted=self._is_predicted,
            went_on=self.went_on,
        ).forecasts(now_s)
        return (*helicopter, *along_lists(self._near_others(now_s), now_s)) if helicopter else ()

    def is_shared(self, now_s: float) -> bool:
        """Whether UAVs that have the right of way are in this layer."""
        return bool(self._near_others(now_s))

    def _near_others(self, now_s: float) -> list[OtherUav]:
        return self.others.near(
            now_s, self.altitude_m, layer_m=self.layer_m, stale_s=OTHERS_STALE_S
        )
