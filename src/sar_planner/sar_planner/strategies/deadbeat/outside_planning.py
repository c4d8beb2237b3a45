"""The path about the outside of a corner, as the wind and the airspeeds let it be flown.

The UAV has the longer way, and passes before the nose of a helicopter that may stand there for
longer than expected, or leave another way. What it falls behind by that is made up on the next leg,
as far as the wind allows. So it passes slowly where that is much, and as fast as it can on its way
to a leg against the wind; and in either case as far out as keeps it apart from one that goes
astray.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from sar_estimator.common.states import CornerEstimate
from sar_planner.paths.flight_path import CornerFrame, FlightPath, Straight
from sar_planner.prediction.astray import astray_apart_m
from sar_planner.rejoin.tracked_path import TrackedPath
from sar_planner.rules.outside_rules import OutsideRules
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule
from sar_planner.strategies.deadbeat.state import OUTSIDE_SLOWER, Tick

MADE_UP_SHARE = 0.7
"""Of a leg: on which a lag that an outer corner leaves is made up."""
OUT_M = (0.0, 20.0, 40.0)
"""How much farther out the UAV may pass beside a helicopter that stands in the corner."""
WIDER_M = (0.0, 10.0, 20.0, 35.0, 50.0, 70.0, 90.0)
"""How much farther before its nose it may pass."""
ASTRAY_SHARES = (0.925, 0.875, 0.825, 0.775, 0.7)
"""Of the least separation: to one that leaves another way than expected, the most wanted first."""
CUT_ASTRAY_SHARE = 0.95
"""The same where the corner is cut: a chord leads the nearer, the farther on the stop is."""
CUTS = 12
BEYOND_M = 400.0


class Flown(NamedTuple):
    """A path about the corner, as it will be flown at a share of V.

    ``left_m``: the lag that it leaves beyond the one wanted on the new leg. ``astray_m``: the least
    distance to a helicopter that leaves another way than expected.
    """

    plan: CornerPlan
    share: float
    left_m: float
    astray_m: float


class OutsideCorner(NamedTuple):
    """A corner that is flown about the outside, and what can be done there at a time.

    ``lag_m``: L(k). ``lead_m``: along the path, before which the UAV cannot turn. ``shares``: of V,
    the most wanted one first. ``made_up_m``: of lag, on the next leg.
    """

    rules: OutsideRules
    frame: CornerFrame
    estimate: CornerEstimate
    lag_m: float
    lead_m: float
    shares: tuple[float, ...]
    made_up_m: float

    @property
    def most_left_m(self) -> float:
        """The lag [m] beyond that on the next leg from which on the corner is cut."""
        return self.made_up_m + self.rules.parameters.spacing_m

    def plan(self, tick: Tick) -> tuple[CornerPlan, float] | None:
        """Return the plan and the share of V at which it is flown; None where none keeps apart.

        The first that leaves what the next leg can make up; cut where nothing else leaves less than
        that and one track spacing.
        """
        most_m = self.most_left_m
        best: Flown | None = None
        found: list[Flown] = []
        for out_m in OUT_M:
            found += self._all_flown(Rule.O1, self._whole(out_m), tick)
            best = self._chosen(found, ASTRAY_SHARES[:1] if out_m < OUT_M[-1] else ASTRAY_SHARES)
            if best is not None and best.left_m <= self.made_up_m:
                break
        if best is None or best.left_m > most_m:
            cut = self._all_flown(Rule.O2, self._cut(), tick)
            least_m = CUT_ASTRAY_SHARE * tick.corner.separation_m
            cut = [one for one in cut if one.astray_m >= least_m]
            enough = [one for one in cut if one.left_m <= most_m]
            left = enough[:1] or [*cut, *([] if best is None else [best])]
            best = min(left, key=lambda one: one.left_m, default=None)
        return None if best is None else (best.plan, best.share)

    def _chosen(self, found: list[Flown], astray_shares: Iterable[float]) -> Flown | None:
        """Return the first in time of the paths that keep the farthest from one that goes astray.

        Where none is in time, the one that leaves the least of those that keep the farthest.
        """
        separation_m = self.rules.parameters.separation_m
        best: Flown | None = None
        for share in astray_shares:
            apart = [one for one in found if one.astray_m >= share * separation_m]
            in_time = [one for one in apart if one.left_m <= self.made_up_m]
            if in_time:
                return in_time[0]
            best = best or min(apart, key=lambda one: one.left_m, default=None)
            if best is not None and best.left_m <= self.most_left_m:
                return best
        return best

    def _whole(self, out_m: float) -> Iterator[FlightPath]:
        """Yield the paths that leave next to nothing unseen, the narrowest first."""
        late_m = max(0.0, self.lead_m - self.rules.turn_start_m(self.lag_m))
        for wider_m in WIDER_M:
            over_m = late_m + wider_m
            path = self.rules.wide_path(self.lag_m, over_m, out_m=out_m, lead_m=self.lead_m)
            if path is not None:
                yield path

    def _cut(self) -> Iterator[FlightPath]:
        """Yield the paths that cut the corner and can still be begun, the least cut first."""
        most_m = self.rules.most_cut_m(self.lag_m, self.lead_m)
        for i in range(CUTS):
            path = self.rules.path(self.lag_m, most_m * (i + 1) / CUTS) if most_m > 0.0 else None
            if path is not None:
                yield path

    def _all_flown(self, rule: Rule, paths: Iterable[FlightPath], tick: Tick) -> list[Flown]:
        """Return how the paths will be flown that are apart from what is expected.

        In the order of speeds, then of paths.
        """
        kept = list(paths)
        looked = (self._flown(rule, path, one, tick) for one in self.shares for path in kept)
        return [one for one in looked if one is not None]

    def _flown(self, rule: Rule, path: FlightPath, share: float, tick: Tick) -> Flown | None:
        """Return how a path will be flown from now on; None where that is too near."""
        uav, estimate = tick.situation.uav, self.estimate
        assert uav is not None
        # The nose is passed behind its end.
        beyond = FlightPath(path.start, (*path.segments, Straight(BEYOND_M)))
        now_m = uav.speed_mps * (tick.now_s - estimate.onset_time_s)
        flown = tick.flown(TrackedPath(self.frame, beyond, 0.0, share * estimate.speed_mps, now_m))
        if tick.apart_m(flown) < tick.corner.separation_m:
            return None
        times_s, slot = tick.now_s + flown.times_s, tick.slot_frame
        end = slot.to_frame(self.frame.pose_to_map(beyond.end))
        left_m = tick.expected.in_frame(slot).slot_x_m(float(times_s[-1])) - end.x_m
        turn_rad = tick.situation.turn_rad
        astray_m = astray_apart_m(times_s, flown.points_m, estimate, turn_rad, tick.now_s)
        next_lag_m = left_m + tick.aim_m
        plan = CornerPlan(rule, self.lag_m, next_lag_m, path, self.rules.parameters)
        return Flown(plan, share, left_m, astray_m)


def outside_plan(
    rules: OutsideRules,
    frame: CornerFrame,
    estimate: CornerEstimate,
    lag_m: float,
    lead_m: float,
    tick: Tick,
) -> tuple[CornerPlan, float] | None:
    """Return the plan to the outside of the turn, and at which share of V it is flown.

    ``lag_m``: L(k), ``lead_m``: along the path, before which the UAV cannot turn. None where no
    path keeps apart.
    """
    old_rad, speed_mps = estimate.stop.heading_rad, estimate.speed_mps
    slowest, fastest = (one / speed_mps for one in tick.on_course_mps(old_rad))
    as_slow = max(1.0 - OUTSIDE_SLOWER, slowest)
    # One that is behind passes no sooner than one in its slot that flies as slowly as it may.
    way_m = rules.to_m + rules.parameters.stopping_m
    slow = min(max((1.0 - OUTSIDE_SLOWER) * (1.0 + lag_m / way_m), as_slow), max(1.0, as_slow))
    if rules.from_m < 0.0:
        return _over_plan(rules, lag_m, lead_m, (slow, 0.5 * (slow + 1.0), 1.0), tick)
    new_rad = old_rad + tick.situation.turn_rad
    fastest = min(1.0 + tick.faster, tick.on_course_mps(new_rad)[1] / speed_mps)
    leg_m = tick.situation.progress.next.length_m or math.inf
    made_up_m = MADE_UP_SHARE * leg_m * (fastest - 1.0) if fastest > 1.0 else 0.0
    shares = shares_of(slow, as_slow, 1.0 + tick.turned_faster)
    corner = OutsideCorner(rules, frame, estimate, lag_m, lead_m, shares, made_up_m)
    return corner.plan(tick)


def shares_of(slow: float, as_slow: float, fastest: float) -> tuple[float, ...]:
    """Return the shares of V with which an outer corner may be flown, the most wanted one first.

    From ``slow``, as slowly as it serves, to the fastest; then down to ``as_slow``, as slowly as
    the wind lets it, for one that is late and would pass before the helicopter has left.
    """
    slow, as_slow = min(slow, fastest), min(as_slow, slow, fastest)
    upwards = sorted({slow, max(slow, 0.5 * (slow + 1.0)), max(slow, 1.0), fastest})
    return *upwards, 0.5 * (as_slow + slow), as_slow


def _over_plan(
    rules: OutsideRules, lag_m: float, lead_m: float, shares: tuple[float, ...], tick: Tick
) -> tuple[CornerPlan, float] | None:
    """Return the plan over to the outside, flown slowly: it would come out far ahead."""
    for separation_m in tick.separations_m:
        for share in shares:
            slowed = rules.at_mps(share * rules.parameters.speed_mps)
            try:
                plan = slowed.plan(lag_m, lead_m=lead_m, separation_m=separation_m)
            except NoPathError:
                continue
            return plan, share
    return None
