"""The outside rules: to a place outside of the turn, by the longer way about the corner.

In the corner's frame: the helicopter comes along y = 0 towards +x and turns right, by theta, at the
origin; the UAV comes along y = D outside of the turn, or inside of it with D < 0. Its new slot
track, E outside of the new leg, crosses its old one at x = c = (E - D cos(theta)) / sin(theta).
From outside the helicopter never crosses the UAV's way. t = tan(theta / 2).

* O1 outer corner: S(s + L + c - R t) R(theta). Nothing is left unseen.
  Begun later, it comes back onto the track once it is past the nose: S R(theta) S R(w) S L(w).
* O2 outer corner cut by a chord that leaves the one outline q before they cross and meets the other
  q after: S R(theta / 2) S(2 q cos(theta / 2) - 2 R tan(theta / 4)) R(theta / 2). At a right angle
  it leaves at most (q + (1 - 1 / sqrt 2) d)^2 / 2 unseen of a swath d wide.
* O3 over to the outside, before the helicopter leaves the corner: O1's path from inside. With the
  outer corner that follows it leads round a U-turn beyond the cross leg.

About an outer corner the UAV falls behind, over to the outside it comes ahead: speed on the next
leg makes up for it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import Arc, CornerFrame, FlightPath, Straight
from sar_planner.prediction.separation import (
    ClosestApproach,
    closest_over_time,
    corner_forecast,
    least_apart_m,
)
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule

CUTS = 24
STANDING_S = 60.0
FARTHER_SHARE = 0.7
MOST_TURN_RAD = math.radians(135.0)
ASIDE_RAD = math.radians(15.0)
PAST_M = 60.0
LEAST_ASIDE_M = 0.1


class OutsideRules:
    """The rules at one corner's parameters, for one turn.

    ``turn_rad``: its size, more than 0 [rad]. ``speed_mps``: of the UAV along its path.
    ``from_m``, ``to_m``: D and E [m], ``spacing_m`` where they are not given. Raises
    ``NoPathError`` for a turn that has no outside worth flying about.
    """

    def __init__(
        self,
        parameters: CornerParameters,
        turn_rad: float,
        *,
        speed_mps: float | None = None,
        from_m: float | None = None,
        to_m: float | None = None,
    ) -> None:
        """Work out what does not depend on the lag."""
        if not 0.0 < turn_rad <= MOST_TURN_RAD:
            raise NoPathError(
                f"turn of {math.degrees(turn_rad):.0f} degrees: expected more than 0, at most 135"
            )
        p = self.parameters = parameters
        self._turn_rad = turn_rad
        self.from_m = p.spacing_m if from_m is None else from_m
        self.to_m = p.spacing_m if to_m is None else to_m
        self._speed_mps = speed_mps or p.speed_mps
        forecast = corner_forecast(p, turn_rad)
        standing, farther = (
            corner_forecast(p, turn_rad, hover_s=STANDING_S, at_m=at_m)
            for at_m in (0.0, p.stopping_m)
        )
        self._frame = CornerFrame(Pose(0.0, 0.0, -turn_rad).offset(0.0, self.to_m), -1)
        self._in_corner, self._in_slot = forecast, forecast.in_frame(self._frame)
        self._kept_from, self._farther = (forecast, standing), farther

    def at_mps(self, speed_mps: float) -> OutsideRules:
        """Return the same rules for a UAV of another speed along its path."""
        return OutsideRules(
            self.parameters,
            self._turn_rad,
            speed_mps=speed_mps,
            from_m=self.from_m,
            to_m=self.to_m,
        )

    @property
    def corner_m(self) -> float:
        """X at which the old and the new slot track cross, c [m]."""
        return (self.to_m - self.from_m * math.cos(self._turn_rad)) / math.sin(self._turn_rad)

    def path(self, lag_m: float, cut_m: float = 0.0) -> FlightPath | None:
        """Return the path that cuts the outer corner by ``cut_m`` [m]; None where there is none.

        Too late for it, or less cut than its arcs take.
        """
        p, turn = self.parameters, self._turn_rad
        start = Pose(-(p.stopping_m + lag_m), self.from_m, 0.0)
        to_corner = self.corner_m - start.x_m
        if cut_m <= 0.0:
            lead = to_corner - p.turn_radius_m * math.tan(0.5 * turn)
            parts: tuple[Straight | Arc, ...] = (Arc(p.turn_radius_m, -turn),)
            chord = 0.0
        else:
            bend = p.turn_radius_m * math.tan(0.25 * turn)
            lead = to_corner - cut_m - bend
            chord = 2.0 * cut_m * math.cos(0.5 * turn) - 2.0 * bend
            half = Arc(p.turn_radius_m, -0.5 * turn)
            parts = (half, Straight(max(chord, 0.0)), half)
        if min(lead, chord) < 0.0:
            return None
        return FlightPath.of(start, (Straight(lead), *parts))

    def turn_start_m(self, lag_m: float) -> float:
        """Return how far along O1's path its turn begins [m]; below 0 where that is past."""
        to_corner = self.corner_m + self.parameters.stopping_m + lag_m
        return to_corner - self.parameters.turn_radius_m * math.tan(0.5 * self._turn_rad)

    def most_cut_m(self, lag_m: float, lead_m: float) -> float:
        """Return by how much the corner can be cut [m] by a UAV that cannot turn before a lead."""
        r, turn = self.parameters.turn_radius_m, self._turn_rad
        bend = r * (math.tan(0.5 * turn) - math.tan(0.25 * turn))
        return self.turn_start_m(lag_m) + bend - lead_m

    def wide_path(
        self, lag_m: float, over_m: float, *, out_m: float = 0.0, lead_m: float = 0.0
    ) -> FlightPath | None:
        """Return O1's path begun so much later [m], and led back onto the track; None: too late.

        So it passes farther before the helicopter's nose, and longer after that stops. ``out_m``:
        by which the UAV flies farther out before, from ``lead_m`` on along its path.
        """
        r, lead = self.parameters.turn_radius_m, self.turn_start_m(lag_m) + over_m
        start = Pose(-(self.parameters.stopping_m + lag_m), self.from_m, 0.0)
        begun: tuple[Straight | Arc, ...] = ()
        if out_m >= LEAST_ASIDE_M:
            begun = (Straight(lead_m), *_aside(r, out_m, 1))
            lead += -out_m / math.tan(self._turn_rad) - FlightPath(start, begun).end.x_m + start.x_m
        beside = over_m * math.sin(self._turn_rad)
        if lead < 0.0:
            return None
        there = FlightPath.of(start, (*begun, Straight(lead), Arc(r, -self._turn_rad)))
        if beside < LEAST_ASIDE_M:
            return there
        past = Straight(max(0.0, PAST_M - self._frame.to_frame(there.end).x_m))
        return FlightPath.of(start, (*there.segments, past, *_aside(r, beside, -1)))

    def next_lag_m(self, path: FlightPath) -> float:
        """Return L(k+1) [m] after a path of these rules flown at the UAV's speed."""
        arrival_s = path.length_m / self._speed_mps
        return self._in_slot.slot_x_m(arrival_s) - self._frame.to_frame(path.end).x_m

    def closest_m(self, path: FlightPath) -> float:
        """Return the least distance of a path [m], a lower bound: ``least_apart_m``.

        Also to a helicopter that stands in the corner for longer than it is expected to.
        """
        return least_apart_m(path, self._kept_from, start_s=0.0, speed_mps=self._speed_mps)

    def _may_be_cut(self, path: FlightPath, separation_m: float) -> bool:
        """Whether a chord is apart from a helicopter that stands another stopping way farther on.

        Across the outer corner it leads towards the nose of one that goes on.
        """
        apart = least_apart_m(path, (self._farther,), start_s=0.0, speed_mps=self._speed_mps)
        return apart >= FARTHER_SHARE * separation_m

    def closest(self, path: FlightPath) -> ClosestApproach:
        """Return the closest approach of a path."""
        return closest_over_time(path, self._in_corner, start_s=0.0, speed_mps=self._speed_mps)

    def _paths(self, lag_m: float) -> Iterator[tuple[Rule, FlightPath]]:
        """Yield the paths there are, the one that is cut the least first."""
        p = self.parameters
        most = self.corner_m + p.stopping_m + lag_m
        if self.from_m < 0.0:
            path = self.path(lag_m)
            if path is not None:
                yield Rule.O3, path
            return
        cuts = (0.0, *(most * (i + 1) / CUTS for i in range(CUTS)))
        for cut_m in cuts:
            path = self.path(lag_m, cut_m)
            if path is not None:
                yield Rule.O2 if cut_m > 0.0 else Rule.O1, path

    def plan(
        self,
        lag_m: float,
        *,
        lead_m: float = 0.0,
        separation_m: float,
        most_left_m: float = math.inf,
    ) -> CornerPlan:
        """Return the path for lag L(k) [m] that is cut the least.

        ``lead_m``: before which the UAV cannot turn [m]. ``most_left_m``: that the next leg can
        make up [m]; where no safe path leaves so little, the one that leaves the least. Raises
        ``NoPathError`` when no path keeps ``separation_m``.
        """
        best: CornerPlan | None = None
        for rule, path in self._paths(lag_m):
            plan = CornerPlan(rule, lag_m, self.next_lag_m(path), path, self.parameters)
            if plan.turn_start_m < lead_m or self.closest_m(path) < separation_m:
                continue
            if rule is Rule.O2 and not self._may_be_cut(path, separation_m):
                continue
            if best is None or plan.next_lag_m < best.next_lag_m:
                best = plan
            if best.next_lag_m <= most_left_m:
                return best
        if best is None:
            raise NoPathError(
                f"L = {lag_m:.1f} m: no path outside keeps {separation_m:.0f} m of separation"
            )
        return best


def _aside(radius_m: float, by_m: float, side: int) -> tuple[Straight | Arc, ...]:
    """Return what leads so much [m] to one side of a track, 1 left, -1 right."""
    turn = min(ASIDE_RAD, math.acos(max(-1.0, 1.0 - 0.5 * by_m / radius_m)))
    between = (by_m - 2.0 * radius_m * (1.0 - math.cos(turn))) / math.sin(turn)
    arc = Arc(radius_m, side * turn)
    return arc, Straight(max(between, 0.0)), Arc(radius_m, -side * turn)
