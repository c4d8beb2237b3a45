"""The helicopter's motion to come, from what is known of it."""

from __future__ import annotations

import math
from typing import NamedTuple

from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.states import CornerEstimate, LegEstimate, Motion, Phase
from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.corner_cost import MOVING_MPS
from sar_planner.prediction.forecast import Forecast, Stretch, cornering, cruising, departing

STANDING_S = 600.0
SURE_BEARING_M = 25.0
SURE_ASIDE_M = 18.0
TURNED_OTHERWISE_RAD = math.radians(20.0)
EXPECTED_SPEED_SIGMA_MPS = 0.7
EXPECTED_HEADING_SIGMA_RAD = math.radians(2.0)
EXPECTED_LINE_SIGMA_M = 4.0
CONTRADICTION = 3.0
UNSEEN_S = 5.0
SEEN_LATE_S = 2.0
LEAST_LEAVING_SHARE = 0.9


def _weighed(value: float, sigma: float, expected: float, expected_sigma: float) -> float:
    """Return the inverse-variance mean of a measurement and of what was expected."""
    weight = expected_sigma**2 / (expected_sigma**2 + sigma**2)
    return expected + weight * (value - expected)


class HelicopterPredictor(NamedTuple):
    """Predicts the helicopter as it is known at one time.

    ``corner``: the parameters of a corner, ``turn_rad``: the turn expected at it, left positive.
    ``estimate``: the corner told of last; ``is_predicted``: it belongs to the present slow-down;
    ``went_on``: the helicopter had slowed and sped up again without having stopped.
    """

    corner: CornerParameters
    turn_rad: float
    helicopter: Motion
    phase: Phase
    leg: LegEstimate | None
    estimate: CornerEstimate | None
    is_predicted: bool
    went_on: bool

    def forecasts(self, now_s: float) -> tuple[Forecast, ...]:
        """Return the motion to come, and others that must be kept apart from too; or nothing.

        On a leg it goes on, or stops at once. Slowing, it will turn by a right angle to the
        pattern's side, as soon as the corner is predicted. Standing, it has departed as recently as
        would not be seen yet, or stands on. Speeding up, it goes where it is going. Nothing where
        the leg is not known.
        """
        if self.phase is Phase.CRUISE:
            return self._cruise(self.helicopter, now_s)
        if self.phase is Phase.DECELERATING:
            return self._decelerating(self.helicopter, now_s)
        if self.phase is Phase.STOPPED:
            return self._stopped(self.helicopter, now_s)
        if self.phase is Phase.ACCELERATING:
            return self._accelerating(self.helicopter, now_s)
        return ()

    def _cruise(self, helicopter: Motion, now_s: float) -> tuple[Forecast, ...]:
        leg = self.leg
        if leg is None or abs(wrap_angle(helicopter.course_rad - leg.foot.heading_rad)) > 1.0:
            return ()
        line, speed = self._believed(leg)
        estimate = self.estimate
        along = line.along(helicopter.x_m, helicopter.y_m)
        along += speed * (now_s - helicopter.time_s)
        here = line.offset(along)
        accel = self.corner.accel_mps2 if estimate is None else estimate.accel_mps2
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
        expected = self.corner.speed_mps if estimate is None else estimate.speed_mps
        speed = _weighed(leg.speed_mps, leg.speed_sigma_mps, expected, EXPECTED_SPEED_SIGMA_MPS)
        if estimate is None or self.went_on or leg.time_s < estimate.stop_time_s:
            return leg.foot, speed
        heading = self._left_by(estimate.stop).heading_rad
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
        if estimate is None or self.went_on or not self.is_predicted:
            return self._cruise(helicopter, now_s)
        return (
            cornering(
                estimate.onset_time_s,
                estimate.stop,
                speed_mps=estimate.speed_mps,
                accel_mps2=estimate.accel_mps2,
                turn_rad=self.turn_rad,
                leaving_mps2=self._leaving_mps2(estimate),
            ),
        )

    def _stopped(self, _helicopter: Motion, now_s: float) -> tuple[Forecast, ...]:
        estimate = self.estimate
        if estimate is None or self.went_on:
            return ()
        out = self._left_by(estimate.stop)
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
            speed = self.corner.speed_mps if self.leg is None else self.leg.speed_mps
            if self.leg is None and helicopter.speed_mps < MOVING_MPS:
                return ()
            turned = self.leg is None or (
                helicopter.speed_mps > MOVING_MPS
                and abs(wrap_angle(helicopter.course_rad - self.leg.foot.heading_rad))
                > TURNED_OTHERWISE_RAD
            )
            line = helicopter.pose if turned or self.leg is None else self.leg.foot
            accel = self.corner.accel_mps2
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
        return max(estimate.accel_mps2, LEAST_LEAVING_SHARE * self.corner.accel_mps2)

    def _left_by(self, stop: Pose) -> Pose:
        """Return how a corner is expected to be left."""
        return Pose(stop.x_m, stop.y_m, stop.heading_rad + self.turn_rad)

    def _way_out(self, helicopter: Motion) -> Pose:
        """Return the line on which the helicopter leaves the corner, through its stop.

        The right angle is believed until the bearing from the stop says otherwise.
        """
        assert self.estimate is not None
        stop = self.estimate.stop
        heading = self._left_by(stop).heading_rad
        away = math.hypot(helicopter.x_m - stop.x_m, helicopter.y_m - stop.y_m)
        if away > SURE_BEARING_M:
            bearing = math.atan2(helicopter.y_m - stop.y_m, helicopter.x_m - stop.x_m)
            off = abs(wrap_angle(bearing - heading))
            # Stop and position are each known to some metres.
            aside = off > 0.5 * math.pi or away * math.sin(off) > SURE_ASIDE_M
            if aside and off > TURNED_OTHERWISE_RAD * max(0.5, SURE_BEARING_M / away):
                heading = bearing
        return Pose(stop.x_m, stop.y_m, heading)
