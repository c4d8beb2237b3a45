"""What the planner has been told of the two aircraft, and the helicopter's motion to come."""

from __future__ import annotations

import math
from dataclasses import replace

from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.flight_path import CornerFrame
from sar_planner.prediction.forecast import Forecast, Stretch, cornering, cruising, departing

CLOCK_STEP_S = 1.0
STANDING_S = 600.0
SURE_BEARING_M = 25.0
SURE_ASIDE_M = 18.0
TURNED_OTHERWISE_RAD = math.radians(20.0)
MOVING_MPS = 3.0
EXPECTED_SPEED_SIGMA_MPS = 0.7
EXPECTED_HEADING_SIGMA_RAD = math.radians(2.0)
EXPECTED_LINE_SIGMA_M = 4.0
CONTRADICTION = 3.0
UNSEEN_S = 5.0
SEEN_LATE_S = 2.0
SAME_CORNER_S = 10.0
LEAST_TURN_RAD = math.radians(40.0)
LEARNT_SIGMA_MPS = 0.6
LOST_S = (0.0, 25.0)
LOST_GAIN = 0.5
LEAST_LOST_S = 0.5
ROLLED_SHARE = 0.85
SLOW_SHARE = 0.4
STRAY_SIGMAS = 2.0
LEAST_LEAVING_SHARE = 0.9


def _passed_s(corner: CornerEstimate) -> float:
    """Return when the helicopter would have passed a corner's stop at cruise [s]."""
    return corner.stop_time_s - 0.5 * corner.speed_mps / corner.accel_mps2


def _weighed(value: float, sigma: float, expected: float, expected_sigma: float) -> float:
    """Return the inverse-variance mean of a measurement and of what was expected."""
    weight = expected_sigma**2 / (expected_sigma**2 + sigma**2)
    return expected + weight * (value - expected)


class Situation:
    """The newest of everything: motions, phase, leg, corner.

    ``corners_seen`` counts the corners told of. ``went_on``: the helicopter had slowed and sped
    up again without having stopped. ``slot``: the slot track of the leg flown last. ``strays_m``:
    by how much it may be beside where it is foretold: the newest leg's line is the less sure the
    more its pilot wanders.
    """

    def __init__(self, corner: CornerParameters, turn_side: int) -> None:
        """Know nothing yet."""
        self._corner = corner
        self._side = turn_side
        self.helicopter: Motion | None = None
        self.uav: Motion | None = None
        self.phase = Phase.LOST
        self.leg: LegEstimate | None = None
        self.estimate: CornerEstimate | None = None
        self.corners_seen = 0
        self.went_on = False
        self._foretold = False
        self._told: CornerEstimate | None = None
        self._lost_s: float | None = None
        self.strays_m = 0.0
        self._learnt = 0

    # Events ------------------------------------------------------------------------------------

    def set_helicopter(self, motion: Motion) -> None:
        """Take the helicopter's newest motion."""
        if motion.is_finite():
            self.helicopter = motion

    def set_uav(self, motion: Motion) -> None:
        """Take the UAV's newest motion."""
        if motion.is_finite():
            self.uav = motion

    def set_leg(self, leg: LegEstimate) -> None:
        """Take the leg being flown; the first one after a corner tells what the corner cost."""
        if math.isfinite(leg.foot.x_m + leg.foot.y_m + leg.foot.heading_rad):
            self.leg = leg
            self.strays_m = leg.position_sigma_m
            self._learn_lost(leg)

    def _learn_lost(self, leg: LegEstimate) -> None:
        """Learn what a corner costs of time, once its new leg is known."""
        corner = self._told
        if corner is None or self.went_on or self._learnt == self.corners_seen:
            return
        turned = wrap_angle(leg.foot.heading_rad - corner.stop.heading_rad)
        if abs(turned) < LEAST_TURN_RAD or leg.speed_mps < MOVING_MPS:
            return
        if leg.speed_sigma_mps > LEARNT_SIGMA_MPS or leg.time_s < corner.stop_time_s:
            return
        self._learnt = self.corners_seen
        away = -leg.foot.along(corner.stop.x_m, corner.stop.y_m)
        lost_s = leg.time_s - away / leg.speed_mps - _passed_s(corner)
        if not LOST_S[0] <= lost_s <= LOST_S[1]:
            return
        known = self._lost_s
        self._lost_s = lost_s if known is None else known + LOST_GAIN * (lost_s - known)

    def set_phase(self, phase: Phase) -> None:
        """Take the helicopter's phase."""
        if phase is Phase.DECELERATING and self.phase is not phase:
            self._foretold = False
        if self.phase is Phase.DECELERATING and phase in (Phase.CRUISE, Phase.ACCELERATING):
            self.went_on = not self._has_turned
        self.phase = phase

    @property
    def _has_turned(self) -> bool:
        """Whether the helicopter flies elsewhere than before the corner: it was rolled."""
        if self.helicopter is None or self.estimate is None:
            return False
        turned = wrap_angle(self.helicopter.course_rad - self.estimate.stop.heading_rad)
        return self.helicopter.speed_mps > MOVING_MPS and abs(turned) > LEAST_TURN_RAD

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
            self.went_on = False
            if self.phase is not Phase.STOPPED:
                self.phase = Phase.DECELERATING
        self._foretold = True
        self._told = estimate
        self.estimate = self._expected(estimate)
        return new

    def _expected(self, estimate: CornerEstimate) -> CornerEstimate:
        """Return a corner as it will be flown by a pilot who has not stopped at the last ones.

        A corner that is rolled costs less time than the stop that its beginning looks like: it is
        planned as a stop, at the same place, that costs as much as the last ones did, until he is
        too slow for that.
        """
        lost_s = self._lost_s
        if lost_s is None or self.helicopter is None:
            return estimate
        rolled = lost_s < ROLLED_SHARE * estimate.speed_mps / estimate.accel_mps2
        slow = self.helicopter.speed_mps < SLOW_SHARE * estimate.speed_mps
        if not rolled or slow:
            return estimate
        accel = estimate.speed_mps / max(lost_s, LEAST_LOST_S)
        stop_s = _passed_s(estimate) + 0.5 * estimate.speed_mps / accel
        return replace(estimate, accel_mps2=accel, stop_time_s=stop_s)

    def set_clock_back(self) -> None:
        """Forget what belongs to a time that has not come yet."""
        self.estimate = self._told = self.helicopter = self.uav = self.leg = None

    # Derived -----------------------------------------------------------------------------------

    def slot_of(self, leg: Pose) -> Pose:
        """Return the slot track beside a leg: d to its inside."""
        return leg.offset(0.0, -self._side * self._corner.spacing_m)

    def slot_frame(self, leg: Pose) -> CornerFrame:
        """Return the frame of the slot track beside a leg, the helicopter on y = d."""
        return CornerFrame(self.slot_of(leg), self._side)

    @property
    def slot(self) -> Pose | None:
        """The slot track of the newest leg, abeam the helicopter's foot on it."""
        return None if self.leg is None else self.slot_of(self.leg.foot)

    def margin_m(self, mission: MissionParameters) -> float:
        """Return what is planned beyond the least separation [m]: more behind one who wanders."""
        return max(mission.separation_margin_m, STRAY_SIGMAS * self.strays_m)

    def separation_m(self) -> float | None:
        """Return the horizontal distance between the aircraft [m]."""
        if self.uav is None or self.helicopter is None:
            return None
        return math.hypot(self.uav.x_m - self.helicopter.x_m, self.uav.y_m - self.helicopter.y_m)

    def forecasts(self, now_s: float) -> tuple[Forecast, ...]:
        """Return the motion to come, and others that must be kept apart from too; or nothing.

        On a leg it goes on, or stops at once. Slowing, it will turn by a right angle to the
        pattern's side, as soon as the corner is foretold. Standing, it has departed as recently as
        would not be seen yet, or stands on. Speeding up, it goes where it is going. Nothing where
        the leg is not known.
        """
        if self.helicopter is None or self.phase is Phase.LOST:
            return ()
        handler = {
            Phase.CRUISE: self._cruise,
            Phase.DECELERATING: self._decelerating,
            Phase.STOPPED: self._stopped,
            Phase.ACCELERATING: self._accelerating,
        }[self.phase]
        return handler(self.helicopter, now_s)

    def _cruise(self, helicopter: Motion, now_s: float) -> tuple[Forecast, ...]:
        leg = self.leg
        if leg is None or abs(wrap_angle(helicopter.course_rad - leg.foot.heading_rad)) > 1.0:
            return ()
        line, speed = self._believed(leg)
        estimate = self.estimate
        along = line.along(helicopter.x_m, helicopter.y_m)
        along += speed * (now_s - helicopter.time_s)
        here = line.offset(along)
        accel = self._corner.accel_mps2 if estimate is None else estimate.accel_mps2
        slowing = Stretch(now_s, here, speed, -accel)
        stand = Stretch(now_s + speed / accel, here.offset(speed**2 / (2.0 * accel)), 0.0)
        stopping = Forecast((slowing, stand), here, now_s + STANDING_S, speed)
        return cruising(now_s, here, speed), stopping

    def _believed(self, leg: LegEstimate) -> tuple[Pose, float]:
        """Return the leg's line and speed: a young leg is weighed against what was expected.

        Expected are the speed of the leg before (or the nominal one), and a line through the last
        stop at a right angle, unless the leg contradicts it. Inverse-variance weights.
        """
        estimate = self.estimate
        expected = self._corner.speed_mps if estimate is None else estimate.speed_mps
        speed = _weighed(leg.speed_mps, leg.speed_sigma_mps, expected, EXPECTED_SPEED_SIGMA_MPS)
        if estimate is None or self.went_on or leg.time_s < estimate.stop_time_s:
            return leg.foot, speed
        heading = self._right_angle(estimate.stop).heading_rad
        turned = wrap_angle(leg.foot.heading_rad - heading)
        spread = math.hypot(leg.heading_sigma_rad, EXPECTED_HEADING_SIGMA_RAD)
        if abs(turned) > CONTRADICTION * spread:
            return leg.foot, speed
        off = -leg.foot.across(estimate.stop.x_m, estimate.stop.y_m)
        away = leg.foot.along(estimate.stop.x_m, estimate.stop.y_m)
        # Both lines are compared abeam the leg's foot.
        off_here = off + away * math.sin(turned)
        off_sigma = math.hypot(EXPECTED_LINE_SIGMA_M, away * EXPECTED_HEADING_SIGMA_RAD)
        left = _weighed(0.0, leg.position_sigma_m, -off_here, off_sigma)
        turn = _weighed(turned, leg.heading_sigma_rad, 0.0, EXPECTED_HEADING_SIGMA_RAD)
        moved = leg.foot.offset(0.0, left)
        return Pose(moved.x_m, moved.y_m, heading + turn), speed

    def _decelerating(self, helicopter: Motion, now_s: float) -> tuple[Forecast, ...]:
        estimate = self.estimate
        if estimate is None or self.went_on or not self._foretold:
            return self._cruise(helicopter, now_s)
        return (
            cornering(
                estimate.onset_time_s,
                estimate.stop,
                speed_mps=estimate.speed_mps,
                accel_mps2=estimate.accel_mps2,
                turn_rad=-self._side * math.pi / 2.0,
                leaving_mps2=self._leaving_mps2(estimate),
            ),
        )

    def _stopped(self, _helicopter: Motion, now_s: float) -> tuple[Forecast, ...]:
        estimate = self.estimate
        if estimate is None or self.went_on:
            return ()
        out = self._right_angle(estimate.stop)
        leave_s = max(now_s - UNSEEN_S, estimate.stop_time_s)
        accel = self._leaving_mps2(estimate)
        leaving = departing(leave_s, out, 0.0, speed_mps=estimate.speed_mps, accel_mps2=accel)
        standing = Forecast(
            (Stretch(now_s, out, 0.0),), out, leave_s + STANDING_S, estimate.speed_mps
        )
        return leaving, standing

    def _accelerating(self, helicopter: Motion, now_s: float) -> tuple[Forecast, ...]:
        estimate = self.estimate
        if estimate is None or self.went_on:
            speed = self._corner.speed_mps if self.leg is None else self.leg.speed_mps
            if self.leg is None and helicopter.speed_mps < MOVING_MPS:
                return ()
            turned = self.leg is None or (
                helicopter.speed_mps > MOVING_MPS
                and abs(wrap_angle(helicopter.course_rad - self.leg.foot.heading_rad))
                > TURNED_OTHERWISE_RAD
            )
            line = helicopter.pose if turned or self.leg is None else self.leg.foot
            accel = self._corner.accel_mps2
        else:
            line, speed = self._way_out(helicopter), estimate.speed_mps
            accel = self._leaving_mps2(estimate)
        along = line.along(helicopter.x_m, helicopter.y_m)
        forward = (
            max(0.0, helicopter.speed_mps * math.cos(helicopter.course_rad - line.heading_rad))
            if helicopter.speed_mps > 0.5
            else 0.0
        )
        start = line.offset(along + forward * (now_s - helicopter.time_s))
        seen = departing(now_s, start, min(forward, speed), speed_mps=speed, accel_mps2=accel)
        if estimate is None or self.went_on or forward >= speed:
            return (seen,)
        left_s = now_s - forward / accel
        early_s = max(estimate.stop_time_s, left_s - SEEN_LATE_S)
        early = departing(early_s, line, 0.0, speed_mps=speed, accel_mps2=accel)
        return (seen, early) if early_s < left_s else (seen,)

    def _leaving_mps2(self, estimate: CornerEstimate) -> float:
        """Return with what acceleration a corner is expected to be left [m/s^2].

        As it is slowed for; but who eases off the end of that does not speed up the more gently.
        """
        return max(estimate.accel_mps2, LEAST_LEAVING_SHARE * self._corner.accel_mps2)

    def _right_angle(self, stop: Pose) -> Pose:
        """Return how a corner is expected to be left: turned to the pattern's side."""
        return Pose(stop.x_m, stop.y_m, stop.heading_rad - self._side * math.pi / 2.0)

    def _way_out(self, helicopter: Motion) -> Pose:
        """Return the line on which the helicopter leaves the corner, through its stop.

        The right angle is believed until the bearing from the stop says otherwise.
        """
        assert self.estimate is not None
        stop = self.estimate.stop
        heading = self._right_angle(stop).heading_rad
        away = math.hypot(helicopter.x_m - stop.x_m, helicopter.y_m - stop.y_m)
        if away > SURE_BEARING_M:
            bearing = math.atan2(helicopter.y_m - stop.y_m, helicopter.x_m - stop.x_m)
            off = abs(wrap_angle(bearing - heading))
            # Stop and position are each known to some metres.
            aside = off > 0.5 * math.pi or away * math.sin(off) > SURE_ASIDE_M
            if aside and off > TURNED_OTHERWISE_RAD * max(0.5, SURE_BEARING_M / away):
                heading = bearing
        return Pose(stop.x_m, stop.y_m, heading)
